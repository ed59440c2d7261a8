// When two numbers are one measurement.
#pragma once

#include <string>
#include <string_view>

namespace brickbench::statistics {

// Whether `share` is `count` over a scale: "energy_created_relative" of "energy_created_j",
// "linear_momentum_error_relative" of "linear_momentum_error_ns". They are one measurement in two
// units and count once, in the unit of `count`.
bool is_share_of(std::string_view share, std::string_view count);

// The names that count once among names of one subject: all but the shares of others among them.
template <typename Names>
bool counts_once(std::string_view name, const Names& all) {
  for (const auto& other : all) {
    if (is_share_of(name, other)) return false;
  }
  return true;
}

}  // namespace brickbench::statistics
