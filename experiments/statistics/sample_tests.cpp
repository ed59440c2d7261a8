#include "experiments/statistics/sample_tests.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace brickbench::statistics {
namespace {

// Both samples in ascending order; from_a says whose each value is.
struct Pooled {
  std::vector<double> values;
  std::vector<char> from_a;
  std::size_t count_a = 0;
};

Pooled pool(std::span<const double> a, std::span<const double> b) {
  std::vector<std::pair<double, char>> all;
  for (const double value : a) all.emplace_back(value, 1);
  for (const double value : b) all.emplace_back(value, 0);
  std::ranges::sort(all);
  Pooled pooled;
  pooled.count_a = a.size();
  for (const auto& [value, from_a] : all) {
    pooled.values.push_back(value);
    pooled.from_a.push_back(from_a);
  }
  return pooled;
}

// Calls visit(F_a - F_b, width) for each gap between neighbouring values that differ.
template <typename Visit>
void walk(const Pooled& pooled, Visit visit) {
  const double step_a = 1.0 / static_cast<double>(pooled.count_a);
  const double step_b = 1.0 / static_cast<double>(pooled.values.size() - pooled.count_a);
  std::size_t seen_a = 0;
  for (std::size_t i = 0; i + 1 < pooled.values.size(); ++i) {
    if (pooled.from_a[i] != 0) ++seen_a;
    const double width = pooled.values[i + 1] - pooled.values[i];
    if (width > 0.0) {
      visit(static_cast<double>(seen_a) * step_a - static_cast<double>(i + 1 - seen_a) * step_b,
            width);
    }
  }
}

double energy_of(const Pooled& pooled) {
  double sum = 0.0;
  walk(pooled, [&](double difference, double width) { sum += difference * difference * width; });
  return 2.0 * sum;
}

// Whether the relabelling is at least as extreme as the samples; ties count, also where rounding
// parts them.
bool is_extreme(const Pooled& pooled, double statistic) {
  return energy_of(pooled) >= statistic * (1.0 - 1e-12);
}

// Every way to give the name a. Of equal sizes half are the other half with the names exchanged.
SampleTest enumerate(Pooled pooled, SampleTest test) {
  const std::size_t total = pooled.values.size();
  std::ranges::fill(pooled.from_a, char{0});
  std::fill_n(pooled.from_a.begin(), pooled.count_a, char{1});
  const bool is_halved = 2 * pooled.count_a == total;
  std::size_t extreme = 0;
  do {
    if (is_halved && pooled.from_a[0] == 0) break;
    ++test.permutations;
    if (is_extreme(pooled, test.statistic)) ++extreme;
  } while (std::ranges::prev_permutation(pooled.from_a).found);
  test.exact = true;
  test.p_value = static_cast<double>(extreme) / static_cast<double>(test.permutations);
  if (is_halved) test.permutations *= 2;
  return test;
}

SampleTest draw(Pooled pooled, SampleTest test, const PermutationPlan& plan) {
  std::mt19937_64 random(plan.seed);
  std::size_t extreme = 0;
  while (test.permutations < plan.permutations && extreme < plan.exceedances) {
    for (std::size_t i = pooled.from_a.size() - 1; i > 0; --i) {
      std::swap(pooled.from_a[i], pooled.from_a[random() % (i + 1)]);
    }
    ++test.permutations;
    if (is_extreme(pooled, test.statistic)) ++extreme;
  }
  const double drawn = static_cast<double>(test.permutations);
  const double p_value = extreme >= plan.exceedances
                             ? static_cast<double>(extreme) / drawn
                             : (static_cast<double>(extreme) + 1.0) / (drawn + 1.0);
  test.p_value = std::max(p_value, least_p(pooled.count_a, pooled.values.size() - pooled.count_a));
  return test;
}

}  // namespace

double relabellings(std::size_t count_a, std::size_t count_b) {
  double ways = 1.0;
  for (std::size_t i = 1; i <= count_a; ++i) {
    ways = ways * static_cast<double>(count_b + i) / static_cast<double>(i);
  }
  return ways;
}

double least_p(std::size_t count_a, std::size_t count_b) {
  return (count_a == count_b ? 2.0 : 1.0) / relabellings(count_a, count_b);
}

std::size_t relabellings_for(double level, std::size_t least) {
  return std::max(least, static_cast<std::size_t>(std::ceil(1.2 / level)));
}

double energy_distance(std::span<const double> a, std::span<const double> b) {
  return energy_of(pool(a, b));
}

SampleTest energy_test(std::span<const double> a, std::span<const double> b,
                       const PermutationPlan& plan) {
  Pooled pooled = pool(a, b);
  SampleTest test;
  test.statistic = energy_of(pooled);
  const bool few = relabellings(a.size(), b.size()) <= static_cast<double>(plan.enumerated);
  return few ? enumerate(std::move(pooled), test) : draw(std::move(pooled), test, plan);
}

}  // namespace brickbench::statistics
