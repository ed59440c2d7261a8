// The deepest overlap of a whole world: sweep and prune (Baraff, Dynamic Simulation of
// Non-Penetrating Rigid Bodies, 1992, section 2.3.2) joined with branch and bound.
//
// Only the worst pair is wanted. A translation along a world axis that parts the two bounding boxes
// parts the bodies too, so its length bounds the depth from above; pairs whose bound
// is not above the deepest found so far are never looked at. The worst pair of the step before goes
// first. The result is exact: that of all pairs, up to rounding.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "experiments/metrics/placed.hpp"

namespace brickbench {

struct Overlap {
  double depth_m = 0.0;    // 0: nothing overlaps, and the bodies mean nothing
  std::size_t body_a = 0;  // indices into World::bodies, a < b
  std::size_t body_b = 0;
};

class DeepestOverlap {
 public:
  explicit DeepestOverlap(const World& world);
  // (bodies), finite, order of World::bodies. Pairs of two fixed bodies do not count.
  Overlap find(std::span<const State> states);

 private:
  // Bounds along the sweep axis and the two others, in sweep order, side by side for the inner
  // loop.
  struct Bounds {
    std::array<std::vector<double>, 3> low_m;
    std::array<std::vector<double>, 3> high_m;
  };

  void place_all(std::span<const State> states);
  void sort_along_longest_axis();
  void look_at(std::size_t body_a, std::size_t body_b);
  void sweep();

  std::vector<Shape> shapes_;
  std::vector<bool> fixed_;
  std::vector<std::size_t> planes_;
  std::vector<std::uint32_t> order_;  // bodies with bounds, along the sweep axis
  std::vector<Placed> placed_;
  std::vector<Eigen::Vector3d> reach_m_;
  Bounds bounds_;
  int axis_ = -1;
  Overlap deepest_;
};

}  // namespace brickbench
