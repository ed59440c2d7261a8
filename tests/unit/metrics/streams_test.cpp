// Quantiles in fixed memory, the step clock and the fingerprint of a run.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "experiments/metrics/state_hash.hpp"
#include "experiments/metrics/step_clock.hpp"
#include "tests/support/tolerance.hpp"
#include "tests/unit/metrics/metric_runs.hpp"

namespace brickbench::testing {
namespace {

TEST(LogHistogram, KeepsItsRelativeError) {
  constexpr Tolerance tolerance{"relative error of a quantile", 0.005 * (1 + 1e-9), 0.005,
                                "DDSketch: half a bin of ratio 1.005 / 0.995"};
  std::mt19937_64 engine(3);
  std::lognormal_distribution<double> wide(-9.0, 3.0);
  Worst worst;
  for (int run = 0; run < 20; ++run) {
    LogHistogram histogram(1e-12, 1e4);
    std::vector<double> values;
    for (int n = 0; n < 2000; ++n) {
      values.push_back(wide(engine));
      histogram.add(values.back());
    }
    std::sort(values.begin(), values.end());
    for (const double q : {0.001, 0.1, 0.5, 0.9, 0.99, 1.0}) {
      const double exact = values[static_cast<std::size_t>(std::ceil(q * 2000.0)) - 1];
      worst.see(histogram.quantile(q) / exact - 1.0, "quantile " + std::to_string(q));
    }
  }
  EXPECT_TRUE(worst.within(tolerance));
}

TEST(LogHistogram, KnowsZeroAndNothing) {
  LogHistogram histogram(1e-12, 1.0);
  EXPECT_TRUE(std::isnan(histogram.quantile(0.5)));
  histogram.add(0.0);
  histogram.add(0.0);
  histogram.add(5.0);
  EXPECT_EQ(histogram.quantile(0.5), 0.0);
  EXPECT_NEAR(histogram.quantile(1.0), 1.0, 0.0051);
}

TEST(StepClock, SummarisesKnownSteps) {
  StepClock clock;
  for (int n = 1; n <= 1000; ++n) clock.add(1e-6 * n);
  EXPECT_EQ(clock.steps(), 1000U);
  EXPECT_NEAR(clock.total_s(), 0.5005, 1e-12);
  EXPECT_EQ(clock.max_s(), 1e-3);
  EXPECT_NEAR(clock.median_s(), 500e-6, 2.5e-6);
  EXPECT_NEAR(clock.p99_s(), 990e-6, 5e-6);
}

TEST(StepClock, CountsCpuTime) {
  for (const auto scope : {StepClock::Scope::thread, StepClock::Scope::process}) {
    StepClock clock(scope);
    clock.start();
    volatile double sink = 0.0;
    for (int n = 0; n < 2000000; ++n) sink = sink + 1.0;
    clock.stop();
    EXPECT_GT(clock.total_s(), 1e-4);
    EXPECT_EQ(clock.total_s(), clock.max_s());
  }
}

std::string fingerprint(const SyntheticRun& run) {
  StateHash hash;
  for (std::size_t step = 0; step <= run.steps; ++step) {
    const auto states = run.states(step);
    hash.observe(
        {.step = step, .time_s = 0.0, .states = states, .wrenches = {}, .diagnostics = {}});
  }
  return hash.hex();
}

TEST(StateHash, TellsRunsApart) {
  const std::string exact = fingerprint(free_flight());
  EXPECT_EQ(exact.size(), 16U);
  EXPECT_EQ(exact, fingerprint(free_flight()));
  EXPECT_NE(exact, fingerprint(free_flight(0.5)));
  SyntheticRun run = free_flight();
  run.states = [original = run.states](std::size_t step) {
    auto states = original(step);
    if (step == 50) std::swap(states[0], states[1]);
    return states;
  };
  EXPECT_NE(exact, fingerprint(run));
  run.states = [original = free_flight().states](std::size_t step) {
    auto states = original(step);
    if (step == 50) states[1].velocity_mps.x() = -states[1].velocity_mps.x();  // 0 to -0
    return states;
  };
  EXPECT_NE(exact, fingerprint(run));
}

}  // namespace
}  // namespace brickbench::testing
