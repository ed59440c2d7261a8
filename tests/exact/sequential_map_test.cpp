// The map of contacts hit one after the other against closed formulas and against what its steps
// must leave behind.
#include "experiments/exact/schemes/sequential_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "experiments/exact/cases/builders.hpp"
#include "experiments/exact/schemes/scheme_map.hpp"
#include "tests/exact/random_parameters.hpp"
#include "tests/support/tolerance.hpp"

namespace brickbench::exact {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;
using Eigen::Vector3d;

constexpr Tolerance k_formula = {"single hits against closed formulas", 4e-15, 2.3e-16,
                                 "rounding of one impulse"};
constexpr Tolerance k_hit_balance = {"conserved sums over one step", 4e-15, 2.3e-16,
                                     "rounding of some dozens of impulses"};
constexpr Tolerance k_rest = {"acceleration and turn at rest, per g", 1e-13, 6.7e-15,
                              "projected Gauss-Seidel to rounding"};

Scheme sequential_scheme(double share) {
  Scheme scheme;
  scheme.position = PositionRule::old_velocity;
  scheme.gyroscopic = GyroscopicRule::spatial_momentum;
  scheme.attitude = AttitudeRule::normalised_euler;
  scheme.contact = SequentialContact{.margin_m = 1e-6,
                                     .border_share = 1e-6,
                                     .collision_velocity_mps = 1e-3,
                                     .most_sweeps = 20000,
                                     .velocity_share = share,
                                     .overlap_share = share,
                                     .overlap_slop_m = 1e-7,
                                     .slow_hit_steps = 2.0};
  return scheme;
}

ExactRun run_of(std::string_view id) { return build(testing::find_case(id)).value(); }

std::vector<double> sequential_truth(std::string_view id, double share) {
  const ExactCase exact_case = testing::find_case(id);
  return discrete_truth(exact_case, build(exact_case).value(), sequential_scheme(share)).value();
}

std::vector<State> start_of(const ExactRun& run) {
  std::vector<State> states;
  for (const Body& body : run.world.bodies) states.push_back(body.initial);
  return states;
}

// Advances by one step without loads beyond `wrenches` (bodies).
void one_step(const ExactRun& run, double share, std::vector<State>& states,
              std::vector<Wrench> wrenches = {}) {
  wrenches.resize(states.size());
  std::string why;
  ASSERT_TRUE(advance_sequential(sequential_scheme(share), run, wrenches, states, why)) << why;
}

// A box of the given half extents above a frictionless slab or plane.
ExactRun box_on(const Body& ground, const Vector3d& half_m, double gap_m) {
  ExactRun run;
  run.world.gravity_mps2 = {0.0, 0.0, -k_gravity_mps2};
  run.world.bodies = {ground, box("brick", half_m, 5.0, at({0.0, 0.0, half_m.z() + gap_m}))};
  run.geometry = flat_contact(0, 1, half_m.z());
  return run;
}

TEST(SequentialMap, CradleLetsTheLastBallLeaveAlone) {
  Worst worst;
  for (const double share : {0.0, 1.0}) {
    const std::vector<double> v = sequential_truth("impact.cradle", share);
    const std::vector<double> expected = {0.0, 0.0, 1.0, 1.0, 0.5};
    for (std::size_t i = 0; i < v.size(); ++i) worst.see(v[i] - expected[i], std::to_string(i));
  }
  EXPECT_TRUE(worst.within(k_formula));
}

TEST(SequentialMap, OneCornerFollowsTheClosedImpulse) {
  const ExactRun run = run_of("impact.corner");
  const std::vector<double> v = sequential_truth("impact.corner", 0.0);
  Worst worst;
  // The spin and its energy are read after the turn of the step, at the same momentum.
  for (const std::size_t i : {std::size_t{0}, std::size_t{3}}) {
    worst.see((v[i] - run.truths[i].value) / run.truths[i].scale, std::to_string(i));
  }
  EXPECT_TRUE(worst.within(k_formula));
}

TEST(SequentialMap, ListsTheCornersOfABoxInTheStatedOrder) {
  const Vector3d half(0.3, 0.2, 0.1);
  const ExactRun slab = box_on(floor_slab(), half, 0.0);
  const ExactRun plane = box_on(ground_plane(), half, 0.0);
  const auto signs = [&](const ExactRun& run) {
    std::string text;
    for (const TouchingPoint& p : touching_points(run, start_of(run), 1e-6, 1e-6)) {
      text += p.position_m.x() > 0.0 ? '+' : '-';
      text += p.position_m.y() > 0.0 ? "+ " : "- ";
    }
    return text;
  };
  EXPECT_EQ(signs(slab), "++ -+ -- +- ");
  EXPECT_EQ(signs(plane), "-- +- -+ ++ ");
}

TEST(SequentialMap, HitsLeaveNoApproachAndCreateNoEnergy) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  Worst sideways, gained;
  double fastest_approach = 0.0;
  for (int trial = 0; trial < 50; ++trial) {
    ExactRun run = box_on(floor_slab(), {0.3, 0.2, 0.1}, 0.0);
    run.world.gravity_mps2.setZero();
    run.world.law.restitution = 0.5 * (1.0 + any(random));
    std::vector<State> states = start_of(run);
    states[1].velocity_mps = Vector3d(any(random), any(random), -1.5 + any(random));
    states[1].angular_velocity_radps = 3.0 * Vector3d(any(random), any(random), any(random));
    const std::vector<TouchingPoint> touching = touching_points(run, states, 1e-6, 1e-6);
    const std::vector<State> before = states;
    // A step so short that nothing moves: what is left is the answer to the impact.
    run.step_s = 1e-12;
    one_step(run, 0.0, states);
    for (const TouchingPoint& p : touching) {
      const Vector3d arm = p.position_m - before[1].position_m;
      const Vector3d v = states[1].velocity_mps + states[1].angular_velocity_radps.cross(arm);
      fastest_approach = std::max(fastest_approach, -v.z());
    }
    const Vector3d change = states[1].velocity_mps - before[1].velocity_mps;
    sideways.see(change.head<2>().norm(), std::to_string(trial));
    const double was_j = kinetic_energy_j(run.world, before);
    const double is_j = kinetic_energy_j(run.world, states);
    gained.see(std::max(0.0, is_j - was_j) / was_j, std::to_string(trial));
  }
  EXPECT_LE(fastest_approach, 1e-3 + 1e-9);
  EXPECT_TRUE(sideways.within(k_hit_balance));
  EXPECT_TRUE(gained.within(k_hit_balance));
}

