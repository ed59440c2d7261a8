// Quantiles of a stream in fixed memory, with a relative error that is known beforehand.
//
// Bins of equal ratio (Masson, Rim, Lee, DDSketch, PVLDB 12, 2019, section 2): the value of bin i,
// 2 g^i / (g + 1) with g = (1 + a) / (1 - a), is within the fraction `a` of everything in it.
#pragma once

#include <cstdint>
#include <vector>

namespace brickbench {

class LogHistogram {
 public:
  // Numbers below `smallest` count as 0, numbers above `largest` as `largest`; both > 0.
  LogHistogram(double smallest, double largest, double relative_error = 0.005);

  // value >= 0 and not NaN.
  void add(double value);
  std::uint64_t count() const { return count_; }
  // The smallest number that at least ceil(q * count) of the numbers do not exceed, 0 < q <= 1,
  // within the relative error (and 0 where that number is below `smallest`); NaN if nothing was
  // added.
  double quantile(double q) const;

 private:
  double smallest_;
  double largest_;
  double ratio_;
  double per_log_ratio_;
  std::uint64_t count_ = 0;
  std::uint64_t zeros_ = 0;
  std::vector<std::uint64_t> bins_;
};

}  // namespace brickbench
