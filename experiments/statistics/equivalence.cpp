#include "experiments/statistics/equivalence.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "experiments/statistics/student.hpp"

namespace brickbench::statistics {
namespace {

constexpr double k_power = 0.9;

// The fewest runs n >= 2 per sample with which a distance of means of `distance` has `upper` and
// `power`, probabilities of Student's distribution, between it and 0.
std::size_t runs_with(double variance, double distance, double upper, double power) {
  const auto are_enough = [&](std::size_t runs) {
    const double freedom = 2.0 * static_cast<double>(runs) - 2.0;
    const double t = student_quantile(upper, freedom) + student_quantile(power, freedom);
    return variance * t * t <= static_cast<double>(runs) * distance * distance;
  };
  std::size_t high = 2;
  while (high < k_most_runs && !are_enough(high)) high *= 2;
  if (high >= k_most_runs) return k_most_runs;
  std::size_t low = high / 2;  // too few, or 1
  while (high - low > 1) {
    const std::size_t middle = low + (high - low) / 2;
    (are_enough(middle) ? high : low) = middle;
  }
  return high;
}

std::size_t beyond(std::size_t needed, std::size_t present) {
  return needed > present ? needed - present : 1;
}

}  // namespace

Equivalence equivalence(std::span<const double> a, std::span<const double> b, double margin,
                        double alpha) {
  assert(a.size() > 1 && b.size() > 1);
  Equivalence result;
  result.difference = moments(b).mean - moments(a).mean;
  const Interval interval = difference_interval(a, b, 1.0 - 2.0 * alpha);
  result.low = interval.low;
  result.high = interval.high;
  result.equivalent = result.low > -margin && result.high < margin;
  return result;
}

std::size_t runs_for_equivalence(std::span<const double> a, std::span<const double> b,
                                 double margin, double alpha) {
  const double variance = moments(a).variance + moments(b).variance;
  // Both tests pass at equal means where each passes with probability 0.95.
  return runs_with(variance, margin, 1.0 - alpha, 0.5 * (1.0 + k_power));
}

std::size_t runs_for_difference(std::span<const double> a, std::span<const double> b,
                                double level) {
  const Moments ma = moments(a);
  const Moments mb = moments(b);
  if (ma.mean == mb.mean) return k_most_runs;
  std::size_t runs =
      runs_with(ma.variance + mb.variance, mb.mean - ma.mean, 1.0 - 0.5 * level, k_power);
  while (least_p(runs, runs) > level) ++runs;
  return runs;
}

Look look_at(std::span<const double> a, std::span<const double> b, double margin,
             const LookPlan& plan) {
  Look look;
  if (a.size() == b.size() && std::ranges::equal(a, b)) {
    look.verdict = Verdict::identical;
    return look;
  }
  look.test = energy_test(a, b, plan.permutation);
  look.mean = equivalence(a, b, margin, plan.level_same);
  if (look.test.p_value <= plan.level_different) {
    look.verdict = Verdict::different;
  } else if (look.mean.equivalent) {
    look.verdict = Verdict::same;
  } else {
    const std::size_t present = std::min(a.size(), b.size());
    look.more_for_difference = beyond(runs_for_difference(a, b, plan.level_different), present);
    look.more_for_same = margin > 0.0
                             ? beyond(runs_for_equivalence(a, b, margin, plan.level_same), present)
                             : k_most_runs;
  }
  return look;
}

}  // namespace brickbench::statistics
