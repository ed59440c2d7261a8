// Whole steps: energy of each part of a step, restitution, bisection, the paper's plain choices.
#include <gtest/gtest.h>

#include "ourengine/baraff/simulator.hpp"
#include "tests/support/tolerance.hpp"
#include "tests/unit/ourengine/baraff/scenes.hpp"

namespace ourengine::baraff {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;

constexpr double k_step_s = 0.001;
constexpr double k_gravity_mps2 = 9.81;
constexpr Tolerance k_energy{"energy_share", 4e-15, 2.3e-16, "rounding of sums of 30 bricks"};
constexpr Tolerance k_tumble{"energy_share", 1e-13, 1.4e-14,
                             "rounding of 500 steps of up to 150 parts each"};
constexpr Tolerance k_speed{"speed_mps", 2e-15, 1.1e-16, "one impulse"};

double energy_j(std::span<const RigidBody> bodies) {
  double sum_j = 0.0;
  for (const RigidBody& b : bodies) {
    if (b.is_fixed()) continue;
    const Eigen::Vector3d w = b.rotation.transpose() * b.angular_velocity_radps;
    sum_j += 0.5 * b.mass_kg * b.velocity_mps.squaredNorm() + 0.5 * w.dot(b.inertia_body * w) +
             b.mass_kg * k_gravity_mps2 * b.position_m.z();
  }
  return sum_j;
}

double euler_of_gravity_j(std::span<const RigidBody> bodies) {
  double mass_kg = 0.0;
  for (const RigidBody& b : bodies) mass_kg += b.mass_kg;
  return 0.5 * mass_kg * k_gravity_mps2 * k_gravity_mps2 * k_step_s * k_step_s;
}

// The most that forward Euler can add in a step of bodies with the motion at its end:
//  * translation, h^2/2 m g^2 each;
//  * turning by theta = h w at fixed L: |d2K/dtheta2| <= 2 L^2 / I_min, so h^2 w^2 L^2 / I_min
//  each;
//  * contact impulses j: with every closing velocity undone, -h j . c, where c holds the terms of b
//    that are quadratic in the velocities: |c| <= sum of w^2 r, plus 2 (w1 + w2) |slip|.
double euler_bound_j(std::span<const RigidBody> bodies, std::span<const Collision> contacts) {
  double bound_j = euler_of_gravity_j(bodies);
  for (const RigidBody& b : bodies) {
    if (b.is_fixed()) continue;
    const double least_kgm2 = b.inertia_body.diagonal().minCoeff();
    bound_j += k_step_s * k_step_s * b.angular_velocity_radps.squaredNorm() *
               b.angular_momentum_nms.squaredNorm() / least_kgm2;
  }
  for (const Collision& c : contacts) {
    const RigidBody& one = bodies[c.obj1];
    const RigidBody& two = bodies[c.obj2];
    const double w1 = one.angular_velocity_radps.norm();
    const double w2 = two.angular_velocity_radps.norm();
    const double slip_mps =
        (velocity_of_point_on_body(one, c.location) - velocity_of_point_on_body(two, c.location))
            .norm();
    const double quadratic_mps2 = w1 * w1 * (c.location - one.position_m).norm() +
                                  w2 * w2 * (c.location - two.position_m).norm() +
                                  2.0 * (w1 + w2) * slip_mps;
    bound_j += k_step_s * c.impulse_ns * quadratic_mps2;
  }
  return bound_j;
}

Options euler_options() {
  Options options;
  options.motion = Motion::forward_euler;
  return options;
}

TEST(StepEnergy, FreeFallGainsExactlyTheEulerTerm) {
  std::vector<RigidBody> bodies = {testing::brick({0.1, 0.05, 0.05}, {0, 0, 5})};
  Simulator simulator(bodies, RestitutionTable::Zero(1, 1), euler_options());
  const double scale_j = energy_j(simulator.bodies());
  Worst worst;
  for (int i = 0; i < 100; ++i) {
    worst.see((simulator.step().motion_energy_j - euler_of_gravity_j(bodies)) / scale_j,
              "step " + std::to_string(i));
  }
  EXPECT_TRUE(worst.within(k_energy));
}

// Without contact forces, held forces leave the energy of a tumbling fall as it is.
TEST(StepEnergy, TumblingFallKeepsItsEnergy) {
  Worst worst;
  for (const double spin_radps : {0.0, 10.0, 300.0, 3000.0}) {
    std::vector<RigidBody> bodies = {testing::brick({0.1, 0.05, 0.03}, {0, 0, 5})};
    set_velocity(bodies[0], {1, 2, 3}, spin_radps * Eigen::Vector3d(0.1, 1.0, 0.2));
    Simulator simulator(bodies, RestitutionTable::Zero(1, 1), Options{});
    const double start_j = energy_j(simulator.bodies());
    for (int i = 0; i < 500; ++i) simulator.step();
    worst.see((energy_j(simulator.bodies()) - start_j) / start_j, std::to_string(spin_radps));
  }
  EXPECT_TRUE(worst.within(k_tumble));
}

TEST(StepEnergy, RisesOfAThrownBrickAreOverlapAndEulerTerms) {
  Simulator simulator(testing::thrown_brick(), RestitutionTable::Zero(1, 1), euler_options());
  const double start_j = energy_j(simulator.bodies());
  double before_j = start_j;
  double risen_j = 0.0;
  double overlap_j = 0.0;
  double euler_j = 0.0;
  double bound_j = 0.0;
  double collision_j = 0.0;
  Worst unexplained, created, over_bound;
  for (int i = 0; i < 300; ++i) {
    const StepReport& report = simulator.step();
    const std::string where = "step " + std::to_string(i);
    const double after_j = energy_j(simulator.bodies());
    unexplained.see((after_j - before_j - report.overlap_energy_j - report.collision_energy_j -
                     report.motion_energy_j) /
                        start_j,
                    where);
    created.see(std::max(0.0, report.collision_energy_j) / start_j, where);
    const double bound = euler_bound_j(simulator.bodies(), simulator.contacts());
    over_bound.see(std::max(0.0, report.motion_energy_j - bound) / start_j, where);
    risen_j += std::max(0.0, after_j - before_j);
    overlap_j += std::max(0.0, report.overlap_energy_j);
    euler_j += std::max(0.0, report.motion_energy_j);
    collision_j += report.collision_energy_j;
    bound_j += bound;
    before_j = after_j;
  }
  RecordProperty("risen_j", std::to_string(risen_j));
  RecordProperty("overlap_j", std::to_string(overlap_j));
  RecordProperty("euler_j", std::to_string(euler_j));
  RecordProperty("euler_bound_j", std::to_string(bound_j));
  EXPECT_TRUE(unexplained.within(k_energy));
  EXPECT_TRUE(created.within(k_energy));
  EXPECT_TRUE(over_bound.within(k_energy));
  EXPECT_LE(risen_j, overlap_j + euler_j + 300 * k_energy.value * start_j);
  EXPECT_LT(collision_j, -0.5 * start_j);
}

// A corner hits the middle of a face, in line with both centres: v' = v (1 -+ e) / 2.
TEST(Step, BricksPartWithTheRestitution) {
  const Eigen::Vector3d half_m(0.1, 0.05, 0.05);
  std::vector<RigidBody> bodies = {
      testing::brick(half_m, {-0.1, 0, 0}),
      testing::brick(half_m, {half_m.norm(), 0, 0}),
  };
  bodies[1].orientation = Eigen::Quaterniond::FromTwoVectors(half_m, -Eigen::Vector3d::UnitX());
  set_velocity(bodies[0], {2, 0, 0}, {0, 0, 0});
  compute_derived(bodies[1]);
  Options options;
  options.gravity_mps2.setZero();
  Simulator simulator(bodies, RestitutionTable::Constant(1, 1, 0.5), options);
  simulator.step();
  ASSERT_EQ(simulator.contacts().size(), 1U);
  Worst worst;
  worst.see((simulator.bodies()[0].velocity_mps - Eigen::Vector3d(0.5, 0, 0)).norm(), "first");
  worst.see((simulator.bodies()[1].velocity_mps - Eigen::Vector3d(1.5, 0, 0)).norm(), "second");
  EXPECT_TRUE(worst.within(k_speed));
}

std::vector<RigidBody> falling_brick() {
  std::vector<RigidBody> bodies = {make_fixed_body(Plane{}),
                                   testing::brick({0.1, 0.05, 0.05}, {0, 0, 0.0523})};
  set_velocity(bodies[1], {0, 0, -5}, {0, 0, 0});
  return bodies;
}

double deepest_m(Options options) {
  Simulator simulator(falling_brick(), RestitutionTable::Zero(1, 1), options);
  double deepest = 0.0;
  for (int i = 0; i < 5; ++i) {
    simulator.step();
    deepest = std::max(deepest, 0.05 - simulator.bodies()[1].position_m.z());
  }
  return deepest;
}

TEST(Step, BisectionStopsAtTheTimeOfContact) {
  Options plain;
  EXPECT_GT(deepest_m(plain), 1e-3);
  Options cut;
  cut.max_bisections = 4;
  EXPECT_LE(deepest_m(cut), cut.contact_tolerance_m);
}

TEST(Step, PaperLeavesTheOverlapThatTheDefaultRemoves) {
  const auto left_m = [](const Options& options) {
    Simulator simulator(falling_brick(), RestitutionTable::Zero(1, 1), options);
    for (int i = 0; i < 50; ++i) simulator.step();
    return 0.05 - simulator.bodies()[1].position_m.z();
  };
  EXPECT_LE(left_m(Options{}), 2.0 * Options{}.overlap_slop_m);
  EXPECT_GT(left_m(paper_options()), 1e-3);
}

// Without gravity what holds a squeezed brick is rounding alone: no step may be called unsolved.
TEST(Step, SqueezedBrickWithoutLoadIsSolved) {
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Quaterniond turn(
        Eigen::AngleAxisd(0.1 * trial, Eigen::Vector3d(1, 2, 3).normalized()));
    std::vector<RigidBody> bodies;
    for (const double side : {-1.0, 1.0}) {
      bodies.push_back(make_fixed_body(Box{{0.5, 0.5, 0.5}}));
      bodies.back().position_m = turn * Eigen::Vector3d(0, 0, side * 0.55);
      bodies.back().orientation = turn;
    }
    bodies.push_back(testing::brick({0.1, 0.05, 0.05}, {0, 0, 0}));
    bodies.back().orientation = turn;
    set_velocity(bodies.back(), turn * Eigen::Vector3d(3, 1, 0), {0, 0, 0});
    Options options;
    options.gravity_mps2.setZero();
    Simulator simulator(bodies, RestitutionTable::Zero(1, 1), options);
    for (int i = 0; i < 20; ++i) {
      ASSERT_FALSE(simulator.step().unsolved) << "trial " << trial << " step " << i;
    }
  }
}

