#include "experiments/metrics/penetration_depth.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "adapters/seam/shape.hpp"
#include "experiments/metrics/placed.hpp"

namespace brickbench {
namespace {

// sin^2 of the angle below which two edges count as parallel; penetration_depth.hpp says why.
constexpr double k_parallel_sine_squared = 1e-16;

double box_box_m(const Placed& a, const Placed& b, double floor_m) {
  const Eigen::Vector3d apart_m = b.center_m - a.center_m;
  const Eigen::Matrix3d turn = a.axes.transpose() * b.axes;  // b's axes seen from a
  const Eigen::Matrix3d size = turn.cwiseAbs();
  const Eigen::Vector3d from_a_m = a.axes.transpose() * apart_m;
  const Eigen::Vector3d along_a_m = a.half_m + size * b.half_m - from_a_m.cwiseAbs();
  double depth_m = along_a_m.minCoeff();
  if (depth_m <= floor_m) return depth_m;
  const Eigen::Vector3d along_b_m =
      b.half_m + size.transpose() * a.half_m - (b.axes.transpose() * apart_m).cwiseAbs();
  depth_m = std::min(depth_m, along_b_m.minCoeff());
  if (depth_m <= floor_m) return depth_m;

  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3;
    const int l = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int m = (j + 1) % 3;
      const int n = (j + 2) % 3;
      const double sine_squared = turn(k, j) * turn(k, j) + turn(l, j) * turn(l, j);
      if (sine_squared < k_parallel_sine_squared) continue;
      const double radii_m = a.half_m[k] * size(l, j) + a.half_m[l] * size(k, j) +
                             b.half_m[m] * size(i, n) + b.half_m[n] * size(i, m);
      const double distance_m = std::abs(from_a_m[l] * turn(k, j) - from_a_m[k] * turn(l, j));
      depth_m = std::min(depth_m, (radii_m - distance_m) / std::sqrt(sine_squared));
    }
    if (depth_m <= floor_m) return depth_m;
  }
  return depth_m;
}

// From outside the nearest point of the box counts; a centre inside leaves by the nearest face.
double box_sphere_m(const Placed& box, const Placed& sphere) {
  const Eigen::Vector3d center_m = box.axes.transpose() * (sphere.center_m - box.center_m);
  const Eigen::Vector3d beyond_m = center_m.cwiseAbs() - box.half_m;
  const double radius_m = sphere.half_m.x();
  if (beyond_m.maxCoeff() <= 0.0) return radius_m - beyond_m.maxCoeff();
  return radius_m - beyond_m.cwiseMax(0.0).norm();
}

double sphere_sphere_m(const Placed& a, const Placed& b) {
  return a.half_m.x() + b.half_m.x() - (b.center_m - a.center_m).norm();
}

// How far the lowest point lies below the plane.
double plane_m(const Placed& plane, const Placed& body) {
  const Eigen::Vector3d up = plane.axes.col(2);
  const double height_m = up.dot(body.center_m - plane.center_m);
  switch (body.kind) {
    case PlacedKind::box:
      return (body.axes.transpose() * up).cwiseAbs().dot(body.half_m) - height_m;
    case PlacedKind::sphere:
      return body.half_m.x() - height_m;
    case PlacedKind::plane:
      break;
  }
  assert(false && "two planes have no depth");
  return 0.0;
}

}  // namespace

Placed place(const Shape& shape, const State& state) {
  Placed placed;
  placed.center_m = state.position_m;
  placed.axes = state.orientation.normalized().toRotationMatrix();
  by_shape(
      shape, [&](const BoxShape& box) { placed.half_m = box.half_extents_m; },
      [&](const SphereShape& sphere) {
        placed.kind = PlacedKind::sphere;
        placed.half_m.setConstant(sphere.radius_m);
      },
      [&](const PlaneShape&) { placed.kind = PlacedKind::plane; });
  return placed;
}

Eigen::Vector3d reach_m(const Placed& placed) {
  switch (placed.kind) {
    case PlacedKind::sphere:
      return placed.half_m;
    case PlacedKind::box:
    case PlacedKind::plane:
      break;
  }
  return placed.axes.cwiseAbs() * placed.half_m;
}

double depth_above_m(const Placed& a, const Placed& b, double floor_m) {
  switch (a.kind) {
    case PlacedKind::plane:
      return plane_m(a, b);
    case PlacedKind::box:
      switch (b.kind) {
        case PlacedKind::plane:
          return plane_m(b, a);
        case PlacedKind::box:
          return box_box_m(a, b, floor_m);
        case PlacedKind::sphere:
          return box_sphere_m(a, b);
      }
      break;
    case PlacedKind::sphere:
      switch (b.kind) {
        case PlacedKind::plane:
          return plane_m(b, a);
        case PlacedKind::box:
          return box_sphere_m(b, a);
        case PlacedKind::sphere:
          return sphere_sphere_m(a, b);
      }
      break;
  }
  return 0.0;
}

double penetration_depth_m(const Shape& a, const State& at_a, const Shape& b, const State& at_b) {
  return std::max(0.0, depth_above_m(place(a, at_a), place(b, at_b), 0.0));
}

}  // namespace brickbench