// The speed at which a box leaves a slab that it meets flat, in shares of the approach.
double flat_parting(bool at_once, double restitution) {
  ExactRun run = box_on(floor_slab(), {0.3, 0.2, 0.1}, 0.0);
  run.world.gravity_mps2.setZero();
  run.world.law.restitution = restitution;
  Scheme scheme = sequential_scheme(0.0);
  std::get<SequentialContact>(scheme.contact).hits_at_once = at_once;
  std::vector<State> states = start_of(run);
  states[1].velocity_mps.z() = -2.0;
  std::string why;
  EXPECT_TRUE(advance_sequential(scheme, run, std::vector<Wrench>(2), states, why)) << why;
  return states[1].velocity_mps.z() / 2.0;
}

TEST(SequentialMap, FacesThatAreHitAtOncePartWithTheRestitution) {
  Worst worst;
  for (int tenth = 0; tenth <= 10; ++tenth) {
    worst.see(flat_parting(true, 0.1 * tenth) - 0.1 * tenth, std::to_string(tenth));
  }
  EXPECT_TRUE(worst.within(k_rest));
  // Hit in turn, the corners throw each other off.
  EXPECT_GT(std::abs(flat_parting(false, 0.5) - 0.5), 0.01);
}

// Half the share is left to the map, twice the share is cut: it predicts nothing then.
TEST(SequentialMap, SaysWhereTheStepIsCut) {
  for (const double gap_m : {0.0005, 0.01}) {
    for (const double share : {0.5, 2.0}) {
      ExactRun run = box_on(floor_slab(), {0.3, 0.2, 0.1}, gap_m);
      Scheme scheme = sequential_scheme(1.0);
      std::get<SequentialContact>(scheme.contact).depth_share = 0.25;
      std::vector<State> states = start_of(run);
      states[1].velocity_mps.z() = -(gap_m + share * 0.25 * 0.2) / run.step_s;
      std::string why;
      EXPECT_EQ(advance_sequential(scheme, run, std::vector<Wrench>(2), states, why), share < 1.0);
      EXPECT_EQ(why.find("cut") != std::string::npos, share > 1.0) << why;
    }
  }
}

