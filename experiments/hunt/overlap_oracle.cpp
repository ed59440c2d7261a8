// Bodies do not enter each other deeper than the way of one step: docs/hunt.md, section overlap.
#include <algorithm>
#include <limits>

#include "experiments/hunt/bounds.hpp"
#include "experiments/hunt/extent.hpp"
#include "experiments/hunt/oracles.hpp"
#include "experiments/metrics/deepest_overlap.hpp"

namespace brickbench::hunt {
namespace {

// Of the smallest edge of the thinner body: slops, margins and solvers that were stopped early.
constexpr double k_overlap_share = 0.05;

// An overlap is pushed out at half the pace that the engine states, or by this share per step.
constexpr double k_unstated_recovery = 0.02;
constexpr double k_pace_share = 0.5;

// The speeds, m/s, whose way in one step may be the depth of an overlap now: the fastest of each
// body, which fades as overlaps are pushed out.
class Lingering {
 public:
  explicit Lingering(const Motion& motion)
      : world_(motion.scene.world), speeds_mps_(world_.bodies.size(), 0.0) {
    if (!motion.scheme || !motion.scheme->impulse()) return;
    recovery_ = k_pace_share * motion.scheme->impulse()->error_reduction;
    limit_mps_ = k_pace_share * motion.scheme->impulse()->max_correction_mps;
  }
  void see(std::span<const State> states) {
    for (std::size_t i = 0; i < states.size(); ++i) {
      const double left_mps = speeds_mps_[i] - std::min(recovery_ * speeds_mps_[i], limit_mps_);
      speeds_mps_[i] = std::max(left_mps, fastest_point_mps(world_.bodies[i], states[i]));
    }
  }
  double of(std::size_t body) const { return speeds_mps_[body]; }

 private:
  const World& world_;
  std::vector<double> speeds_mps_;  // (bodies)
  double recovery_ = k_unstated_recovery;
  double limit_mps_ = std::numeric_limits<double>::infinity();
};

}  // namespace

std::optional<Breach> overlap_breach(const Motion& motion) {
  const World& world = motion.scene.world;
  DeepestOverlap overlap(world);
  Lingering fastest(motion);
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
