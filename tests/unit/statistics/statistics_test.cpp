// The tests of the gate are themselves tested: on distributions whose truth is known they must keep
// the promised rate of false alarms and find what they are said to find.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "experiments/statistics/equivalence.hpp"
#include "experiments/statistics/measurement.hpp"
#include "experiments/statistics/student.hpp"
#include "tests/support/tolerance.hpp"

namespace brickbench::statistics {
namespace {

using testing::Tolerance;
using testing::Worst;

std::vector<double> normal_sample(std::mt19937_64& random, std::size_t count, double mean,
                                  double deviation = 1.0) {
  std::normal_distribution<double> normal(mean, deviation);
  std::vector<double> values(count);
  for (double& value : values) value = normal(random);
  return values;
}

TEST(Statistics, EnergyDistanceIsThatOfItsDefinition) {
  // 2 E|X-Y| - E|X-X'| - E|Y-Y'|, by hand for {0, 1} against {3}: 2 * 2.5 - 0.5 - 0.
  const Tolerance k_hand{"hand value", 4e-15, 4.4e-16, "a handful of roundings of numbers near 4"};
  const std::vector<double> a = {0.0, 1.0}, b = {3.0};
  Worst worst;
  worst.see(energy_distance(a, b) - 4.5, "energy");
  EXPECT_TRUE(worst.within(k_hand));
}

TEST(Statistics, StudentQuantilesAreThoseOfTheTables) {
  // NIST/SEMATECH e-Handbook of Statistical Methods, table 1.3.6.7.2 (three decimals).
  const Tolerance k_table{"t table", 6e-4, 2.6e-4, "tables of three decimals"};
  Worst worst;
  worst.see(student_quantile(0.95, 1) - 6.314, "1");
  worst.see(student_quantile(0.975, 10) - 2.228, "10");
  worst.see(student_quantile(0.99, 30) - 2.457, "30");
  worst.see(student_quantile(0.05, 5) + 2.015, "5");
  EXPECT_TRUE(worst.within(k_table));
}

TEST(Statistics, PermutationTestsKeepTheirLevel) {
  // 600 pairs of equal samples at level 5 %: the count of rejections is binomial, mean 30, standard
  // deviation 5.3; four of those.
  std::mt19937_64 random(7);
  int energy = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const auto a = normal_sample(random, 20, 0.0), b = normal_sample(random, 20, 0.0);
    const PermutationPlan plan{
        .permutations = 400, .exceedances = 40, .seed = static_cast<std::uint64_t>(trial)};
    energy += energy_test(a, b, plan).p_value <= 0.05;
  }
  EXPECT_LE(std::abs(energy - 30), 22) << energy;
}

TEST(Statistics, PowerIsThatOfTheSampleSize) {
  // Means 1.5 deviations apart, 20 + 20 values, level 1 %: a t test finds 98 %.
  std::mt19937_64 random(8);
  int found = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const auto a = normal_sample(random, 20, 0.0), b = normal_sample(random, 20, 1.5);
    found +=
        energy_test(
            a, b,
            {.permutations = 2000, .exceedances = 25, .seed = static_cast<std::uint64_t>(trial)})
            .p_value <= 0.01;
  }
  EXPECT_GE(found, 180) << found << " of 200";
}

TEST(Statistics, AChangeOfSpreadIsADifferenceToo) {
  std::mt19937_64 random(9);
  const auto a = normal_sample(random, 60, 0.0, 1.0), b = normal_sample(random, 60, 0.0, 4.0);
  EXPECT_LE(energy_test(a, b, {}).p_value, 0.001);
}

TEST(Statistics, SmallSamplesAreEnumerated) {
  // 8 against 8: 12 870 relabellings; that of ranges which do not overlap is the most extreme, with
  // its mirror image. A drawn p would be 1 / 20 001 here, below what is possible.
  std::vector<double> low, high;
  for (int i = 0; i < 8; ++i) {
    low.push_back(0.24 + 0.001 * i);
    high.push_back(20.0 + 0.3 * i);
  }
  const SampleTest test = energy_test(low, high, {});
  EXPECT_TRUE(test.exact);
  EXPECT_EQ(test.permutations, 12870u);
  EXPECT_EQ(test.p_value, 2.0 / 12870.0);
  EXPECT_EQ(test.p_value, least_p(8, 8));
  // Sizes that differ: {0, 1, 5} against {2, 3} among all ten ways to choose two of the five.
  const std::vector<double> three = {0.0, 1.0, 5.0}, two = {2.0, 3.0};
  const std::array<double, 5> all = {0.0, 1.0, 2.0, 3.0, 5.0};
  const double seen = energy_distance(three, two);
  int extreme = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      std::vector<double> pair = {all[i], all[j]}, rest;
      for (std::size_t k = 0; k < all.size(); ++k) {
        if (k != i && k != j) rest.push_back(all[k]);
      }
      extreme += energy_distance(rest, pair) >= seen - 1e-12;
    }
  }
  const SampleTest small = energy_test(three, two, {});
  EXPECT_EQ(small.permutations, 10u);
  EXPECT_DOUBLE_EQ(small.p_value, extreme / 10.0);
}