TEST(SequentialMap, RestingFaceCarriesALoadInsideItAndTipsBeyond) {
  const Vector3d half(0.3, 0.2, 0.1);
  const ExactRun run = box_on(floor_slab(), half, 0.0);
  Worst held;
  for (const double lever_m : {0.0, 0.2, 0.29, 0.45}) {
    std::vector<State> states = start_of(run);
    std::vector<Wrench> wrenches(2);
    // Weight and as much again, at twice the lever: the sum acts at the lever.
    const double weight_n = run.world.bodies[1].mass_kg * k_gravity_mps2;
    wrenches[1].force_n = {0.0, 0.0, -weight_n};
    wrenches[1].torque_nm = {0.0, 2.0 * lever_m * weight_n, 0.0};
    one_step(run, 0.0, states, wrenches);
    const double turned = states[1].angular_velocity_radps.norm() / (k_gravity_mps2 * run.step_s);
    const double moved = std::abs(states[1].velocity_mps.z()) / (k_gravity_mps2 * run.step_s);
    if (lever_m < half.x()) {
      held.see(std::max(turned, moved), std::to_string(lever_m));
    } else {
      EXPECT_GT(turned, 0.1);
    }
  }
  EXPECT_TRUE(held.within(k_rest));
}

TEST(SequentialMap, OverlapIsUndoneWithoutVelocity) {
  const Vector3d half(0.3, 0.2, 0.1);
  const ExactRun run = box_on(floor_slab(), half, -1e-3);
  std::vector<State> states = start_of(run);
  one_step(run, 1.0, states);
  Worst worst;
  worst.see(states[1].position_m.z() - half.z(), "height");
  worst.see(states[1].velocity_mps.norm(), "velocity");
  EXPECT_TRUE(worst.within(k_rest));
  std::vector<State> kept = start_of(run);
  one_step(run, 0.0, kept);
  EXPECT_DOUBLE_EQ(kept[1].position_m.z(), half.z() - 1e-3);
}

TEST(SequentialMap, OverlapThatPartsByItselfIsLeftToItsVelocity) {
  const Vector3d half(0.3, 0.2, 0.1);
  const ExactRun run = box_on(floor_slab(), half, -1e-3);
  Worst worst;
  for (const double speed_mps : {0.002, 0.5, 20.0}) {
    std::vector<State> states = start_of(run);
    states[1].velocity_mps.z() = speed_mps;
    one_step(run, 1.0, states);
    worst.see(states[1].position_m.z() - (half.z() - 1e-3 + speed_mps * run.step_s), "height");
    worst.see(states[1].velocity_mps.z() - (speed_mps - k_gravity_mps2 * run.step_s), "velocity");
  }
  EXPECT_TRUE(worst.within(k_rest));
}

TEST(SequentialMap, MovesUndoWhatTheStepsMotionWouldLeave) {
  // Slower than the threshold: the force undoes the velocity, the position still takes it along.
  const Vector3d half(0.3, 0.2, 0.1);
  const ExactRun run = box_on(floor_slab(), half, -1e-3);
  Worst worst;
  for (const PositionRule rule : {PositionRule::old_velocity, PositionRule::middle_momentum}) {
    Scheme scheme = sequential_scheme(1.0);
    scheme.position = rule;
    std::vector<State> states = start_of(run);
    states[1].velocity_mps.z() = -5e-4;
    std::string why;
    ASSERT_TRUE(advance_sequential(scheme, run, std::vector<Wrench>(2), states, why)) << why;
    worst.see(states[1].position_m.z() - half.z(), "height");
    worst.see(states[1].velocity_mps.norm(), "velocity");
  }
  EXPECT_TRUE(worst.within(k_rest));
}

TEST(SequentialMap, BallRollsRoundAnotherWithItsCentripetalForce) {
  // A ball that passes the top of a fixed one at v: it leaves the surface where v^2/d > g.
  ExactRun run;
  run.world.gravity_mps2 = {0.0, 0.0, -k_gravity_mps2};
  constexpr double k_radius_m = 0.1;
  run.world.bodies = {fixed_body("fixed", SphereShape{k_radius_m}, at({0.0, 0.0, 0.0})),
                      ball("ball", k_radius_m, 1.0, at({0.0, 0.0, 2.0 * k_radius_m}))};
  run.geometry = sphere_row_contact({0, 1}, k_radius_m);
  Worst worst;
  for (const double square : {0.25, 0.5, 2.0}) {
    std::vector<State> states = start_of(run);
    const double v = std::sqrt(square * k_gravity_mps2 * 2.0 * k_radius_m);
    states[1].velocity_mps.x() = v;
    one_step(run, 0.0, states);
    const double fall = -states[1].velocity_mps.z() / (k_gravity_mps2 * run.step_s);
    worst.see(fall - std::min(square, 1.0), std::to_string(square));
  }
  EXPECT_TRUE(worst.within(k_rest));
}

}  // namespace
}  // namespace brickbench::exact
