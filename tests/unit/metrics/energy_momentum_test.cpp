// Energy and momentum on trajectories whose balances are known in closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/tolerance.hpp"
#include "tests/unit/metrics/metric_runs.hpp"

namespace brickbench::testing {
namespace {

constexpr Tolerance k_rounding{"relative rounding of a balance", 1e-14, 6.1e-16,
                               "sums of a few terms, each rounded to 1.1e-16"};

// One brick hits an equal one head on; e = 0.5 by momentum and Newton's law; the hit lies at
// step 5.
SyntheticRun head_on() {
  SyntheticRun run{
      .scene = scene_of({test_brick("a", {-0.5, 0, 0}, {2, 0, 0}), test_brick("b")}, {0, 0, 0}),
      .step_s = 0.01,
      .steps = 10};
  run.states = [start = initial_states(run.scene)](std::size_t step) {
    auto states = start;
    if (step >= 5) {
      states[0].velocity_mps.x() = 0.5;
      states[1].velocity_mps.x() = 1.5;
    }
    for (auto& state : states) {
      state.position_m += 0.01 * static_cast<double>(step) * state.velocity_mps;
    }
    states[0].position_m.x() = start[0].position_m.x() + 0.05 + 0.001 * static_cast<double>(step);
    return states;
  };
  return run;
}

TEST(Energy, ExactFreeFlightKeepsIt) {
  const SyntheticRun run = free_flight();
  const auto found = measure("energy", run);
  // 2 kg: 25 v.v/2 + spin 0.5 I_x 25; 6 kg: 5 v.v/2 + 0.5 I_z 49; both at 10 m.
  const double i_x = 2.0 / 12 * (0.01 + 0.01);
  const double i_z = 6.0 / 12 * (0.04 + 0.01);
  const double expected_j = 25.0 + 12.5 * i_x + 15.0 + 24.5 * i_z + 8.0 * 9.81 * 10.0;
  Worst worst;
  worst.see(value(found, "energy_initial_j") / expected_j - 1.0, "initial");
  worst.see(value(found, "energy_final_j") / expected_j - 1.0, "final");
  worst.see(value(found, "energy_max_rise_j") / expected_j, "rise");
  EXPECT_TRUE(worst.within(k_rounding));
}

TEST(Energy, HeadOnHitTakesWhatNewtonsLawSays) {
  const auto found = measure("energy", head_on());
  Worst worst;  // 0.5 * 2 * (4 - 0.25 - 2.25) = 1.5 J of 4 J
  worst.see(value(found, "energy_dissipated_j") - 1.5, "dissipated");
  worst.see(value(found, "energy_net_drift_j") + 1.5, "drift");
  worst.see(value(found, "energy_net_drift_relative") + 0.375, "relative");
  worst.see(value(found, "energy_created_j"), "created");
  EXPECT_TRUE(worst.within(k_rounding));
}

// A blow and a couple in one step, from rest: the work is p^2 / 2m + L^2 / 2I, whatever the step.
TEST(Energy, WorkOfABlowIsWhatItLeavesBehind) {
  SyntheticRun run{
      .scene = scene_of({test_brick("struck")}, {0, 0, 0}), .step_s = 0.01, .steps = 3};
  const double i_x = 2.0 / 12 * 0.02;
  run.wrenches = [](std::size_t step) {
    return std::vector<Wrench>{step == 2 ? Wrench{{400, 0, 0}, {1, 0, 0}} : Wrench{}};
  };
  run.states = [i_x](std::size_t step) {
    State state;
    if (step >= 2) {
      state.velocity_mps.x() = 2.0;
      state.angular_velocity_radps.x() = 0.01 / i_x;
      state.position_m.x() = 0.02 * static_cast<double>(step - 1);
    }
    return std::vector<State>{state};
  };
  const auto energy = measure("energy", run);
  const auto momentum = measure("momentum", run);
  Worst worst;
  worst.see(value(energy, "external_work_j") - (4.0 + 0.5 * 1e-4 / i_x), "work");
  worst.see(value(energy, "energy_net_drift_relative"), "drift");
  worst.see(value(momentum, "linear_momentum_error_relative"), "linear");
  worst.see(value(momentum, "angular_momentum_error_relative"), "angular");
  EXPECT_TRUE(worst.within(k_rounding));
}

TEST(Energy, NoticesALeakOfOneInAMillion) {
  SyntheticRun run = free_flight();
  run.states = [exact = run.states](std::size_t step) {
    auto states = exact(step);
    if (step >= 50) states[1].velocity_mps *= 1.0 + 5e-7;
    return states;
  };
  const auto found = measure("energy", run);
  const double created_j = value(found, "energy_created_j");
  EXPECT_GT(created_j, 0.9 * 6e-6 * 0.5 * (4.0 + std::pow(1.0 - 0.4905, 2)));
  EXPECT_LT(created_j, 3e-5);
  EXPECT_EQ(find(found, "energy_max_rise_j").note, "at 0.05 s");
}

TEST(Energy, NoticesHalfGravity) {
  const auto found = measure("energy", free_flight(0.5));
  // Half of what is lost in height does not come back as speed: -m g (v t + g t^2/4 - ...) by hand:
  // dE = m g/2 (v_z t - g t^2 / 4) per body.
  const double t = 0.1;
  const double expected_j = 0.5 * 9.81 * (2 * (4 * t) + 6 * (1 * t) - 8 * 9.81 * t * t / 4);
  EXPECT_NEAR(value(found, "energy_net_drift_j"), expected_j, 1e-10);
}

TEST(Momentum, IsExactWhereOnlyGravityActs) {
  const auto found = measure("momentum", free_flight());
  Worst worst;
  worst.see(value(found, "linear_momentum_error_relative"), "linear");
  worst.see(value(found, "angular_momentum_error_relative"), "angular");
  EXPECT_TRUE(worst.within(k_rounding));
}

TEST(Momentum, NoticesHalfGravityAndSmallLeaks) {
  EXPECT_NEAR(value(measure("momentum", free_flight(0.5)), "linear_momentum_error_ns"),
              8 * 9.81 * 0.5 * 0.1, 1e-12);
  SyntheticRun run = free_flight();
  run.states = [exact = run.states](std::size_t step) {
    auto states = exact(step);
    if (step >= 50) states[1].velocity_mps *= 1.0 + 1e-6;
    if (step >= 50) states[0].angular_velocity_radps *= 1.0 + 1e-6;
    return states;
  };
  const auto leak = measure("momentum", run);
  EXPECT_GT(value(leak, "linear_momentum_error_relative"), 1e-7);
  EXPECT_GT(value(leak, "angular_momentum_error_relative"), 1e-8);
}

TEST(Momentum, NoticesSwappedBodies) {
  SyntheticRun run = free_flight();
  run.states = [exact = run.states](std::size_t step) {
    auto states = exact(step);
    if (step > 0) std::swap(states[0], states[1]);
    return states;
  };
  EXPECT_GT(value(measure("momentum", run), "linear_momentum_error_relative"), 0.1);
  EXPECT_GT(value(measure("energy", run), "energy_created_j"), 1.0);
}

// A brick at rest on the ground: the ground gives the weight back, if the engine tells so.
SyntheticRun resting(double told_share) {
  SyntheticRun run{
      .scene = scene_of({ground_plane(), test_brick("brick", {0, 0, 0.05})}, {0, 0, -9.81})};
  run.states = [start = initial_states(run.scene)](std::size_t) { return start; };
  run.contacts = [told_share](std::size_t) {
    Contact one{.body_a = 0, .body_b = 1, .position_m = {0.1, 0, 0}};
    one.impulse_ns = {0, 0, told_share * 0.5 * 2.0 * 9.81 * 0.001};
    Contact other = one;  // told the other way round
    other.position_m.x() = -0.1;
    std::swap(other.body_a, other.body_b);
    other.impulse_ns = -one.impulse_ns;
    return std::vector<Contact>{one, other};
  };
  return run;
}

TEST(Momentum, TakesTheImpulsesOfFixedBodiesFromTheEngine) {
  const auto found = measure("momentum", resting(1.0));
  Worst worst;
  worst.see(value(found, "linear_momentum_error_relative"), "linear");
  worst.see(value(found, "angular_momentum_error_relative"), "angular");
  worst.see(value(found, "momentum_from_fixed_ns") / (2 * 9.81 * 0.1) - 1.0, "from fixed");
  EXPECT_TRUE(worst.within(k_rounding));
  EXPECT_NE(find(found, "linear_momentum_error_ns").note.find("as the engine tells"),
            std::string::npos);
  EXPECT_NEAR(value(measure("momentum", resting(0.9)), "linear_momentum_error_ns"),
              0.1 * 2 * 9.81 * 0.1, 1e-12);
}

TEST(Momentum, ClaimsNothingWhereFixedBodiesAreSilent) {
  SyntheticRun run = resting(1.0);
  run.contacts = {};
  const auto found = measure("momentum", run);
  EXPECT_FALSE(applies(find(found, "linear_momentum_error_ns")));
  EXPECT_TRUE(std::isnan(value(found, "angular_momentum_error_relative")));
  EXPECT_TRUE(applies(find(found, "momentum_from_fixed_ns")));
}

// A brick whose speed is out by a share for half the run, on either side, and right at the end.
TEST(Energy, ErrorsCountOnBothSides) {
  for (const double share : {0.5, 0.9, 1.0, 1.2}) {
    SyntheticRun run{.scene = scene_of({test_brick("a", {0, 0, 0}, {3, 0, 0})}, {0, 0, 0})};
    run.states = [start = initial_states(run.scene), share](std::size_t step) {
      auto states = start;
      if (step > 0 && step < 50) states[0].velocity_mps *= share;
      return states;
    };
    const auto found = measure("energy", run);
    // Mass 2 kg: 9 J.
    EXPECT_NEAR(value(found, "energy_error_max_j"), 9.0 * std::abs(share * share - 1.0), 1e-12);
    EXPECT_NEAR(value(found, "energy_error_max_relative"), std::abs(share * share - 1.0), 1e-12);
    EXPECT_EQ(value(found, "energy_net_drift_j"), 0.0);
  }
}

}  // namespace
}  // namespace brickbench::testing
