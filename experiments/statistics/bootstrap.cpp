#include "experiments/statistics/bootstrap.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <random>
#include <vector>

#include "experiments/statistics/student.hpp"

namespace brickbench::statistics {
namespace {

constexpr std::uint64_t k_bootstrap_seed = 1;
// Resampled means beyond each end of the interval: the end is known to a seventh of the spread
// between neighbouring percentiles (1 / sqrt(50)).
constexpr double k_means_beyond = 50.0;
constexpr std::size_t k_least_resamples = 2000;
constexpr std::size_t k_most_resamples = 40000;

// The mean of as many values as there are, drawn with replacement, less `origin`.
double resampled_mean(std::span<const double> values, double origin, std::mt19937_64& random) {
  double sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) sum += values[random() % values.size()] - origin;
  return sum / static_cast<double>(values.size());
}

// The percentile, per side, at which resampled means are cut: Student's quantile, wider by what
// resampling loses of the variance.
double tail_of(double level, double freedom, double variance, double resampled_variance) {
  const double t = student_quantile(0.5 * (1.0 + level), freedom);
  return normal_cdf(-t * std::sqrt(variance / resampled_variance));
}

std::size_t resamples_for(double tail) {
  const double wanted = tail > 0.0 ? std::ceil(k_means_beyond / tail) : HUGE_VAL;
  return static_cast<std::size_t>(std::clamp(wanted, static_cast<double>(k_least_resamples),
                                             static_cast<double>(k_most_resamples)));
}

// Both ends, by order statistics of the resampled means.
Interval ends_of(std::vector<double>& means, double tail) {
  const auto at = static_cast<std::size_t>(tail * static_cast<double>(means.size()));
  const std::size_t low = std::min(at, means.size() / 2);
  const std::size_t high = means.size() - 1 - low;
  const auto place = [&](std::size_t index) {
    return means.begin() + static_cast<std::ptrdiff_t>(index);
  };
  std::ranges::nth_element(means, place(low));
  const double first = *place(low);
  std::ranges::nth_element(means, place(high));
  return {first, *place(high)};
}

}  // namespace

Moments moments(std::span<const double> values) {
  assert(!values.empty());
  Moments result;
  result.count = static_cast<double>(values.size());
  // Distances from the first value: equal values have exactly their value as mean, and no variance.
  double sum = 0.0;
  for (const double value : values) sum += value - values[0];
  result.mean = values[0] + sum / result.count;
  if (values.size() == 1) return result;
  for (const double value : values) {
    result.variance += (value - result.mean) * (value - result.mean) / (result.count - 1.0);
  }
  return result;
}

Interval mean_interval(std::span<const double> values, double level) {
  assert(values.size() > 1);
  const Moments m = moments(values);
  if (m.variance == 0.0) return {m.mean, m.mean};
  const double tail = tail_of(level, m.count - 1.0, m.count, m.count - 1.0);
  std::mt19937_64 random(k_bootstrap_seed);
  std::vector<double> means(resamples_for(tail));
  for (double& mean : means) mean = m.mean + resampled_mean(values, m.mean, random);
  return ends_of(means, tail);
}

Interval difference_interval(std::span<const double> a, std::span<const double> b, double level) {
  assert(a.size() > 1 && b.size() > 1);
  const Moments ma = moments(a);
  const Moments mb = moments(b);
  const double difference = mb.mean - ma.mean;
  const double ea = ma.variance / ma.count;
  const double eb = mb.variance / mb.count;
  if (ea + eb == 0.0) return {difference, difference};
  const double freedom =
      (ea + eb) * (ea + eb) / (ea * ea / (ma.count - 1.0) + eb * eb / (mb.count - 1.0));
  const double resampled = ea * (ma.count - 1.0) / ma.count + eb * (mb.count - 1.0) / mb.count;
  const double tail = tail_of(level, freedom, ea + eb, resampled);
  std::mt19937_64 random(k_bootstrap_seed);
  std::vector<double> means(resamples_for(tail));
  for (double& mean : means) {
    mean = difference + resampled_mean(b, mb.mean, random) - resampled_mean(a, ma.mean, random);
  }
  return ends_of(means, tail);
}

}  // namespace brickbench::statistics
