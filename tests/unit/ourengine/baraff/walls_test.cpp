// The paper's system on its own scenes: a tower and a wall stand, a thrown brick breaks the wall.
#include <gtest/gtest.h>

#include "ourengine/baraff/simulator.hpp"
#include "tests/support/tolerance.hpp"

namespace ourengine::baraff {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;

#ifdef NDEBUG
constexpr double k_duration_s = 5.0;
#else
constexpr double k_duration_s = 0.2;
#endif
constexpr Tolerance k_residual{"complementarity", 1e-10, 9.98e-11, "acceptance of qp_solve"};
constexpr Tolerance k_drift{"drift_m", 1e-9, 1e-10, "rounding of 5000 steps; tower and 5x5 wall"};

RigidBody brick(const Eigen::Vector3d& half_m, const Eigen::Vector3d& position_m) {
  const double mass_kg = 2000.0 * 8.0 * half_m.prod();
  const Eigen::Vector3d q = half_m.cwiseAbs2();
  RigidBody body =
      make_body(Box{half_m}, mass_kg,
                mass_kg / 3.0 * Eigen::Vector3d(q.y() + q.z(), q.x() + q.z(), q.x() + q.y()));
  body.position_m = position_m;
  return body;
}

std::vector<RigidBody> tower(int bricks) {
  std::vector<RigidBody> bodies = {make_fixed_body(Plane{})};
  for (int i = 0; i < bricks; ++i)
    bodies.push_back(brick({0.1, 0.05, 0.05}, {0, 0, 0.05 + 0.1 * i}));
  return bodies;
}

std::vector<RigidBody> wall(int size) {
  std::vector<RigidBody> bodies = {make_fixed_body(Plane{})};
  for (int row = 0; row < size; ++row) {
    const double z = 0.05 + 0.1 * row;
    if (row % 2 == 1) bodies.push_back(brick({0.05, 0.05, 0.05}, {0.05, 0, z}));
    for (int k = 0; k < size - row % 2; ++k) {
      bodies.push_back(brick({0.1, 0.05, 0.05}, {0.1 + 0.2 * k + 0.1 * (row % 2), 0, z}));
    }
    if (row % 2 == 1) bodies.push_back(brick({0.05, 0.05, 0.05}, {0.2 * size - 0.05, 0, z}));
  }
  return bodies;
}

void expect_stands(const std::vector<RigidBody>& bodies) {
  Simulator simulator(bodies, RestitutionTable::Zero(1, 1), Options{});
  Worst residual;
  for (int i = 0; i < k_duration_s / 0.001; ++i) {
    residual.see(simulator.step().complementarity_residual, "step " + std::to_string(i));
    ASSERT_FALSE(simulator.report().failed) << "step " << i;
  }
  Worst drift;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    drift.see((simulator.bodies()[i].position_m - bodies[i].position_m).norm(),
              "body " + std::to_string(i));
  }
  EXPECT_TRUE(residual.within(k_residual));
  EXPECT_TRUE(drift.within(k_drift));
}

TEST(Baraff, TowerOfTenStands) { expect_stands(tower(10)); }
TEST(Baraff, RunningBondWallStands) { expect_stands(wall(5)); }

TEST(Baraff, ThrownBrickBreaksTheWall) {
  std::vector<RigidBody> bodies = wall(5);
  const std::size_t bricks = bodies.size();
  bodies.push_back(brick({0.1, 0.05, 0.05}, {0.53, -0.5, 0.27}));
  set_velocity(bodies.back(), {0, 20, 0}, {0, 0, 0});
  Simulator simulator(bodies, RestitutionTable::Zero(1, 1), Options{});
  Worst residual;
  for (int i = 0; i < 300; ++i) {
    residual.see(simulator.step().complementarity_residual, "step " + std::to_string(i));
    ASSERT_FALSE(simulator.report().failed) << "step " << i;
  }
  int displaced = 0;
  for (std::size_t i = 0; i < bricks; ++i) {
    displaced += (simulator.bodies()[i].position_m - bodies[i].position_m).norm() > 0.02 ? 1 : 0;
  }
  EXPECT_GT(displaced, 5);
  EXPECT_TRUE(residual.within(k_residual));
}

}  // namespace
}  // namespace ourengine::baraff
