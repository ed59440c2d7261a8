// How deep each body of a world sinks into its deepest neighbour, from poses alone: what a replay
// colours its bricks by. penetration_depth.hpp says what a depth is.
#pragma once

#include <span>
#include <vector>

#include "experiments/metrics/placed.hpp"

namespace brickbench {

// (bodies) depths, m, >= 0: of each body the deepest overlap with any other. `shapes`, `fixed` and
// `states` have one entry per body; states are finite. Pairs of two fixed bodies do not count.
std::vector<double> body_depths_m(std::span<const Shape> shapes, const std::vector<bool>& fixed,
                                  std::span<const State> states);

}  // namespace brickbench
