// The map of soft contacts against what mechanics says whatever the sub-steps do.
#include "experiments/exact/schemes/soft_map.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "experiments/exact/cases/builders.hpp"
#include "experiments/exact/schemes/box_points.hpp"
#include "experiments/exact/schemes/scheme_map.hpp"
#include "tests/support/tolerance.hpp"

namespace brickbench::exact {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;
using Eigen::Vector3d;

constexpr double k_radius_m = 0.1;
constexpr double k_mass_kg = 2.0;

constexpr Tolerance k_single = {"laws in sub-steps of single precision", 2e-7, 1.5e-8,
                                "one rounding to single precision"};
constexpr Tolerance k_slide = {"sliding on a soft contact", 2e-4, 1.3e-5,
                               "roundings of 480 sub-steps and the building-up of the contact"};
// A ball that rests 1 mm in the ground is pushed out by w/(2 z + k w) = 4800/11 of the overlap per
// second in each sub-step k = 1/4800 s.
constexpr Tolerance k_push = {"overlap left after one sub-step", 1.4e-7, 7e-9,
                              "single precision of the gap"};

constexpr Tolerance k_face = {"rebound of a face, of 2 m/s", 2e-6, 1.2e-7,
                              "what the scheme calls enough, 1e-6 of the approach"};

constexpr Tolerance k_corners = {"eight pushes in single precision", 4e-7, 3.8e-8,
                                 "roundings of eight pushes"};

constexpr Tolerance k_places = {"places of contacts", 1e-15, 5.7e-17, "sums of lengths of 0.5 m"};
constexpr Tolerance k_weight = {"impulses of a stack at rest", 1.2e-6, 1.2e-7,
                                "single precision of the impulses"};

constexpr BoxPlaces k_boxes = {.axis_bias = 1e-3, .parallel = 1e-6, .border_share = 1e-6};

Scheme soft_scheme() {
  Scheme scheme;
  scheme.position = PositionRule::mean_velocity;
  scheme.gyroscopic = GyroscopicRule::spatial_momentum;
  scheme.attitude = AttitudeRule::moser_veselov;
  scheme.cut_turn_rad = 0.02;
  scheme.contact = SoftContact{.substeps = 20,
                               .frequency_hz = 1e9,
                               .damping_ratio = 5.0,
                               .push_limit_mps = 3.0,
                               .margin_m = 5e-4,
                               .resting_approach_mps = 0.1,
                               .keep_share = 1e-3,
                               .same_point_share = 0.1,
                               .same_normal = 0.9,
                               .boxes = k_boxes,
                               .too_deep_share = 0.5,
                               .most_trials = 8,
                               .most_sweeps = 8,
                               .rebound_share = 1e-5,
                               .plain_sweeps = 32,
                               .rebound_sweeps = 32,
                               .rebound_tolerated = 1e-2,
                               .most_rebound_sweeps = 32,
                               .row_rounds = 16,
                               .row_share = 0.1,
                               .round_share = 0.1,
                               .small_turn_rad = 1e-3,
                               .turn_limit_rad = 0.5,
                               .energy_share = 1e-6};
  return scheme;
}

ExactRun ball_on_ground(ContactLaw law, const State& initial) {
  ExactRun run;
  run.step_s = 1.0 / 240.0;
  run.world.gravity_mps2 = {0.0, 0.0, -k_gravity_mps2};
  run.world.law = law;
  run.world.bodies = {ground_plane(), ball("ball", k_radius_m, k_mass_kg, initial)};
  run.geometry = sphere_contact(0, 1, k_radius_m, false);
  return run;
}

std::vector<State> after(const Scheme& scheme, const ExactRun& run, int steps) {
  SoftMap map(scheme, run);
  std::vector<State> states;
  for (const Body& body : run.world.bodies) states.push_back(body.initial);
  const std::vector<Wrench> wrenches(states.size());
  std::string why;
  for (int k = 0; k < steps; ++k) {
    EXPECT_TRUE(map.advance(wrenches, states, why)) << why;
  }
  return states;
}

// The spring carries m g at the depth g/w^2, w = 1/k.
TEST(SoftMap, RestsAtTheDepthOfItsSpring) {
  const auto states = after(soft_scheme(), ball_on_ground({}, at({0.0, 0.0, k_radius_m})), 100);
  Worst worst;
  worst.see(states[1].velocity_mps.norm(), "velocity");
  const double depth_m = k_gravity_mps2 / (4800.0 * 4800.0);
  worst.see((states[1].position_m.z() - k_radius_m + depth_m) / k_radius_m, "height");
  EXPECT_TRUE(worst.within(k_single));
}

TEST(SoftMap, PushesOverlapsOutAtItsRate) {
  Scheme scheme = soft_scheme();
  std::get<SoftContact>(scheme.contact).substeps = 1;
  ExactRun run = ball_on_ground({}, at({0.0, 0.0, k_radius_m - 1e-3}));
  run.step_s = 1.0 / 4800.0;
  run.world.gravity_mps2.setZero();
  const auto states = after(scheme, run, 1);
  // Speed of the biased sweep: s m_n (v + b)/m, with s = 11/12 of b = depth 4800/11.
  const double left_m = 1e-3 * (1.0 - 11.0 / 12.0 / 11.0);
  Worst worst;
  worst.see((k_radius_m - states[1].position_m.z()) / left_m - 1.0, "overlap");
  worst.see(states[1].velocity_mps.norm(), "velocity after the relaxing sweep");
  EXPECT_TRUE(worst.within(k_push));
}

TEST(SoftMap, ReboundsByNewtonsLaw) {
  const ContactLaw law = {.friction = 0.0, .restitution = 0.8};
  const State falling = at({0.0, 0.0, k_radius_m + 1e-4}, {0.0, 0.0, -2.0});
  const auto states = after(soft_scheme(), ball_on_ground(law, falling), 1);
  Worst worst;
  worst.see(states[1].velocity_mps.z() / 1.6 - 1.0, "velocity");
  EXPECT_TRUE(worst.within(k_single));
}

// Sliding friction takes mu g of the velocity and gives the spin 5 mu g/(2 r).
TEST(SoftMap, SlidesUnderCoulombsLaw) {
  const ContactLaw law = {.friction = 0.3, .restitution = 0.0};
  const State sliding = at({0.0, 0.0, k_radius_m}, {3.0, 0.0, 0.0});
  const auto states = after(soft_scheme(), ball_on_ground(law, sliding), 24);
  const double braked = 0.3 * k_gravity_mps2 * 0.1;
  Worst worst;
  worst.see((states[1].velocity_mps.x() - (3.0 - braked)) / 3.0, "velocity");
  worst.see(states[1].angular_velocity_radps.y() * k_radius_m / (2.5 * braked) - 1.0, "spin");
  EXPECT_TRUE(worst.within(k_slide));
}

ExactRun brick_on_slab(ContactLaw law, const Vector3d& velocity_mps, const Vector3d& spin_radps) {
  ExactRun run = ball_on_ground(law, State{});
  const Vector3d half_m(0.2, 0.15, 0.1);
  run.world.bodies = {floor_slab(), box("brick", half_m, k_mass_kg,
                                        at({0.0, 0.0, half_m.z()}, velocity_mps, spin_radps))};
  run.geometry = flat_contact(0, 1, half_m.z());
  return run;
}

TEST(SoftMap, FaceRestsLevel) {
  const auto states = after(soft_scheme(), brick_on_slab({}, {0, 0, 0}, {0, 0, 0}), 100);
  Worst worst;
  worst.see(states[1].velocity_mps.norm(), "velocity");
  worst.see(states[1].angular_velocity_radps.norm() * 0.2, "spin");
  worst.see(std::min(0.0, 0.1 - states[1].position_m.z()) / 0.1, "above the slab");
  EXPECT_TRUE(worst.within(k_single));
  EXPECT_GT(0.1 - states[1].position_m.z(), 1e-8) << "a spring has a depth";
}

// A face slides as a ball does, and the sum of the friction of its points turns nothing.
TEST(SoftMap, FaceSlidesUnderCoulombsLaw) {
  const ContactLaw law = {.friction = 0.3, .restitution = 0.0};
  const auto states = after(soft_scheme(), brick_on_slab(law, {3.0, 0.0, 0.0}, {0, 0, 0}), 24);
  Worst worst;
  worst.see((states[1].velocity_mps.x() - (3.0 - 0.3 * k_gravity_mps2 * 0.1)) / 3.0, "velocity");
  worst.see(states[1].angular_velocity_radps.z() * 0.2 / 3.0, "spin");
  EXPECT_TRUE(worst.within(k_slide));
}

// The twist is stopped by mu m g times the mean distance of the corners, 0.25 m.
TEST(SoftMap, FaceTwistsUnderCoulombsLaw) {
  const ContactLaw law = {.friction = 0.3, .restitution = 0.0};
  const ExactRun run = brick_on_slab(law, {0, 0, 0}, {0.0, 0.0, 8.0});
  const auto states = after(soft_scheme(), run, 24);
  const double braking =
      0.3 * k_mass_kg * k_gravity_mps2 * 0.25 / run.world.bodies[1].inertia_kgm2.z();
  Worst worst;
  worst.see((states[1].angular_velocity_radps.z() - (8.0 - 0.1 * braking)) / 8.0, "spin");
  EXPECT_TRUE(worst.within(k_slide));
}

TEST(SoftMap, FaceReboundsByNewtonsLaw) {
  const ContactLaw law = {.friction = 0.0, .restitution = 0.5};
  ExactRun run = brick_on_slab(law, {0.0, 0.0, -2.0}, {0, 0, 0});
  run.world.gravity_mps2.setZero();
  const auto states = after(soft_scheme(), run, 1);
  Worst worst;
  worst.see(states[1].velocity_mps.z() - 1.0, "velocity");
  worst.see(states[1].angular_velocity_radps.norm() * 0.25, "spin");
  EXPECT_TRUE(worst.within(k_face));
}

// One sub-step by hand: corners (+ +), (- +), (- -), (+ -) pushed one after the other, first so
// that the gap may close, then again with the gap that is left.
TEST(SoftMap, CornersOfAFaceAreServedInTheirOrder) {
  constexpr double k_gap_m = 1e-4, k_fall_mps = 2.0;
  Scheme scheme = soft_scheme();
  std::get<SoftContact>(scheme.contact).substeps = 1;
  std::get<SoftContact>(scheme.contact).resting_approach_mps =
      2.0 * k_fall_mps;  // no hit that Newton's law would settle
  ExactRun run = brick_on_slab({}, {0.0, 0.0, -k_fall_mps}, {0, 0, 0});
  run.step_s = 1.0 / 4800.0;
  run.world.gravity_mps2.setZero();
  Body& brick = run.world.bodies[1];
  brick.initial.position_m.z() += k_gap_m;
  const auto& half_m = std::get<BoxShape>(brick.shape).half_extents_m;
  std::array<Vector3d, 4> arms;  // lever x normal
  std::array<double, 4> masses_kg{}, impulses_ns{};
  for (std::size_t p = 0; p < 4; ++p) {
    const Vector3d lever(p == 0 || p == 3 ? half_m.x() : -half_m.x(),
                         p < 2 ? half_m.y() : -half_m.y(), -half_m.z());
    arms[p] = lever.cross(Vector3d::UnitZ());
    masses_kg[p] = 1.0 / (1.0 / k_mass_kg + arms[p].dot(arms[p].cwiseQuotient(brick.inertia_kgm2)));
  }
  double fall_mps = -k_fall_mps, fallen_m = 0.0;
  Vector3d spin = Vector3d::Zero(), turned = Vector3d::Zero();
  for (int round = 0; round < 2; ++round) {
    for (std::size_t p = 0; p < 4; ++p) {
      const double gap_m = k_gap_m + fallen_m + arms[p].dot(turned);
      const double aim_mps = gap_m > 0.0 ? -gap_m / run.step_s : 0.0;
      const double push_ns =
          std::max(-impulses_ns[p], masses_kg[p] * (aim_mps - fall_mps - arms[p].dot(spin)));
      impulses_ns[p] += push_ns;
      fall_mps += push_ns / k_mass_kg;
      spin += push_ns * arms[p].cwiseQuotient(brick.inertia_kgm2);
    }
    if (round > 0) break;
    fallen_m = fall_mps * run.step_s;
    turned = spin * run.step_s;
  }
  const auto states = after(scheme, run, 1);
  Worst worst;
  worst.see((states[1].velocity_mps.z() - fall_mps) / k_fall_mps, "velocity");
  const Vector3d momentum_nms = spin.cwiseProduct(brick.inertia_kgm2);
  const double scale_nms = k_mass_kg * k_fall_mps * 0.25;
  worst.see((spin_momentum_nms(brick, states[1]) - momentum_nms).norm() / scale_nms, "spin");
  EXPECT_TRUE(worst.within(k_corners));
  EXPECT_GT(spin.norm(), 0.1) << "their order shows";
}

// One sub-step of 1/240 s at 2 m/s is too much for one sweep, and for eight, and the step would be
// cut; 5 cm/s is not.
TEST(SoftMap, RepeatsSweepsThatLeaveAFaceTooDeep) {
  Scheme scheme = soft_scheme();
  std::get<SoftContact>(scheme.contact).substeps = 1;
  const auto sweeps = [&](double fall_mps) {
    const ExactRun run = brick_on_slab({}, {0.0, 0.0, -fall_mps}, {0, 0, 0});
    std::vector<State> states = {run.world.bodies[0].initial, run.world.bodies[1].initial};
    std::string why;
    SoftMap map(scheme, run);
    const bool whole = map.advance(std::vector<Wrench>(2), states, why);
    EXPECT_EQ(whole, map.sweeps() < 8);
    EXPECT_EQ(why.empty(), whole) << why;
    return map.sweeps();
  };
  EXPECT_EQ(sweeps(2.0), 8);
  EXPECT_EQ(sweeps(0.05), 1);
}

// Two bricks, neither named as a contact; shifted by more than 0.1 m the upper one overhangs.
ExactRun stack(double shift_m) {
  ExactRun run = brick_on_slab({.friction = 0.5, .restitution = 0.0}, {0, 0, 0}, {0, 0, 0});
  run.world.bodies.push_back(box("upper", Vector3d(0.1, 0.1, 0.05), 1.0, at({shift_m, 0.0, 0.25})));
  run.geometry = nullptr;
  return run;
}

TEST(SoftMap, FindsAStackAndTellsItsForces) {
  Worst worst;
  for (const double shift_m : {0.05, 0.15}) {
    const ExactRun run = stack(shift_m);
    const Scheme scheme = soft_scheme();
    SoftMap map(scheme, run);
    std::vector<State> states;
    for (const Body& body : run.world.bodies) states.push_back(body.initial);
    std::string why;
    for (int k = 0; k < 200; ++k) {
      ASSERT_TRUE(map.advance(std::vector<Wrench>(3), states, why)) << why;
    }
    const std::vector<Contact> contacts = map.contacts();
    Sample sample;
    sample.contacts = &contacts;
    const double weight_ns = 3.0 * k_gravity_mps2 * run.step_s;
    worst.see(pair_impulse_ns(sample, 0, 1).z() / weight_ns - 1.0, "both on the slab");
    worst.see(3.0 * pair_impulse_ns(sample, 1, 2).z() / weight_ns - 1.0, "the upper on the lower");
    // The upper one rests up to the border of the lower one, and no further.
    double reach_m = 0.0;
    for (const Contact& contact : contacts) {
      if (contact.body_a == 1) reach_m = std::max(reach_m, contact.position_m.x());
    }
    worst.see(reach_m - std::min(0.2, shift_m + 0.1), "border");
  }
  EXPECT_TRUE(worst.within(k_weight));
}

TEST(SoftMap, SaysWhatItDoesNotList) {
  ExactRun run = stack(0.0);
  run.world.bodies[1] = ball("ball", k_radius_m, k_mass_kg, at({0.0, 0.0, k_radius_m}));
  const Scheme scheme = soft_scheme();
  SoftMap map(scheme, run);
  std::vector<State> states;
  for (const Body& body : run.world.bodies) states.push_back(body.initial);
  std::string why;
  EXPECT_FALSE(map.advance(std::vector<Wrench>(3), states, why));
  EXPECT_NE(why.find("ball"), std::string::npos);
}

State turned(const Vector3d& position_m, double angle_rad, const Vector3d& axis) {
  State state = at(position_m);
  state.orientation = Eigen::AngleAxisd(angle_rad, axis);
  return state;
}

// Two cubes of 0.2 m, edge across edge, 1 mm apart.
TEST(BoxPoints, EdgesThatCrossMeetMidway) {
  const Vector3d half_m(0.1, 0.1, 0.1);
  const double eighth = 0.25 * std::numbers::pi, height_m = 0.2 * std::numbers::sqrt2 + 1e-3;
  const BoxPoints met =
      box_points(k_boxes, half_m, turned({0.03, 0.0, 0.0}, eighth, Vector3d::UnitX()), half_m,
                 turned({0.0, 0.02, height_m}, eighth, Vector3d::UnitY()));
  ASSERT_EQ(met.points.size(), 1U);
  const Vector3d upper_edge(0.0, 0.0, height_m - 0.1 * std::numbers::sqrt2);
  Worst worst;
  worst.see(met.gap_m - 1e-3, "gap");
  worst.see((met.normal - Vector3d::UnitZ()).norm(), "normal");
  worst.see((met.points[0].on_b_m - upper_edge).norm(), "place");
  EXPECT_TRUE(worst.within(k_places));
}

// A cube stands on its edge over a plate, which is made last: the plate shows its face.
TEST(BoxPoints, FaceOfTheSecondBoxCountsWhereItIsFurther) {
  const double height_m = 0.1 * std::numbers::sqrt2 + 0.05 + 1e-3;
  const BoxPoints met =
      box_points(k_boxes, Vector3d(0.1, 0.1, 0.1),
                 turned({0.0, 0.0, height_m}, 0.25 * std::numbers::pi, Vector3d::UnitY()),
                 Vector3d(0.5, 0.5, 0.05), at({0.0, 0.0, 0.0}));
  Worst worst;
  worst.see((met.normal + Vector3d::UnitZ()).norm(), "normal");
  int low = 0;
  for (const BoxPoint& point : met.points) {
    worst.see(point.on_b_m.z() - 0.05, "on the plate");
    if (point.gap_m > 2e-3) continue;
    worst.see(point.gap_m - 1e-3, "gap");
    worst.see(point.on_b_m.x(), "edge");
    ++low;
  }
  EXPECT_EQ(low, 2);
  EXPECT_TRUE(worst.within(k_places));
}

}  // namespace
}  // namespace brickbench::exact
