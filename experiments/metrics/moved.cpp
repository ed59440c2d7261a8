#include "experiments/metrics/moved.hpp"

#include <algorithm>

namespace brickbench {
namespace {

// Distances are convex, so that a corner goes furthest.
double corner_moved_m(const BoxShape& box, const State& start, const State& now) {
  const Eigen::Vector3d shift_m = now.position_m - start.position_m;
  const Eigen::Matrix3d turn = now.orientation.normalized().toRotationMatrix() -
                               start.orientation.normalized().toRotationMatrix();
  double furthest_m = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign((corner & 1) != 0 ? 1.0 : -1.0, (corner & 2) != 0 ? 1.0 : -1.0,
                               (corner & 4) != 0 ? 1.0 : -1.0);
    const Eigen::Vector3d moved = shift_m + turn * sign.cwiseProduct(box.half_extents_m);
    furthest_m = std::max(furthest_m, moved.norm());
  }
  return furthest_m;
}

double center_moved_m(const State& start, const State& now) {
  return (now.position_m - start.position_m).norm();
}

struct MovedOf {
  const State& start;
  const State& now;
  double operator()(const BoxShape& box) const { return corner_moved_m(box, start, now); }
  double operator()(const SphereShape&) const { return center_moved_m(start, now); }
  double operator()(const PlaneShape&) const { return center_moved_m(start, now); }
};

}  // namespace

double moved_m(const Shape& shape, const State& start, const State& now) {
  return std::visit(MovedOf{start, now}, shape);
}

}  // namespace brickbench
