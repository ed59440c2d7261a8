// Units as messages show them.
#pragma once

#include <string>
#include <string_view>

namespace brickbench {

// What follows a number: " m/s"; nothing where the number is pure, which rows call the unit "1".
inline std::string unit_suffix(std::string_view unit) {
  return unit.empty() || unit == "1" ? std::string() : ' ' + std::string(unit);
}

}  // namespace brickbench
