// The one estimator of what a sample says: the mean, and intervals by the bootstrap.
//
// Intervals are expanded percentile intervals (Hesterberg, What teachers should know about the
// bootstrap, American Statistician 69, 2015, section 5.3): percentiles of resampled means, taken so
// far out that normal samples get the width of Student's interval. They follow the skewness of a
// sample, which Student's do not. Resampling is seeded: equal samples give equal intervals.
#pragma once

#include <cstddef>
#include <span>

namespace brickbench::statistics {

// Fewer values than this have no interval; their range is told instead.
inline constexpr std::size_t k_least_for_interval = 8;
// What "the interval" means where no level is named.
inline constexpr double k_interval_level = 0.95;

struct Moments {
  double mean = 0.0;
  double variance = 0.0;  // unbiased; 0 for one value
  double count = 0.0;
};

// Of at least one value.
Moments moments(std::span<const double> values);

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

// Of the mean of the distribution that the values, two or more and finite, were drawn from; covers
// it with probability `level`, 0 < level < 1. Values that are all equal have an interval of width
// 0.
Interval mean_interval(std::span<const double> values, double level = k_interval_level);

// Of mean(b) - mean(a); two or more values each. Equals Welch's interval for normal samples.
Interval difference_interval(std::span<const double> a, std::span<const double> b, double level);

}  // namespace brickbench::statistics
