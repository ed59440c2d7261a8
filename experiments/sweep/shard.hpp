// Shard: the part of a sweep that one machine or task works on.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "adapters/seam/failure.hpp"

namespace brickbench {

// Every count-th cell of the plan's order, from the index-th on: neighbours in the plan cost about
// the same, so the shards do too.
struct Shard {
  std::size_t index = 0;
  std::size_t count = 1;

  bool holds(std::size_t cell) const { return cell % count == index; }
  std::string text() const { return std::to_string(index) + '/' + std::to_string(count); }
};

// "i/n" with 0 <= i < n <= 1000000; Fault::invalid otherwise.
Expected<Shard> parse_shard(std::string_view text);

}  // namespace brickbench
