#include "experiments/regression/sample_tests.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace brickbench::gate {
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

std::vector<std::size_t> ascending(std::span<const double> p_values) {
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return p_values[i]; });
  return order;
}

}  // namespace

std::size_t relabellings_for(std::size_t tests, double level, std::size_t least) {
  return std::max(least,
                  static_cast<std::size_t>(std::ceil(1.2 * static_cast<double>(tests) / level)));
}

double energy_distance(std::span<const double> a, std::span<const double> b) {
  return energy_of(pool(a, b));
}

SampleTest energy_test(std::span<const double> a, std::span<const double> b,
                       const PermutationPlan& plan) {
  Pooled pooled = pool(a, b);
  SampleTest test;
  test.statistic = energy_of(pooled);
  // Relabellings that tie with the samples count as extreme, also where rounding parts them.
  const double at_least = test.statistic * (1.0 - 1e-12);
  std::mt19937_64 random(plan.seed);
  std::size_t extreme = 0;
  while (test.permutations < plan.permutations && extreme < plan.exceedances) {
    for (std::size_t i = pooled.from_a.size() - 1; i > 0; --i) {
      std::swap(pooled.from_a[i], pooled.from_a[random() % (i + 1)]);
    }
    ++test.permutations;
    if (energy_of(pooled) >= at_least) ++extreme;
  }
  const double drawn = static_cast<double>(test.permutations);
  test.p_value = extreme >= plan.exceedances ? static_cast<double>(extreme) / drawn
                                             : (static_cast<double>(extreme) + 1.0) / (drawn + 1.0);
  return test;
}

std::vector<bool> holm(std::span<const double> p_values, double alpha) {
  std::vector<bool> rejected(p_values.size(), false);
  std::size_t left = p_values.size();
  for (const std::size_t i : ascending(p_values)) {
    if (p_values[i] > alpha / static_cast<double>(left--)) break;
    rejected[i] = true;
  }
  return rejected;
}

}  // namespace brickbench::gate
