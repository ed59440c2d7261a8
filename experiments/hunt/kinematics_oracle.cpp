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

// Whether the engine states that bodies meet within a step, and not at its ends alone: a body may
// be hit by one neighbour and thrown back by the next in it, at a velocity that neither end shows.
bool hits_within_steps(const Motion& motion) {
  if (!motion.scheme) return false;
  if (motion.scheme->soft()) return motion.scheme->soft()->substeps > 1;
  if (motion.scheme->impulse()) return motion.scheme->impulse()->bounces_before_touch;
  return motion.scheme->sequential() != nullptr && motion.scheme->sequential()->depth_share > 0.0;
}

// Twice the fastest of the others that can reach the body in the step, m/s: what is hit by
// something heavy at u leaves with up to 2 u.
double thrown_mps(const World& world, const gate::StepRecord& record, std::size_t i) {
  double fastest_mps = 0.0;
  const double own_mps = std::max(fastest_point_mps(world.bodies[i], record.before[i]),
                                  fastest_point_mps(world.bodies[i], record.after[i]));
  for (std::size_t j = 0; j < world.bodies.size(); ++j) {
    if (j == i || world.bodies[j].fixed) continue;
    const double speed_mps = std::max(fastest_point_mps(world.bodies[j], record.before[j]),
                                      fastest_point_mps(world.bodies[j], record.after[j]));
    const double apart_m = (record.before[j].position_m - record.before[i].position_m).norm();
    const double near_m = reach_m(world.bodies[i].shape) + reach_m(world.bodies[j].shape) +
                          record.step_s * (own_mps + speed_mps);
    if (apart_m <= near_m) fastest_mps = std::max(fastest_mps, speed_mps);
  }
  return 2.0 * fastest_mps;
}

}  // namespace

std::optional<Breach> kinematics_breach(const Motion& motion) {
  const World& world = motion.scene.world;
  const double h = motion.step_s;
  DeepestOverlap overlap(world);
  std::vector<double> strayed_m(world.bodies.size(), 0.0);
  const double fall_m = world.gravity_mps2.norm() * h * h;
  const bool within_steps = hits_within_steps(motion);
  Worst worst;
  for (std::size_t n = 0; n < motion.steps(); ++n) {
    const gate::StepRecord record = motion.record(n);
    // An overlap may be pushed out by moving the bodies alone.
    const double depth_m = overlap.find(motion.states[n]).depth_m;
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      if (world.bodies[i].fixed) continue;
      const State& before = record.before[i];
      const State& after = record.after[i];
      const double way_m = h * (before.velocity_mps.norm() + after.velocity_mps.norm());
      const double thrown_m = within_steps ? h * thrown_mps(world, record, i) : 0.0;
      const double allowed_m = k_bend_share * way_m + depth_m + fall_m + thrown_m;
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
