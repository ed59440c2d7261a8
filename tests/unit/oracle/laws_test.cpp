// The laws of single steps, on steps whose right answer is known.
#include <gtest/gtest.h>

#include <cmath>

#include "experiments/oracle/law_profile.hpp"
#include "experiments/oracle/step_laws.hpp"

namespace brickbench::gate {
namespace {

constexpr double k_step_s = 0.01;
constexpr double k_gravity_mps2 = 9.81;

struct TwoStates {
  World world;
  std::vector<State> before;
  std::vector<State> after;
  std::vector<Wrench> wrenches;

  // One brick of 3.6 kg, `height_m` above a floor that is turned by `slope_rad` about y.
  TwoStates(double height_m, double slope_rad) {
    world.law = {.friction = 0.5, .restitution = 0.0};
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(slope_rad, Eigen::Vector3d::UnitY()));
    world.bodies = {ground_plane(), solid_body("brick", BoxShape{{0.1, 0.05, 0.05}}, 1800.0)};
    world.bodies[0].initial.orientation = turn;
    world.bodies[1].initial.orientation = turn;
    world.bodies[1].initial.position_m = turn * Eigen::Vector3d(0.0, 0.0, 0.05 + height_m);
    before = {world.bodies[0].initial, world.bodies[1].initial};
    after = before;
    wrenches.resize(2);
  }
  StepRecord record() const { return {before, after, wrenches, k_step_s}; }
  double mass_kg() const { return world.bodies[1].mass_kg; }
  // The brick's velocity changes by gravity and by an impulse in the frame of the floor.
  void push(const Eigen::Vector3d& impulse_ns) {
    after[1].velocity_mps = before[1].velocity_mps + k_step_s * world.gravity_mps2 +
                            before[0].orientation * impulse_ns / mass_kg();
  }
};

TEST(Laws, AFloorGivesWhatItsConeAllowsOnSlopesToo) {
  for (const double slope_rad : {0.0, 0.4, -1.0}) {
    TwoStates step(0.0, slope_rad);
    step.push({0.49, 0.0, 1.0});
    EXPECT_LE(external_excess_ns(step.world, step.record(), 1e-9), 1e-12) << slope_rad;
    // Twice the friction cone: the distance to its edge, which rises by 0.5 per unit.
    step.push({1.0, 0.0, 1.0});
    EXPECT_NEAR(external_excess_ns(step.world, step.record(), 1e-9), 0.5 / std::hypot(1.0, 0.5),
                1e-12)
        << slope_rad;
    step.push({0.0, 0.0, -1.0});
    EXPECT_NEAR(external_excess_ns(step.world, step.record(), 1e-9), 1.0, 1e-12) << slope_rad;
  }
}

TEST(Laws, TwoSlopesGiveTheSumOfTheirCones) {
  TwoStates step(0.0, 0.0);
  Body wall = ground_plane();
  wall.initial.orientation = Eigen::AngleAxisd(M_PI_2, Eigen::Vector3d::UnitY());  // faces +x
  wall.initial.position_m = {-0.1, 0.0, 0.0};
  step.world.bodies.push_back(wall);
  step.before.push_back(wall.initial);
  step.after.push_back(wall.initial);
  step.wrenches.resize(3);
  step.push({5.0, 0.0, 1.0});  // out of the floor's cone, within the sum of both
  EXPECT_LE(external_excess_ns(step.world, step.record(), 1e-9), 2e-9);
  step.push({-5.0, 0.0, 1.0});  // into the wall
  EXPECT_GE(external_excess_ns(step.world, step.record(), 1e-9), 4.0);
}

TEST(Laws, NothingIsGivenInTheAir) {
  TwoStates step(1.0, 0.0);
  step.push({0.0, 0.0, 0.25});
  EXPECT_NEAR(external_excess_ns(step.world, step.record(), 1e-9), 0.25, 1e-12);
}

TEST(Laws, TheAllowanceIsWhatTheOldVelocityRuleGainsAndNothingForTheNew) {
  constexpr double rounding = 1e-12;
  TwoStates step(1.0, 0.0);
  step.before[1].velocity_mps = {0.3, 0.0, 2.0};
  step.push(Eigen::Vector3d::Zero());
  const double size_j =
      0.5 * step.mass_kg() * k_gravity_mps2 * k_gravity_mps2 * k_step_s * k_step_s;
  const auto with = [](PositionRule rule) {
    Scheme scheme;
    scheme.position = rule;
    return std::optional(scheme);
  };
  step.after[1].position_m = step.before[1].position_m + k_step_s * step.before[1].velocity_mps;
  const double old_gain_j = energy_gain_j(step.world, step.record());
  EXPECT_NEAR(old_gain_j, size_j, 1e-12);
  EXPECT_NEAR(
      energy_allowance_j(step.world, step.record(), with(PositionRule::old_velocity), rounding),
      size_j, 1e-9);
  EXPECT_NEAR(energy_allowance_j(step.world, step.record(), std::nullopt, rounding), size_j, 1e-9);
  const double new_allowance_j =
      energy_allowance_j(step.world, step.record(), with(PositionRule::new_velocity), rounding);
  EXPECT_LE(new_allowance_j, 1e-9);
  EXPECT_GT(old_gain_j, new_allowance_j);
  step.after[1].position_m = step.before[1].position_m + k_step_s * step.after[1].velocity_mps;
  EXPECT_NEAR(energy_gain_j(step.world, step.record()), -size_j, 1e-12);
}

TEST(Laws, TheExplicitGyroscopicRuleGainsWhatIsAllowed) {
  TwoStates step(1.0, 0.0);
  step.world.gravity_mps2.setZero();
  const Eigen::Vector3d inertia_kgm2 = step.world.bodies[1].inertia_kgm2;
  const Eigen::Vector3d spin_radps(3.0, 2.0, -1.0);
  const Eigen::Vector3d torque_nm = spin_radps.cross(inertia_kgm2.cwiseProduct(spin_radps));
  step.before[1].angular_velocity_radps = spin_radps;
  step.after[1].angular_velocity_radps =
      spin_radps - k_step_s * torque_nm.cwiseQuotient(inertia_kgm2);
  Scheme scheme;
  scheme.gyroscopic = GyroscopicRule::explicit_body;
  const double gain_j = energy_gain_j(step.world, step.record());
  EXPECT_GT(gain_j, 1e-9);
  EXPECT_NEAR(energy_allowance_j(step.world, step.record(), scheme, 0.0), gain_j, 1e-14);
  scheme.gyroscopic = GyroscopicRule::neglected;
  EXPECT_EQ(energy_allowance_j(step.world, step.record(), scheme, 0.0), 0.0);
}

TEST(Laws, TheProfileNamesTheBrokenLawItsTimeAndItsBody) {
  TwoStates step(1.0, 0.0);
  Scene scene;
  scene.world = step.world;
  Recording recording;
  recording.step_s = k_step_s;
  recording.states = {step.before};
  for (int n = 1; n <= 10; ++n) {  // free fall by the new velocity; step 7 pushes upwards
    State& brick = step.before[1];
    brick.velocity_mps += k_step_s * step.world.gravity_mps2;
    if (n == 7) brick.velocity_mps.z() -= 1.0;
    brick.position_m += k_step_s * brick.velocity_mps;
    recording.states.push_back(step.before);
    recording.wrenches.push_back(step.wrenches);
  }
  LawPlan plan;
  plan.scheme = Scheme{};
  const auto profile = law_profile(scene, recording, plan);
  ASSERT_EQ(profile.size(), 4u);
  const Violation& impulse = profile[0];
  EXPECT_EQ(impulse.steps, 1u);
  EXPECT_EQ(impulse.body_a, "brick");
  EXPECT_NEAR(impulse.worst, step.mass_kg() * 1.0, 1e-6);
  EXPECT_NEAR(impulse.worst_time_s, 0.07, 1e-12);
  EXPECT_EQ(profile[1].steps, 1u);  // downwards, faster: energy rises
  EXPECT_EQ(profile[2].steps, 0u);
  EXPECT_EQ(profile[3].steps, 1u);
  EXPECT_EQ(broken_most(profile), &impulse);
}

}  // namespace
}  // namespace brickbench::gate
