// Sum of many small numbers whose rounding error does not grow with their count: Neumaier,
// Rundungsfehleranalyse einiger Verfahren zur Summation endlicher Summen (ZAMM 54, 1974).
#pragma once

#include <cmath>

namespace brickbench {

class CompensatedSum {
 public:
  CompensatedSum& operator+=(double term) {
    const double sum = sum_ + term;
    lost_ += std::abs(sum_) >= std::abs(term) ? (sum_ - sum) + term : (term - sum) + sum_;
    sum_ = sum;
    return *this;
  }
  double value() const { return sum_ + lost_; }

 private:
  double sum_ = 0.0;
  double lost_ = 0.0;
};

}  // namespace brickbench
