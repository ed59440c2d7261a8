// The map of soft contacts against what mechanics says whatever the sub-steps do.
#include "experiments/exact/soft_map.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "experiments/exact/builders.hpp"
#include "experiments/exact/scheme_map.hpp"
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

Scheme soft_scheme() {
  Scheme scheme;
  scheme.position = PositionRule::mean_velocity;
  scheme.gyroscopic = GyroscopicRule::spatial_momentum;
  scheme.attitude = AttitudeRule::moser_veselov;
  scheme.soft = SoftContact{.substeps = 20,
                            .frequency_hz = 1e9,
                            .damping_ratio = 5.0,
                            .push_limit_mps = 3.0,
                            .margin_m = 5e-4,
                            .resting_approach_mps = 0.1,
                            .keep_share = 1e-3,
                            .same_point_share = 0.1};
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
  std::vector<PointContact> contacts;
  std::string why;
  for (int k = 0; k < steps; ++k) {
    contacts.clear();
    run.geometry(states, contacts);
    EXPECT_TRUE(map.advance(wrenches, contacts, states, why)) << why;
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
  scheme.soft->substeps = 1;
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

TEST(SoftMap, LeavesFacesOpen) {
  ExactRun run = ball_on_ground({}, at({0.0, 0.0, k_radius_m}));
  run.geometry = flat_contact(0, 1, k_radius_m);
  const Scheme scheme = soft_scheme();
  SoftMap map(scheme, run);
  std::vector<State> states = {run.world.bodies[0].initial, run.world.bodies[1].initial};
  std::vector<PointContact> contacts;
  run.geometry(states, contacts);
  std::string why;
  EXPECT_FALSE(map.advance(std::vector<Wrench>(2), contacts, states, why));
  EXPECT_FALSE(why.empty());
}

}  // namespace
}  // namespace brickbench::exact
