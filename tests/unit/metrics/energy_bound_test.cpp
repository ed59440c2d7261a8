// The bound of the energy: no sound run touches it, and none that makes energy from nothing passes.
#include "experiments/metrics/energy_bound.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/unit/metrics/metric_runs.hpp"

namespace brickbench::testing {
namespace {

constexpr double k_g_mps2 = 9.81;

// The first step that has blown up; 0: none.
std::size_t blown_up_in(const SyntheticRun& run) {
  EnergyBound bound(run.scene, run.step_s);
  for (std::size_t step = 0; step <= run.steps; ++step) {
    const std::vector<State> states = run.states(step);
    std::vector<Wrench> wrenches(states.size());
    if (run.wrenches && step > 0) wrenches = run.wrenches(step);
    const Sample sample = {.step = step,
                           .time_s = run.step_s * static_cast<double>(step),
                           .states = states,
                           .wrenches = wrenches};
    if (bound.observe(sample)) return step;
  }
  return 0;
}

// One brick at rest of 2 kg and edges of 0.1 m; in step 5 its velocity becomes `velocity_mps`.
SyntheticRun kicked(const Eigen::Vector3d& velocity_mps, double gravity_mps2, double step_s) {
  SyntheticRun run{
      .scene = scene_of({test_brick("a")}, {0, 0, -gravity_mps2}), .step_s = step_s, .steps = 9};
  run.states = [start = initial_states(run.scene), velocity_mps](std::size_t step) {
    std::vector<State> states = start;
    if (step >= 5) states[0].velocity_mps = velocity_mps;
    return states;
  };
  return run;
}

TEST(EnergyBound, LetsAnythingPassThatFliesFreely) {
  EXPECT_EQ(blown_up_in(free_flight()), 0U);
  // Semi-implicit Euler of any step: each step of free fall loses or makes m g^2 h^2 / 2.
  for (const double step_s : {1e-4, 1e-2, 1.0 / 60.0, 0.3}) {
    SyntheticRun run = free_flight();
    run.step_s = step_s;
    run.states = [start = initial_states(run.scene), step_s](std::size_t step) {
      std::vector<State> states = start;
      for (State& state : states) {
        for (std::size_t i = 0; i < step; ++i) {
          state.position_m += step_s * state.velocity_mps;  // the old velocity: makes energy
          state.velocity_mps.z() -= k_g_mps2 * step_s;
        }
      }
      return states;
    };
    EXPECT_EQ(blown_up_in(run), 0U) << step_s;
  }
}

TEST(EnergyBound, IsThreeTimesTheEnergyInPlay) {
  // M g L of a brick of 2 kg at rest, edge 0.1 m: three of it are 3 x 2 x 9.81 x 0.1 J.
  const double speed_mps = std::sqrt(2.0 * k_blown_up_share * k_g_mps2 * 0.1);
  for (const Eigen::Vector3d& along :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0.6, 0.8), Eigen::Vector3d(0, 0, -1)}) {
    EXPECT_EQ(blown_up_in(kicked(0.999 * speed_mps * along, k_g_mps2, 0.01)), 0U);
    EXPECT_EQ(blown_up_in(kicked(1.001 * speed_mps * along, k_g_mps2, 0.01)), 5U);
  }
}

TEST(EnergyBound, CountsWhatABlowGaveAndNoMore) {
  for (const double share : {1.0, 1.9, 2.5}) {
    SyntheticRun run = kicked({share * 3.0, 0, 0}, 0.0, 0.01);
    // 6 N s on 2 kg: 3 m/s and 9 J. At `share` of the velocity the mean velocity grows with it:
    // work 9 share J, energy 9 share^2 J, so that the bound falls at share = 1 + 3 = 4.
    run.wrenches = [](std::size_t step) {
      std::vector<Wrench> wrenches(1);
      if (step == 5) wrenches[0].force_n = {600, 0, 0};
      return wrenches;
    };
    EXPECT_EQ(blown_up_in(run), 0U) << share;
    run.states = kicked({(share + 3.1) * 3.0, 0, 0}, 0.0, 0.01).states;
    EXPECT_EQ(blown_up_in(run), 5U) << share;
  }
}

