#include "experiments/metrics/log_histogram.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brickbench {

LogHistogram::LogHistogram(double smallest, double largest, double relative_error)
    : smallest_(smallest),
      largest_(largest),
      ratio_((1.0 + relative_error) / (1.0 - relative_error)),
      per_log_ratio_(1.0 / std::log(ratio_)),
      bins_(static_cast<std::size_t>(std::log(largest / smallest) * per_log_ratio_) + 2) {}

void LogHistogram::add(double value) {
  ++count_;
  if (value < smallest_) {
    ++zeros_;
    return;
  }
  const double bin = std::ceil(std::log(std::min(value, largest_) / smallest_) * per_log_ratio_);
  ++bins_[std::min(static_cast<std::size_t>(bin), bins_.size() - 1)];
}

double LogHistogram::quantile(double q) const {
  if (count_ == 0) return std::numeric_limits<double>::quiet_NaN();
  const auto rank = static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(count_)));
  std::uint64_t seen = zeros_;
  if (seen >= rank) return 0.0;
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
    seen += bins_[bin];
    if (seen < rank) continue;
    return smallest_ * 2.0 * std::pow(ratio_, static_cast<double>(bin)) / (ratio_ + 1.0);
  }
  return largest_;
}

}  // namespace brickbench
