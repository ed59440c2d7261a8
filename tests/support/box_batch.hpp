// Separating axes of many pairs of boxes at once: what separate() says of one pair, for several
// pairs per instruction (Highway, chosen at run time for the processor).
//
// separate() is the scalar twin and the oracle of the tests: the axis and the gap agree but for
// rounding, so pairs that two axes separate equally well may be told apart either way.
#pragma once

#include <array>
#include <span>

#include "ourengine/collision/broad_phase.hpp"
#include "ourengine/collision/manifold.hpp"

namespace ourengine {

// A box as the batch reads it: vectors of four, the last entry unused.
struct alignas(32) PackedBox {
  std::array<double, 4> half_m;
  std::array<double, 4> centre_m;
  std::array<std::array<double, 4>, 3> axes;  // in the world, unit
};

PackedBox pack(const PosedBox& box);

struct PairSeparation {
  double gap_m;  // as in BoxSeparation
  int axis;
};

// separations: (pairs), filled. A pair that some axis separates by more than margin_m has the first
// such axis in the order of BoxSeparation::axis, faces together; every other pair its best one.
void separate_pairs(std::span<const PackedBox> boxes, std::span<const BodyPair> pairs,
                    double margin_m, std::span<PairSeparation> separations);

}  // namespace ourengine