TEST(EnergyBound, LetsAnOverlapOfTheStartBePushedApartWithinAStep) {
  // Two bricks of 0.1 m in each other by 1 cm part in a step of 1 ms: at most 10 m/s each.
  SyntheticRun run{.scene = scene_of({test_brick("a"), test_brick("b", {0, 0, 0.09})}, {0, 0, 0}),
                   .steps = 2};
  for (const double speed_mps : {10.0, 21.0}) {
    run.states = [start = initial_states(run.scene), speed_mps](std::size_t step) {
      std::vector<State> states = start;
      if (step > 0) states[1].velocity_mps.z() = speed_mps;
      return states;
    };
    // Both masses count, one brick has the energy: 3 x 2 = 6 = (speed / 10 m/s)^2 at 24.5 m/s.
    EXPECT_EQ(blown_up_in(run), 0U) << speed_mps;
  }
  run.scene.world.bodies[1].initial.position_m.z() = 0.1;
  run.states = [start = initial_states(run.scene)](std::size_t step) {
    std::vector<State> states = start;
    if (step > 0) states[1].velocity_mps.z() = 10.0;
    return states;
  };
  EXPECT_EQ(blown_up_in(run), 1U) << "bricks that only touch";
}

TEST(EnergyBound, NoticesWhateverIsFarBeyondAnything) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  for (const double far : {1e6, 1e33, 1e160, 1e300}) {
    EXPECT_EQ(blown_up_in(kicked({far, 0, 0}, k_g_mps2, 0.01)), 5U) << far;
    SyntheticRun up = kicked({0, 0, 0}, k_g_mps2, 0.01);
    up.states = [start = initial_states(up.scene), far](std::size_t step) {
      std::vector<State> states = start;
      if (step >= 5) states[0].position_m.z() = far;
      return states;
    };
    EXPECT_EQ(blown_up_in(up), 5U) << far << " m high";
    // Not a number where an infinite fall meets an infinite speed.
    SyntheticRun down = up;
    down.states = [start = initial_states(up.scene)](std::size_t step) {
      std::vector<State> states = start;
      if (step >= 5) {
        states[0].position_m.z() = -1e308;
        states[0].velocity_mps.x() = 1e200;
      }
      return states;
    };
    EXPECT_EQ(blown_up_in(down), 5U) << inf;
  }
}

// 1 m beside its start after 50 ms is 20 m/s on the way, where 4 S carry 2.8 m/s.
TEST(EnergyBound, NoticesABodyThatIsWhereNoVelocityCarriesIt) {
  for (const double far : {1.0, 1e6, 1e33, 1e160, 1e300, 1e308}) {
    for (const Eigen::Vector3d& along :
         {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, -0.6, -0.8), Eigen::Vector3d(0, 0, -1)}) {
      SyntheticRun run = kicked({0, 0, 0}, k_g_mps2, 0.01);
      run.states = [start = initial_states(run.scene),
                    way_m = Eigen::Vector3d(far * along)](std::size_t step) {
        std::vector<State> states = start;
        if (step >= 5) states[0].position_m += way_m;
        return states;
      };
      EXPECT_EQ(blown_up_in(run), 5U) << far << " along " << along.transpose();
    }
  }
}

TEST(EnergyBound, LetsABodyBeAsFarAsItsEnergyCarriesIt) {
  // At rest in the scene, then as fast as three times the energy in play allows.
  const double speed_mps = 0.999 * std::sqrt(2.0 * k_blown_up_share * k_g_mps2 * 0.1);
  SyntheticRun run = kicked({0, 0, 0}, k_g_mps2, 0.01);
  run.steps = 1000;
  run.states = [start = initial_states(run.scene), speed_mps](std::size_t step) {
    std::vector<State> states = start;
    states[0].velocity_mps.x() = step > 0 ? speed_mps : 0.0;
    states[0].position_m.x() += 0.01 * speed_mps * static_cast<double>(step);
    return states;
  };
  EXPECT_EQ(blown_up_in(run), 0U);
}

}  // namespace
}  // namespace brickbench::testing
