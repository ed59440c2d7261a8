// Bodies do not pass through each other: docs/hunt.md, section passage.
#include <algorithm>
#include <cmath>

#include "adapters/seam/shape.hpp"
#include "experiments/hunt/bounds.hpp"
#include "experiments/hunt/extent.hpp"
#include "experiments/hunt/oracles.hpp"
#include "experiments/metrics/penetration_depth.hpp"

namespace brickbench::hunt {
namespace {

// Beyond this turn in one step, rad, the way between two poses is anyone's guess.
constexpr double k_clear_turn_rad = 0.5;
// Looks per thinnest edge of the way, and at most so many per pair and step.
constexpr double k_looks_per_edge = 4.0;
constexpr double k_most_looks = 200.0;
// A body that was this share of its thinner neighbour's edge inside on a straight way has gone
// through, not along.
constexpr double k_through_share = 0.5;

State between(const State& from, const State& to, double share) {
  State pose = from;
  pose.position_m += share * (to.position_m - from.position_m);
  pose.orientation = from.orientation.slerp(share, to.orientation);
  return pose;
}

bool is_plane(const Body& body) { return is_half_space(body.shape); }

// How deep the whole body lies behind the plane, m; 0 if part of it does not.
double behind_m(const Body& body, const State& state, const State& plane) {
  const Eigen::Vector3d up = plane.orientation * Eigen::Vector3d::UnitZ();
  return std::max(0.0, -up.dot(state.position_m - plane.position_m) - reach_m(body.shape));
}

// The deepest overlap, m, on the straight way of one step; 0 where the pair overlaps at its ends.
double depth_on_way_m(const Body& a, const Body& b, const gate::StepRecord& record, std::size_t i,
                      std::size_t j, double way_m, double edge_m) {
  const auto depth_m = [&](double share) {
    return penetration_depth_m(a.shape, between(record.before[i], record.after[i], share), b.shape,
                               between(record.before[j], record.after[j], share));
  };
  if (depth_m(0.0) > 0.0 || depth_m(1.0) > 0.0) return 0.0;
  const double looks = std::min(k_most_looks, std::ceil(k_looks_per_edge * way_m / edge_m));
  double deepest_m = 0.0;
  for (double look = 1.0; look < looks; ++look) {
    deepest_m = std::max(deepest_m, depth_m(look / looks));
  }
  return deepest_m;
}

bool turns_little(const Body& body, const State& before, const State& after) {
  if (body.fixed) return true;
  return before.orientation.angularDistance(after.orientation) < k_clear_turn_rad;
}

void look_at_pair(const World& world, const gate::StepRecord& record, std::size_t i, std::size_t j,
                  std::size_t step, Worst& worst) {
  const Body& a = world.bodies[i];
  const Body& b = world.bodies[j];
  if (a.fixed && b.fixed) return;
  const std::string names = a.name + ", " + b.name;
  const double edge_m = std::min(thinnest_m(a.shape), thinnest_m(b.shape));
  if (is_plane(a) || is_plane(b)) {
    const double depth_m = is_plane(a) ? behind_m(b, record.after[j], record.after[i])
                                       : behind_m(a, record.after[i], record.after[j]);
    worst.see({"passage", depth_m, k_through_share * edge_m, "m", step, 0.0, names});
    return;
  }
  const Eigen::Vector3d way = (record.after[i].position_m - record.before[i].position_m) -
                              (record.after[j].position_m - record.before[j].position_m);
  const double apart_m = (record.before[j].position_m - record.before[i].position_m).norm();
  if (way.norm() < edge_m || way.norm() + reach_m(a.shape) + reach_m(b.shape) < apart_m) return;
  if (!turns_little(a, record.before[i], record.after[i]) ||
      !turns_little(b, record.before[j], record.after[j])) {
    return;
  }
  const double depth_m = depth_on_way_m(a, b, record, i, j, way.norm(), edge_m);
  worst.see({"passage", depth_m, k_through_share * edge_m, "m", step, 0.0, names});
}

}  // namespace

std::optional<Breach> passage_breach(const Motion& motion) {
  const World& world = motion.scene.world;
  Worst worst;
  for (std::size_t n = 0; n < motion.steps(); ++n) {
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      for (std::size_t j = i + 1; j < world.bodies.size(); ++j) {
        look_at_pair(world, motion.record(n), i, j, n + 1, worst);
      }
    }
  }
  return worst.breach(motion);
}

}  // namespace brickbench::hunt