TEST(Statistics, EnumeratedAndDrawnValuesOfPAgree) {
  // 9 against 9 have 48 620 relabellings. 40 pairs: the drawn p has a deviation of at most
  // sqrt(0.25 / 20000) = 0.0035 where it is not stopped early; five of those.
  std::mt19937_64 random(13);
  for (int trial = 0; trial < 40; ++trial) {
    const auto a = normal_sample(random, 9, 0.0), b = normal_sample(random, 9, 0.5);
    const PermutationPlan drawn{.permutations = 20000, .exceedances = 20000, .enumerated = 0};
    EXPECT_NEAR(energy_test(a, b, {}).p_value, energy_test(a, b, drawn).p_value, 0.018);
  }
}

TEST(Statistics, NoDrawnPIsBelowWhatIsPossible) {
  const std::vector<double> low = {0.0, 0.1, 0.2}, high = {7.0, 7.1, 7.2};
  const PermutationPlan drawn{.permutations = 100, .exceedances = 1000, .enumerated = 0};
  EXPECT_GE(energy_test(low, high, drawn).p_value, least_p(3, 3));
}

TEST(Statistics, RangesThatDoNotOverlapAreDifferent) {
  std::mt19937_64 random(14);
  for (std::size_t count = 8; count < 30; ++count) {
    auto a = normal_sample(random, count, 0.0), b = normal_sample(random, count, 0.0);
    const double shift = *std::ranges::max_element(a) - *std::ranges::min_element(b) + 1e-6;
    for (double& value : b) value += shift;
    EXPECT_EQ(look_at(a, b, 1.0, {}).verdict, Verdict::different) << count;
  }
}

TEST(Statistics, IntervalsCoverTheMean) {
  // 500 samples of 8, 12 and 24, normal and of an exponential distribution, whose mean is 1. The
  // normal ones are covered in 95 %, deviation 1 %, three of those; the skewed ones in 90 %, of
  // which again three deviations of 1.3 % are left.
  std::mt19937_64 random(15);
  std::exponential_distribution<double> exponential(1.0);
  for (const std::size_t count : {8UL, 12UL, 24UL}) {
    int normal = 0, skewed = 0;
    for (int trial = 0; trial < 500; ++trial) {
      const Interval n = mean_interval(normal_sample(random, count, 1.0));
      normal += n.low <= 1.0 && 1.0 <= n.high;
      std::vector<double> values(count);
      for (double& value : values) value = exponential(random);
      const Interval e = mean_interval(values);
      skewed += e.low <= 1.0 && 1.0 <= e.high;
    }
    EXPECT_GE(normal, 460) << count;
    EXPECT_LE(normal, 490) << count;
    EXPECT_GE(skewed, 430) << count;
  }
}

TEST(Statistics, EqualValuesHaveAnIntervalWithoutWidth) {
  const std::vector<double> same(9, 0.1), other(8, 0.3);
  EXPECT_EQ(mean_interval(same).low, 0.1);
  EXPECT_EQ(mean_interval(same).high, 0.1);
  const Interval apart = difference_interval(same, other, 0.9);
  EXPECT_EQ(apart.low, apart.high);
  EXPECT_EQ(apart.low, 0.3 - 0.1);
}

TEST(Statistics, AShareAndItsCountAreOneMeasurement) {
  EXPECT_TRUE(is_share_of("energy_created_relative", "energy_created_j"));
  EXPECT_TRUE(is_share_of("linear_momentum_error_relative", "linear_momentum_error_ns"));
  EXPECT_FALSE(is_share_of("energy_error_relative", "energy_error_max_j"));
  EXPECT_FALSE(is_share_of("energy_created_relative", "energy_created_relative"));
  EXPECT_FALSE(is_share_of("energy_created_j", "energy_created_relative"));
  const std::vector<std::string> names = {"energy_created_j", "energy_created_relative",
                                          "angular_momentum_error_relative"};
  EXPECT_TRUE(counts_once(names[0], names));
  EXPECT_FALSE(counts_once(names[1], names));
  EXPECT_TRUE(counts_once(names[2], names));  // alone it counts
}

