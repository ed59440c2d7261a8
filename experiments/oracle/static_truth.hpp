// Static truth of block assemblies: whether any admissible contact forces balance the weights
// (Livesley, Limit analysis of structures formed from rigid blocks, Int. J. Numerical Methods in
// Engineering 12, 1978). Infeasible: the assembly must move, whatever the engine. Feasible: rest is
// admissible; with Coulomb friction other motions may be admissible too.
#pragma once

#include "adapters/seam/world.hpp"
#include "experiments/oracle/cone_program.hpp"
#include "experiments/oracle/impulse_oracle.hpp"

namespace brickbench::gate {

enum class StaticLabel {
  stands,     // shown: forces that balance the weights
  falls,      // proven: no admissible forces do (a Farkas direction, checked)
  undecided,  // too near the border for double precision
};

struct StaticVerdict {
  StaticLabel label = StaticLabel::undecided;
  // Smallest unbalanced force over the total weight: [lower, upper].
  double lower_share = 0.0;
  double upper_share = 0.0;
};

// The contacts of resting blocks whose faces are flush, to rounding.
inline constexpr ContactRoom k_flush = {.gap_share = 1e-5, .border_share = -1e-5};

// Contacts from the poses in `world`, which is at rest with flush faces.
StaticVerdict static_verdict(const World& world, const ContactRoom& room = k_flush);

// How far from its border an assembly must be for a strict label.
struct Margins {
  double tilt_rad = 0.01;       // of gravity, in each of four directions
  double friction_share = 0.1;  // less friction for "stands", more for "falls"
  // Of the smallest edge: faces between blocks are smaller for "stands", larger for "falls", on
  // every side.
  double border_share = 0.01;
};

// Whether the label holds with the whole margin against it. "stands" is asked without any force in
// head joints (normals more than 45 degrees from the vertical), which whether they are squeezed is
// a matter of history; "falls" with them.
bool robust(const World& world, StaticLabel label, const Margins& margins = {});

}  // namespace brickbench::gate
