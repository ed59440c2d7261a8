// A named tolerance: value, derivation, and the residual last observed. TOL_SCALE=0 in the
// environment shows every residual; TOL_SCALE=s multiplies every tolerance by s.
#pragma once

#include <cmath>
#include <cstdlib>
#include <string>

namespace brickbench::conformance {

struct Tolerance {
  const char* name;
  double value;
  double observed;         // largest residual seen when the value was set; value <= 20 * observed
  const char* derivation;  // one line
};

inline double tolerance_scale() {
  const char* text = std::getenv("TOL_SCALE");
  return text == nullptr ? 1.0 : std::strtod(text, nullptr);
}

// Keeps the worst offender of a loop; judged once, at the end.
class Worst {
 public:
  // NaN counts as infinitely bad.
  void see(double residual, const std::string& where) {
    const double size = std::isnan(residual) ? HUGE_VAL : std::abs(residual);
    if (empty_ || size > residual_) {
      residual_ = size;
      where_ = where;
      empty_ = false;
    }
  }

  bool empty() const { return empty_; }  // nothing was compared
  double residual() const { return residual_; }
  const std::string& where() const { return where_; }

 private:
  double residual_ = 0.0;
  std::string where_;
  bool empty_ = true;
};

}  // namespace brickbench::conformance