TEST(Statistics, EquivalenceIsShownOnlyWhereItIsThere) {
  // At the very margin the chance of "equivalent" is alpha: 5 % of 400 is 20, deviation 4.4.
  std::mt19937_64 random(10);
  int at_margin = 0, inside = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const auto a = normal_sample(random, 30, 0.0);
    at_margin += equivalence(a, normal_sample(random, 30, 1.0), 1.0, 0.05).equivalent;
    inside += equivalence(a, normal_sample(random, 30, 0.0), 1.0, 0.05).equivalent;
  }
  EXPECT_LE(at_margin, 38) << at_margin;
  EXPECT_GE(inside, 360) << inside;
}

TEST(Statistics, TheRunsAskedForShowEquivalence) {
  // Promised: 90 % of 200; the spread of 60 values is known to 10 %, which may cost 5 %.
  std::mt19937_64 random(11);
  const auto a = normal_sample(random, 60, 0.0), b = normal_sample(random, 60, 0.0);
  const Look look = look_at(a, b, 0.3, {});
  ASSERT_EQ(look.verdict, Verdict::not_enough_runs);
  const std::size_t runs = 60 + look.more_for_same;
  int shown = 0;
  for (int trial = 0; trial < 200; ++trial) {
    shown +=
        equivalence(normal_sample(random, runs, 0.0), normal_sample(random, runs, 0.0), 0.3, 0.05)
            .equivalent;
  }
  EXPECT_GE(shown, 165) << "with " << runs << " runs";
}

TEST(Statistics, TheRunsAskedForShowADifferenceOfTheSizeSeen) {
  // Of samples whose moments are exactly those of the truth: means 0.7 deviations apart.
  std::mt19937_64 random(17);
  auto standard = [&](double mean) {
    auto values = normal_sample(random, 16, 0.0);
    const Moments m = moments(values);
    for (double& value : values) value = mean + (value - m.mean) / std::sqrt(m.variance);
    return values;
  };
  const std::size_t runs = runs_for_difference(standard(0.0), standard(0.7), 0.01);
  int shown = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const PermutationPlan plan{
        .permutations = 4000, .exceedances = 60, .seed = static_cast<std::uint64_t>(trial)};
    shown += energy_test(normal_sample(random, runs, 0.0), normal_sample(random, runs, 0.7), plan)
                 .p_value <= 0.01;
  }
  // Promised: 90 % of 200, for Student's test; the energy test has 0.95 of its efficiency, 2 %.
  EXPECT_GE(shown, 165) << "with " << runs << " runs";
  EXPECT_LE(shown, 197) << "with " << runs << " runs";
}

TEST(Statistics, EqualMeansAndLevelsBeyondReachAskForManyRuns) {
  const std::vector<double> a = {1.0, 2.0, 3.0}, b = {0.0, 2.0, 4.0}, far = {101.0, 102.0, 103.0};
  EXPECT_EQ(runs_for_difference(a, b, 0.01), k_most_runs);
  // However far apart: 2 / C(2n, n) reaches 1e-4 with 9 against 9 (4.1e-5), not with 8 (1.6e-4).
  EXPECT_EQ(runs_for_difference(a, far, 1e-4), 9u);
}

TEST(Statistics, LooksThatShareALevelKeepIt) {
  // 400 sequences of 3 looks at one distribution, total level 5 %: at most 20 + 4 * 4.4.
  std::mt19937_64 random(12);
  PermutationPlan plan{.permutations = 1000, .exceedances = 40, .enumerated = 0};
  int alarms = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const auto a = normal_sample(random, 32, 0.0), b = normal_sample(random, 32, 0.0);
    plan.seed = static_cast<std::uint64_t>(trial);
    for (const std::size_t size : {8UL, 16UL, 32UL}) {
      const std::span<const double> head(a.data(), size), tail(b.data(), size);
      if (energy_test(head, tail, plan).p_value <= 0.05 / 3.0) {
        ++alarms;
        break;
      }
    }
  }
  EXPECT_LE(alarms, 38);
}

TEST(Statistics, EqualSamplesAreIdentical) {
  const std::vector<double> a = {1.0, 2.0, 3.0};
  EXPECT_EQ(look_at(a, a, 0.1, {}).verdict, Verdict::identical);
}

}  // namespace
}  // namespace brickbench::statistics
