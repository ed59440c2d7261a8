// The paper's system on its own scenes: a tower and a wall stand, a thrown brick breaks the wall.
#include <gtest/gtest.h>

#include "ourengine/baraff/simulator.hpp"
#include "tests/support/tolerance.hpp"
#include "tests/unit/ourengine/baraff/scenes.hpp"

namespace ourengine::baraff {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;

#ifdef NDEBUG
constexpr double k_duration_s = 5.0;
#else
constexpr double k_duration_s = 0.2;
#endif
constexpr Tolerance k_run_residual{"complementarity", 1e-10, 1e-11, "1e-11 counts as not negative"};
constexpr Tolerance k_drift{"drift_m", 1e-9, 1.03e-10,
                            "rounding of 5000 steps; tower and 5x5 wall"};

void expect_stands(const std::vector<RigidBody>& bodies) {
  Simulator simulator(bodies, RestitutionTable::Zero(1, 1), Options{});
  Worst residual;
  for (int i = 0; i < k_duration_s / 0.001; ++i) {
    residual.see(simulator.step().complementarity_residual, "step " + std::to_string(i));
    ASSERT_FALSE(simulator.report().failed) << "step " << i;
    ASSERT_EQ(simulator.report().retried, 0) << "step " << i;
  }
  Worst drift;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    drift.see((simulator.bodies()[i].position_m - bodies[i].position_m).norm(),
              "body " + std::to_string(i));
  }
  EXPECT_TRUE(residual.within(k_run_residual));
  EXPECT_TRUE(drift.within(k_drift));
}

TEST(Baraff, TowerOfTenStands) { expect_stands(testing::tower(10)); }
TEST(Baraff, RunningBondWallStands) { expect_stands(testing::wall(5)); }

TEST(Baraff, ThrownBrickBreaksTheWall) {
  const std::vector<RigidBody> bodies = testing::thrown_brick();
  const std::size_t bricks = bodies.size() - 1;
  Simulator simulator(bodies, RestitutionTable::Zero(1, 1), Options{});
  Worst residual;
  int retried = 0;
  for (int i = 0; i < 300; ++i) {
    const StepReport& report = simulator.step();
    ASSERT_FALSE(report.unsolved) << "step " << i;
    if (report.retried > 0) {
      ++retried;  // ends within 1e-6, or the step were unsolved
    } else {
      residual.see(report.complementarity_residual, "step " + std::to_string(i));
    }
  }
  RecordProperty("retried_steps", retried);
  int displaced = 0;
  for (std::size_t i = 0; i < bricks; ++i) {
    displaced += (simulator.bodies()[i].position_m - bodies[i].position_m).norm() > 0.02 ? 1 : 0;
  }
  EXPECT_GT(displaced, 5);
  EXPECT_TRUE(residual.within(k_run_residual));
}

}  // namespace
}  // namespace ourengine::baraff