// What no solve and no sweep can settle is told, in whatever part of the step.
TEST(Step, TellsWhatItLeavesUnsolved) {
  std::vector<RigidBody> endless = testing::tower(3);
  for (std::size_t i = 1; i < endless.size(); ++i) set_velocity(endless[i], {0, 0, -3}, {0, 0, 0});
  Options one_sweep;
  one_sweep.max_collision_sweeps = 1;
  Simulator hasty(endless, RestitutionTable::Constant(1, 1, 0.9), one_sweep);
  EXPECT_TRUE(hasty.step().collisions_unfinished);
  EXPECT_TRUE(hasty.report().unsolved);

  // A brick of 0.1 m between walls 0.09 m apart.
  std::vector<RigidBody> wedged = {make_fixed_body(Box{{0.5, 0.5, 0.5}}),
                                   make_fixed_body(Box{{0.5, 0.5, 0.5}}),
                                   testing::brick({0.1, 0.05, 0.05}, {0, 0, 0})};
  wedged[0].position_m.z() = -0.545;
  wedged[1].position_m.z() = 0.545;
  Simulator stuck(wedged, RestitutionTable::Zero(1, 1), Options{});
  EXPECT_GT(stuck.step().overlaps_left, 0);
  EXPECT_TRUE(stuck.report().unsolved);
}

}  // namespace
}  // namespace ourengine::baraff
