// Numbers that a person can type.
#pragma once

#include <fmt/format.h>

#include <cstdlib>

namespace brickbench::hunt {

// x to so many significant decimal digits, the double nearest to that decimal.
inline double with_digits(double x, int digits) {
  return std::strtod(fmt::format("{:.{}e}", x, digits - 1).c_str(), nullptr);
}

}  // namespace brickbench::hunt
