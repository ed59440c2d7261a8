// The continuous truths: trajectories start at the world's states, obey the equations of motion,
// and yield the stated truths when measured.
#include <gtest/gtest.h>

#include <cmath>

#include "experiments/exact/cases/builders.hpp"
#include "tests/exact/measured_trajectory.hpp"
#include "tests/exact/random_parameters.hpp"
#include "tests/support/tolerance.hpp"

namespace brickbench::exact {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr Tolerance k_start = {"trajectory at time 0 against the world", 1e-14, 1.1e-16,
                               "rounding of one quaternion product"};
constexpr Tolerance k_residual = {"equations of motion by central differences", 1e-8, 6.8e-10,
                                  "differences over 2e-5 s: (d^2/6) x''' and rounding 1e-16/d"};
constexpr Tolerance k_end = {"truths against the measured trajectory", 1e-14, 8.8e-16,
                             "the same closed form, evaluated twice"};
constexpr Tolerance k_sampled = {
    "sampled truths against the measured trajectory", 3.0, 1.3,
    "an event is seen up to one step late: in units of the step's share"};

// Cases whose observables are events seen at the next sample, not values at the end.
bool sampled(const ExactCase& exact_case) {
  const auto& id = exact_case.id;
  return id == "impact.ball_apexes" || id == "impact.ball_bounce_times" ||
         id == "rotation.axis_flip" || id == "friction.sliding_stop" ||
         id == "friction.diagonal_slide" || id == "impact.ball_landing" ||
         id == "impact.flat_landing";
}

std::vector<State> states_at(const ExactRun& run, double time_s) {
  std::vector<State> states;
  for (const Body& body : run.world.bodies) states.push_back(body.initial);
  run.trajectory(time_s, states);
  return states;
}

TEST(Trajectory, StartsAtTheWorldsStates) {
  Worst worst;
  std::mt19937_64 generator(2);
  for (const ExactCase& exact_case : exact_cases()) {
    const ExactRun run =
        build(exact_case, testing::random_parameters(exact_case, generator)).value();
    if (!run.trajectory) continue;
    const std::vector<State> states = states_at(run, 0.0);
    for (std::size_t i = 0; i < states.size(); ++i) {
      const State& expected = run.world.bodies[i].initial;
      worst.see((states[i].position_m - expected.position_m).norm(), exact_case.id + " position");
      worst.see((states[i].velocity_mps - expected.velocity_mps).norm() /
                    (1.0 + expected.velocity_mps.norm()),
                exact_case.id + " velocity");
      worst.see((states[i].angular_velocity_radps - expected.angular_velocity_radps).norm() /
                    (1.0 + expected.angular_velocity_radps.norm()),
                exact_case.id + " spin");
      worst.see(angle_between_rad(states[i].orientation, expected.orientation),
                exact_case.id + " attitude");
    }
  }
  EXPECT_TRUE(worst.within(k_start));
}

// Residuals, over the size of the terms, of x' = v, v' = g + F/m, q' = w q / 2 and L' = T.
void see_motion(const ExactCase& exact_case, const ExactRun& run, double time_s, Worst& worst) {
  constexpr double d = 1e-5;
  const auto now = states_at(run, time_s), early = states_at(run, time_s - d),
             late = states_at(run, time_s + d);
  std::vector<Wrench> wrenches(now.size());
  if (run.load) run.load(0, time_s, wrenches);
  for (std::size_t i = 0; i < now.size(); ++i) {
    const Body& body = run.world.bodies[i];
    if (body.fixed) continue;
    const std::string where = exact_case.id + " at " + std::to_string(time_s) + " s";
    const Vector3d rate = (late[i].position_m - early[i].position_m) / (2 * d);
    worst.see((rate - now[i].velocity_mps).norm() / (1.0 + rate.norm()), where + " x'");
    const Vector3d force = run.world.gravity_mps2 + wrenches[i].force_n / body.mass_kg;
    const Vector3d acceleration = (late[i].velocity_mps - early[i].velocity_mps) / (2 * d);
    worst.see((acceleration - force).norm() / (1.0 + force.norm()), where + " v'");
    const Eigen::AngleAxisd turn(late[i].orientation * early[i].orientation.conjugate());
    const Vector3d spin = turn.axis() * turn.angle() / (2 * d);
    worst.see((spin - now[i].angular_velocity_radps).norm() / (1.0 + spin.norm()), where + " q'");
    const Vector3d momentum_rate =
        (spin_momentum_nms(body, late[i]) - spin_momentum_nms(body, early[i])) / (2 * d);
    const double scale = body.inertia_kgm2.maxCoeff() * (1.0 + spin.squaredNorm());
    worst.see((momentum_rate - wrenches[i].torque_nm).norm() / scale, where + " L'");
  }
}

TEST(Trajectory, ObeysNewtonAndEulerWithoutContact) {
  Worst worst;
  std::mt19937_64 generator(3);
  int cases = 0;
  for (const ExactCase& exact_case : exact_cases()) {
    if (exact_case.needs.contacts != Contacts::none) continue;
    for (int i = 0; i < 5; ++i) {
      const ExactRun run =
          build(exact_case, testing::random_parameters(exact_case, generator)).value();
      if (!run.trajectory) continue;
      ++cases;
      const double end = static_cast<double>(run.steps) * run.step_s;
      for (const double share : {0.1, 0.37, 0.74, 0.93}) {
        see_motion(exact_case, run, share * end, worst);
      }
    }
  }
  EXPECT_GE(cases, 40);
  EXPECT_TRUE(worst.within(k_residual));
}

TEST(Trajectory, YieldsTheStatedTruths) {
  Worst end, events;
  std::mt19937_64 generator(4);
  for (const ExactCase& exact_case : exact_cases()) {
    // The times of events must lie inside the run: their cases keep the default parameters.
    const ParameterValues given =
        sampled(exact_case) ? ParameterValues{} : testing::random_parameters(exact_case, generator);
    const ExactRun run = build(exact_case, given).value();
    if (!run.trajectory || exact_case.needs.contact_forces) continue;
    const auto values = testing::measured_trajectory(run, exact_case.observables.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::string where = exact_case.id + " " + exact_case.observables[i].name;
      const double error = (values[i] - run.truths[i].value) / run.truths[i].scale;
      const double share = run.step_s / (static_cast<double>(run.steps) * run.step_s) * 3.0;
      if (sampled(exact_case)) {
        events.see(error / share, where);
      } else {
        end.see(error, where);
      }
    }
  }
  EXPECT_TRUE(end.within(k_end));
  EXPECT_TRUE(events.within(k_sampled));
}

}  // namespace
}  // namespace brickbench::exact
