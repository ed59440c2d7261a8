// Bodies do not enter each other deeper than the way of one step: docs/hunt.md, section overlap.
#include <algorithm>

#include "experiments/hunt/bounds.hpp"
#include "experiments/hunt/extent.hpp"
#include "experiments/hunt/oracles.hpp"
#include "experiments/metrics/deepest_overlap.hpp"

namespace brickbench::hunt {
namespace {

// Of the smallest edge of the thinner body: slops, margins and solvers that were stopped early.
constexpr double k_overlap_share = 0.05;

}  // namespace

std::optional<Breach> overlap_breach(const Motion& motion) {
  const World& world = motion.scene.world;
  DeepestOverlap overlap(world);
  Fastest fastest(world);
  const double soft_m = soft_depth_m(motion) * static_cast<double>(moving_count(world));
  const double stop_s = motion.step_s + soft_time_s(motion);
  const double fall_m = world.gravity_mps2.norm() * motion.step_s * motion.step_s;
  // The scenes hold none at the start beyond rounding; what they do hold is not the engine's.
  const double first_m = overlap.find(motion.states.front()).depth_m;
  Worst worst;
  for (std::size_t n = 0; n <= motion.steps(); ++n) {
    fastest.see(motion.states[n]);
    if (n == 0) continue;
    const Overlap deepest = overlap.find(motion.states[n]);
    if (deepest.depth_m <= 0.0) continue;
    const Body& a = world.bodies[deepest.body_a];
    const Body& b = world.bodies[deepest.body_b];
    const double edge_m = std::min(thinnest_m(a.shape), thinnest_m(b.shape));
    const double way_m = stop_s * (fastest.of(deepest.body_a) + fastest.of(deepest.body_b));
    const double allowed_m = first_m + way_m + 2.0 * fall_m + soft_m + k_overlap_share * edge_m;
    worst.see({"overlap", deepest.depth_m, allowed_m, "m", n, 0.0, a.name + ", " + b.name});
  }
  return worst.breach(motion);
}

}  // namespace brickbench::hunt
