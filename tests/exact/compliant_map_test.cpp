// The map of compliant contacts with levers and friction against what must hold of any solution.
#include "experiments/exact/schemes/compliant_map.hpp"

#include <gtest/gtest.h>

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

constexpr double k_soft_ball_m = 0.125;
constexpr double k_soft_ball_kg = 1.5;

constexpr Tolerance k_answer = {"laws of the contact's answer", 4e-14, 3.2e-15,
                                "sums of a few terms of size one"};
constexpr Tolerance k_step = {"laws of one solved step", 3e-14, 1.7e-15,
                              "sums over one step of velocities of size one"};
constexpr Tolerance k_creep = {"creep of a rolling ball", 1.5e-11, 8.9e-13,
                               "rounding of speeds over a slip of 1e-4 m/s"};

Scheme compliant_scheme(PositionRule position) {
  Scheme scheme;
  scheme.position = position;
  scheme.gyroscopic = position == PositionRule::runge_kutta_4 ? GyroscopicRule::runge_kutta_4
                                                              : GyroscopicRule::explicit_body;
  scheme.contact = CompliantContact{.time_constant_s = 0.002};
  std::get<CompliantContact>(scheme.contact).impedance_start =
      std::get<CompliantContact>(scheme.contact).impedance_end = 0.9;
  return scheme;
}

ExactRun ball_on_soft_ground(double friction, const State& initial, bool central) {
  ExactRun run;
  run.world.gravity_mps2 = {0.0, 0.0, -k_gravity_mps2};
  run.world.law = {.friction = friction, .restitution = 0.0};
  run.world.bodies = {ground_plane(), ball("ball", k_soft_ball_m, k_soft_ball_kg, initial)};
  run.geometry = sphere_contact(0, 1, k_soft_ball_m, central);
  return run;
}

State state_after(const Scheme& scheme, const ExactRun& run, int steps) {
  std::vector<State> states;
  for (const Body& body : run.world.bodies) states.push_back(body.initial);
  const std::vector<Wrench> wrenches(states.size());
  std::string why;
  for (int k = 0; k < steps; ++k) {
    EXPECT_TRUE(advance(scheme, run, wrenches, states, why)) << why;
  }
  return states[1];
}

// The nearest point f of a cone to -y: the rest y + f is dual to it, and the answer is homogeneous.
TEST(CompliantMap, AnswersWithTheNearestForceOfTheCone) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  Worst worst;
  for (int k = 0; k < 1000; ++k) {
    const double mu = 0.2 + std::abs(normal(random));
    const Vector3d y(normal(random), normal(random), normal(random));
    const CompliantAnswer round = compliant_answer(FrictionSet::circle, mu, y);
    const Vector3d rest = y + round.force;
    worst.see(rest.dot(round.force), "the rest is at right angles to the force");
    worst.see(std::max(0.0, round.force.tail<2>().norm() - mu * round.force.x()), "cone");
    worst.see(std::max(0.0, mu * rest.tail<2>().norm() - rest.x()), "dual cone");
    for (const FrictionSet set : {FrictionSet::circle, FrictionSet::inscribed}) {
      const CompliantAnswer answer = compliant_answer(set, mu, y);
      worst.see((answer.stiffness * y + answer.force).norm() / (1.0 + mu * mu), "homogeneous");
    }
  }
  EXPECT_TRUE(worst.within(k_answer));
}

// Without friction a ball has no lever: the closed formula of the central contact.
TEST(CompliantMap, AgreesWithTheClosedFormulaWhereThereIsNoLever) {
  Worst worst;
  for (const PositionRule rule : {PositionRule::new_velocity, PositionRule::runge_kutta_4}) {
    const Scheme scheme = compliant_scheme(rule);
    const State falling = at({0.0, 0.0, k_soft_ball_m - 1e-4}, {1.0, 0.0, -0.5});
    const State one = state_after(scheme, ball_on_soft_ground(0.0, falling, true), 20);
    const State other = state_after(scheme, ball_on_soft_ground(0.0, falling, false), 20);
    worst.see((one.position_m - other.position_m).norm(), "position");
    worst.see((one.velocity_mps - other.velocity_mps).norm(), "velocity");
  }
  EXPECT_TRUE(worst.within(k_step));
}

