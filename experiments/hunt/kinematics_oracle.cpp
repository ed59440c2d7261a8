// Bodies move as their velocities say: docs/hunt.md, section kinematics.
#include <algorithm>

#include "experiments/hunt/bounds.hpp"
#include "experiments/hunt/extent.hpp"
#include "experiments/hunt/oracles.hpp"
#include "experiments/metrics/deepest_overlap.hpp"

namespace brickbench::hunt {
namespace {

// Of the way at the step's velocities: bounces within the step bend it.
constexpr double k_bend_share = 0.2;
// Of the thinnest edge, over the whole run.
constexpr double k_stray_share = 0.1;

// Distance, m, of the displacement from the ways h ((1 - s) v + s v+), 0 <= s <= 1.
double stray_m(const State& before, const State& after, double step_s) {
  const Eigen::Vector3d moved = after.position_m - before.position_m;
  const Eigen::Vector3d first = step_s * before.velocity_mps;
  const Eigen::Vector3d change = step_s * after.velocity_mps - first;
  const double size = change.squaredNorm();
  const double share = size > 0.0 ? std::clamp((moved - first).dot(change) / size, 0.0, 1.0) : 0.0;
  return (moved - first - share * change).norm();
}

}  // namespace

std::optional<Breach> kinematics_breach(const Motion& motion) {
  const World& world = motion.scene.world;
  const double h = motion.step_s;
  DeepestOverlap overlap(world);
  std::vector<double> strayed_m(world.bodies.size(), 0.0);
  const double fall_m = world.gravity_mps2.norm() * h * h;
  Worst worst;
  for (std::size_t n = 0; n < motion.steps(); ++n) {
    // An overlap may be pushed out by moving the bodies alone.
    const double depth_m = overlap.find(motion.states[n]).depth_m;
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      if (world.bodies[i].fixed) continue;
      const State& before = motion.states[n][i];
      const State& after = motion.states[n + 1][i];
      const double way_m = h * (before.velocity_mps.norm() + after.velocity_mps.norm());
      const double allowed_m = k_bend_share * way_m + depth_m + fall_m;
      strayed_m[i] += std::max(0.0, stray_m(before, after, h) - allowed_m);
      const double edge_m = thinnest_m(world.bodies[i].shape);
      const double rounding_m = k_rounding * after.position_m.norm() * static_cast<double>(n + 1);
      worst.see({"kinematics", strayed_m[i], k_stray_share * edge_m + rounding_m, "m", n + 1, 0.0,
                 world.bodies[i].name});
    }
  }
  return worst.breach(motion);
}

}  // namespace brickbench::hunt
