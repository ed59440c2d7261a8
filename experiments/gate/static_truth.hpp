// Static truth of block assemblies: whether any admissible contact forces balance the weights
// (Livesley, Limit analysis of structures formed from rigid blocks, Int. J. Numerical Methods in
// Engineering 12, 1978). Infeasible: the assembly must move, whatever the engine. Feasible: rest is
// admissible; with Coulomb friction other motions may be admissible too, and where `frictionless`
// forces exist already, friction is not needed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "adapters/seam/world.hpp"
#include "experiments/gate/cone_program.hpp"

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

// Contacts from the poses in `world`, which is at rest with flush faces.
StaticVerdict static_verdict(const World& world);

// The same after every head has been tilted: gravity turned by `tilt_rad` in each of four
// directions, all of which must agree for the assembly to be away from the border.
bool robust(const World& world, StaticLabel label, double tilt_rad);

struct LabelledAssembly {
  std::string family;  // "tower", "leaning_courses", "missing_bricks", "overhang"
  std::uint64_t seed = 0;
  World world;
  StaticVerdict verdict;
};

// `count` random assemblies, families in turn, each labelled on both sides of its border by at
// least a tilt of `tilt_rad`; those nearer to it are drawn again.
std::vector<LabelledAssembly> labelled_assemblies(std::size_t count, std::uint64_t seed,
                                                  double tilt_rad);

}  // namespace brickbench::gate
