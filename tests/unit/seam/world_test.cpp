#include "adapters/seam/world.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <random>

#include "tests/support/tolerance.hpp"

namespace brickbench {
namespace {

using testing::Tolerance;
using testing::Worst;

World one_brick() {
  World world;
  world.bodies.push_back(ground_plane());
  world.bodies.push_back(solid_body("brick", BoxShape{{0.1, 0.05, 0.05}}, 2000.0));
  return world;
}

TEST(World, AcceptsAPlainScene) { EXPECT_TRUE(validate(one_brick()).has_value()); }

TEST(World, RefusesEachImpossibleFactWithItsName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  struct Case {
    const char* word;
    std::function<void(World&)> spoil;
  };
  const Case cases[] = {
      {"mass", [](World& w) { w.bodies[1].mass_kg = -1.0; }},
      {"mass", [&](World& w) { w.bodies[1].mass_kg = nan; }},
      {"half extent",
       [](World& w) {
         w.bodies[1].shape = BoxShape{{0.1, 0.0, 0.1}};
       }},
      {"radius", [](World& w) { w.bodies[1].shape = SphereShape{-1.0}; }},
      {"plane", [](World& w) { w.bodies[1].shape = PlaneShape{}; }},
      {"inertia",
       [](World& w) {
         w.bodies[1].inertia_kgm2 = {1.0, 1.0, 3.0};
       }},
      {"quaternion", [](World& w) { w.bodies[1].initial.orientation.w() = 2.0; }},
      {"not finite", [&](World& w) { w.bodies[1].initial.position_m.x() = nan; }},
      {"velocity", [](World& w) { w.bodies[0].initial.velocity_mps.x() = 1.0; }},
      {"friction", [](World& w) { w.law.friction = -0.1; }},
      {"restitution", [](World& w) { w.law.restitution = 1.1; }},
      {"gravity", [&](World& w) { w.gravity_mps2.z() = nan; }},
      {"twice",
       [](World& w) {
         w.exceptions = {{0, 1, {}}, {1, 0, {}}};
       }},
  };
  for (const Case& test : cases) {
    World world = one_brick();
    test.spoil(world);
    const auto result = validate(world);
    ASSERT_FALSE(result.has_value()) << test.word;
    EXPECT_NE(result.error().reason.find(test.word), std::string::npos) << result.error().reason;
    EXPECT_EQ(result.error().fault, Fault::invalid);
  }
}

TEST(World, PairLawIsSymmetricAndFallsBack) {
  World world = one_brick();
  world.law = {0.5, 0.1};
  world.bodies[1].surface = 3;
  world.exceptions = {{3, 0, {0.7, 0.2}}};
  EXPECT_EQ(contact_law(world, 0, 1).friction, 0.7);
  EXPECT_EQ(contact_law(world, 1, 0).restitution, 0.2);
  EXPECT_EQ(contact_law(world, 1, 1).friction, 0.5);
}

// Monte-Carlo integral of the inertia of a solid over its volume.
constexpr Tolerance k_inertia_monte_carlo = {
    "inertia", 1e-2, 2e-3, "relative; 4e5 uniform points, standard error about 1.3e-3"};

TEST(World, InertiaIsThatOfTheSolid) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const Eigen::Vector3d half(0.1, 0.05, 0.2);
  const double radius_m = 0.3;
  Eigen::Vector3d box_sum = Eigen::Vector3d::Zero();
  Eigen::Vector3d ball_sum = Eigen::Vector3d::Zero();
  const int points = 400000;
  int in_ball = 0;
  for (int i = 0; i < points; ++i) {
    const Eigen::Vector3d u(unit(random), unit(random), unit(random));
    const Eigen::Vector3d box = half.cwiseProduct(u).cwiseAbs2();
    box_sum += Eigen::Vector3d::Constant(box.sum()) - box;
    if (u.squaredNorm() > 1.0) continue;
    ++in_ball;
    const Eigen::Vector3d ball = (radius_m * u).cwiseAbs2();
    ball_sum += Eigen::Vector3d::Constant(ball.sum()) - ball;
  }
  const double mass_kg = 3.0;
  const Eigen::Vector3d box = solid_inertia_kgm2(BoxShape{half}, mass_kg);
  const Eigen::Vector3d ball = solid_inertia_kgm2(SphereShape{radius_m}, mass_kg);
  Worst worst;
  for (int k = 0; k < 3; ++k) {
    worst.see(mass_kg * box_sum[k] / points / box[k] - 1.0, "box axis " + std::to_string(k));
    worst.see(mass_kg * ball_sum[k] / in_ball / ball[k] - 1.0, "ball axis " + std::to_string(k));
  }
  EXPECT_TRUE(worst.within(k_inertia_monte_carlo));
}

TEST(World, HashSeesEveryFieldAndTheOrder) {
  std::vector<State> states(2);
  states[1].position_m.x() = 1.0;
  const auto hash = hash_states(states);
  EXPECT_EQ(hash, hash_states(states));
  const std::function<void(State&)> changes[] = {
      [](State& s) { s.position_m.z() = 1e-300; },
      [](State& s) { s.orientation.y() = 1e-16; },
      [](State& s) { s.velocity_mps.x() = -0.0; },
      [](State& s) { s.angular_velocity_radps.z() = 1.0; },
  };
  for (const auto& change : changes) {
    std::vector<State> other = states;
    change(other[0]);
    EXPECT_NE(hash, hash_states(other));
  }
  std::swap(states[0], states[1]);
  EXPECT_NE(hash, hash_states(states));
}

}  // namespace
}  // namespace brickbench