// A sliding ball is pushed mu times as hard along as up, on the lever that ends between the
// surfaces.
TEST(CompliantMap, SlidesUnderCoulombsLaw) {
  const double mu = 0.3, h = 0.001;
  const Scheme scheme = compliant_scheme(PositionRule::new_velocity);
  const State start = at({0.0, 0.0, k_soft_ball_m - 1e-5}, {2.0, -1.0, -0.1});
  const State end = state_after(scheme, ball_on_soft_ground(mu, start, false), 1);
  const double up = end.velocity_mps.z() + 0.1 + h * k_gravity_mps2;
  const Vector3d along = Vector3d(2.0, -1.0, 0.0).normalized();
  const double lever = k_soft_ball_m - 0.5e-5;
  const double spin = 2.5 * mu * up * lever / (k_soft_ball_m * k_soft_ball_m);
  Worst worst;
  worst.see((end.velocity_mps.head<2>() - (start.velocity_mps - mu * up * along).head<2>()).norm(),
            "velocity");
  worst.see((end.angular_velocity_radps - spin * Vector3d::UnitZ().cross(along)).norm(), "spin");
  EXPECT_GT(up, 0.05);
  EXPECT_TRUE(worst.within(k_step));
}

// All corners of a face slip alike in their first step, so the whole brick obeys the same law.
TEST(CompliantMap, RubsAFaceAtItsFourCorners) {
  const double mu = 0.3, h = 0.001, half = 0.03125;
  const Scheme scheme = compliant_scheme(PositionRule::new_velocity);
  ExactRun run = ball_on_soft_ground(mu, {}, false);
  const State start = at({0.0, 0.0, half - 1e-5}, {2.0, -1.0, -0.1});
  run.world.bodies = {floor_slab(), box("brick", {0.5, 0.5, half}, k_soft_ball_kg, start)};
  run.geometry = flat_contact(0, 1, half);
  const State end = state_after(scheme, run, 1);
  const double up = end.velocity_mps.z() + 0.1 + h * k_gravity_mps2;
  const Vector3d along = Vector3d(2.0, -1.0, 0.0).normalized();
  Worst worst;
  worst.see((end.velocity_mps.head<2>() - (start.velocity_mps - mu * up * along).head<2>()).norm(),
            "velocity");
  EXPECT_GT(up, 0.05);
  EXPECT_LT(end.angular_velocity_radps.cross(along).z(), 0.0) << "the front corners carry more";
  EXPECT_TRUE(worst.within(k_step));
}

// Rolling steadily, the slip s carries the friction F = m g sin/(1 + m l^2/I): damping s = F/w.
TEST(CompliantMap, CreepsAsItsRegularisationSays) {
  for (const FrictionSet set : {FrictionSet::circle, FrictionSet::inscribed}) {
    Scheme scheme = compliant_scheme(PositionRule::new_velocity);
    scheme.friction = set;
    const double mu = 0.8, angle = 0.2, d = 0.9;
    ExactRun run = ball_on_soft_ground(mu, at({0.0, 0.0, k_soft_ball_m}), false);
    run.world.gravity_mps2 = tilted_gravity_mps2(angle);
    const State s = state_after(scheme, run, 200);
    const double lever = 0.5 * (s.position_m.z() + k_soft_ball_m);
    const double slip = s.velocity_mps.x() - lever * s.angular_velocity_radps.y();
    const double inertia = run.world.bodies[1].inertia_kgm2.y();
    const double force = k_soft_ball_kg * k_gravity_mps2 * std::sin(angle) /
                         (1.0 + k_soft_ball_kg * lever * lever / inertia);
    // Two rows of the pyramid share the tangent, each with mu^2/(2 mu^2 (1 + mu^2)) of the weight.
    const double share = set == FrictionSet::circle ? 1.0 : 1.0 / (1.0 + mu * mu);
    const double weight = share * k_soft_ball_kg * d / (1.0 - d);
    const double damping = 2.0 / (d * 0.002);
    Worst worst;
    worst.see(slip * damping * weight / force - 1.0, "slip");
    EXPECT_TRUE(worst.within(k_creep));
  }
}

TEST(CompliantMap, KeepsTheMomentaOfFreeBodies) {
  const ExactCase hit = testing::find_case("impact.off_centre");
  const Scheme scheme = compliant_scheme(PositionRule::new_velocity);
  const auto values = discrete_truth(hit, build(hit).value(), scheme);
  ASSERT_TRUE(values.has_value());
  Worst worst;
  worst.see(4.0 * (*values)[0] + (*values)[2] - 2.0, "momentum");
  worst.see((*values)[4] + 0.24, "angular momentum");
  EXPECT_LT((*values)[2], 1.0);
  EXPECT_TRUE(worst.within(k_step));
}

TEST(CompliantMap, SaysWhyItLeavesImplicitSpinsOpen) {
  Scheme scheme = compliant_scheme(PositionRule::new_velocity);
  scheme.gyroscopic = GyroscopicRule::newton_body;
  const ExactRun run = ball_on_soft_ground(0.3, at({0.0, 0.0, k_soft_ball_m}), false);
  std::vector<State> states = {run.world.bodies[0].initial, run.world.bodies[1].initial};
  std::string why;
  EXPECT_FALSE(advance(scheme, run, std::vector<Wrench>(2), states, why));
  EXPECT_FALSE(why.empty());
}

}  // namespace
}  // namespace brickbench::exact
