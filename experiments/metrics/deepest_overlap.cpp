#include "experiments/metrics/deepest_overlap.hpp"

#include <algorithm>

#include "adapters/seam/shape.hpp"

namespace brickbench {

DeepestOverlap::DeepestOverlap(const World& world)
    : placed_(world.bodies.size()), reach_m_(world.bodies.size()) {
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    shapes_.push_back(world.bodies[i].shape);
    fixed_.push_back(world.bodies[i].fixed);
    if (is_half_space(world.bodies[i].shape)) {
      planes_.push_back(i);
    } else {
      order_.push_back(static_cast<std::uint32_t>(i));
    }
  }
  for (auto* side : {&bounds_.low_m, &bounds_.high_m}) {
    for (auto& values : *side) values.resize(order_.size());
  }
}

Overlap DeepestOverlap::find(std::span<const State> states) {
  place_all(states);
  const Overlap before = deepest_;
  deepest_ = {};
  if (before.depth_m > 0.0) look_at(before.body_a, before.body_b);
  for (const std::size_t plane : planes_) {
    for (const std::uint32_t body : order_) look_at(plane, body);
  }
  sort_along_longest_axis();
  sweep();
  return deepest_;
}

void DeepestOverlap::place_all(std::span<const State> states) {
  for (std::size_t i = 0; i < states.size(); ++i) {
    placed_[i] = place(shapes_[i], states[i]);
    reach_m_[i] = reach_m(placed_[i]);
  }
}

void DeepestOverlap::look_at(std::size_t body_a, std::size_t body_b) {
  if (fixed_[body_a] && fixed_[body_b]) return;
  const auto [a, b] = std::minmax(body_a, body_b);
  const double depth_m = depth_above_m(placed_[a], placed_[b], deepest_.depth_m);
  if (depth_m > deepest_.depth_m) deepest_ = {depth_m, a, b};
}

// From step to step the order hardly changes, and insertion sort is then linear.
void DeepestOverlap::sort_along_longest_axis() {
  if (order_.empty()) return;
  Eigen::Vector3d low_m = placed_[order_.front()].center_m;
  Eigen::Vector3d high_m = low_m;
  for (const std::uint32_t i : order_) {
    low_m = low_m.cwiseMin(placed_[i].center_m);
    high_m = high_m.cwiseMax(placed_[i].center_m);
  }
  Eigen::Index longest = 0;
  (high_m - low_m).maxCoeff(&longest);
  const int axis = static_cast<int>(longest);
  const auto key = [&](std::uint32_t i) { return placed_[i].center_m[axis] - reach_m_[i][axis]; };
  if (axis != axis_) {
    std::sort(order_.begin(), order_.end(), [&](auto i, auto j) { return key(i) < key(j); });
    axis_ = axis;
  }
  for (std::size_t n = 1; n < order_.size(); ++n) {
    const std::uint32_t moved = order_[n];
    const double moved_key = key(moved);
    std::size_t at = n;
    for (; at > 0 && key(order_[at - 1]) > moved_key; --at) order_[at] = order_[at - 1];
    order_[at] = moved;
  }
  for (std::size_t side = 0; side < 3; ++side) {
    const int world_axis = (axis + static_cast<int>(side)) % 3;
    for (std::size_t n = 0; n < order_.size(); ++n) {
      const std::uint32_t i = order_[n];
      bounds_.low_m[side][n] = placed_[i].center_m[world_axis] - reach_m_[i][world_axis];
      bounds_.high_m[side][n] = placed_[i].center_m[world_axis] + reach_m_[i][world_axis];
    }
  }
}

void DeepestOverlap::sweep() {
  const auto& [low_m, low_u_m, low_v_m] = bounds_.low_m;
  const auto& [high_m, high_u_m, high_v_m] = bounds_.high_m;
  for (std::size_t n = 0; n < order_.size(); ++n) {
    for (std::size_t m = n + 1; m < order_.size(); ++m) {
      if (high_m[n] - low_m[m] <= deepest_.depth_m) break;
      const double part_u_m = std::min(high_u_m[n] - low_u_m[m], high_u_m[m] - low_u_m[n]);
      const double part_v_m = std::min(high_v_m[n] - low_v_m[m], high_v_m[m] - low_v_m[n]);
      if (std::min(part_u_m, part_v_m) <= deepest_.depth_m) continue;
      look_at(order_[n], order_[m]);
    }
  }
}

}  // namespace brickbench
