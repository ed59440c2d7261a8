// How far a body has moved, turns included.
#pragma once

#include "adapters/seam/world.hpp"

namespace brickbench {

// The largest distance (m) of any point of the body from where it was at `start`. Of a ball, whose
// turn nobody sees, and of a plane that of the centre.
double moved_m(const Shape& shape, const State& start, const State& now);

}  // namespace brickbench
