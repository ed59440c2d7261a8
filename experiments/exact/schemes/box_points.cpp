#include "experiments/exact/schemes/box_points.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace brickbench::exact {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Box {
  Vector3d half_m;
  const State& state;
  Matrix3d axes = state.orientation.toRotationMatrix();
};

double thinnest_m(const Box& a, const Box& b) {
  return 2.0 * std::min(a.half_m.minCoeff(), b.half_m.minCoeff());
}

double gap_along(const Vector3d& axis, const Box& a, const Box& b) {
  return std::abs(axis.dot(b.state.position_m - a.state.position_m)) -
         a.half_m.dot((a.axes.transpose() * axis).cwiseAbs()) -
         b.half_m.dot((b.axes.transpose() * axis).cwiseAbs());
}

// The face of `box` of largest gap to `other`.
struct Face {
  double gap_m = -std::numeric_limits<double>::infinity();
  Index axis = 0;
  double side = 1.0;
};

Face best_face(const Box& box, const Box& other) {
  Face best;
  const Vector3d between_m = other.state.position_m - box.state.position_m;
  for (Index k = 0; k < 3; ++k) {
    const double gap_m = gap_along(box.axes.col(k), box, other);
    if (gap_m > best.gap_m) {
      best = {gap_m, k, box.axes.col(k).dot(between_m) < 0.0 ? -1.0 : 1.0};
    }
  }
  return best;
}

// Keeps what is within sign * corner[axis] <= limit.
std::vector<Vector3d> clipped(const std::vector<Vector3d>& corners, Index axis, double sign,
                              double limit_m, double slack_m) {
  std::vector<Vector3d> kept;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector3d& here = corners[i];
    const Vector3d& next = corners[(i + 1) % corners.size()];
    const double from_m = sign * here[axis] - limit_m, to_m = sign * next[axis] - limit_m;
    if (from_m <= slack_m) kept.push_back(here);
    if ((from_m <= slack_m) == (to_m <= slack_m)) continue;
    kept.push_back(here + std::clamp(from_m / (from_m - to_m), 0.0, 1.0) * (next - here));
  }
  return kept;
}

// Places (world) on the most opposed face of `other` over the face of `box`, with their heights.
std::vector<BoxPoint> over_face(const BoxPlaces& rule, const Box& box, const Face& face,
                                const Box& other) {
  const Vector3d outward = box.state.orientation * Vector3d(face.side * Vector3d::Unit(face.axis));
  const Vector3d towards = other.state.orientation.conjugate() * -outward;
  Index opposed = 0;
  towards.cwiseAbs().maxCoeff(&opposed);
  const double slack_m = rule.border_share * thinnest_m(box, other);
  const Index u = (face.axis + 1) % 3, v = (face.axis + 2) % 3;
  std::vector<BoxPoint> corners;
  std::vector<Vector3d> local;
  bool outside = false;
  constexpr std::array<std::array<double, 2>, 4> k_around = {{{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};
  for (const auto& [s, t] : k_around) {
    Vector3d corner = other.half_m;
    corner[opposed] *= std::copysign(1.0, towards[opposed]);
    corner[(opposed + 1) % 3] *= s;
    corner[(opposed + 2) % 3] *= t;
    const Vector3d place = other.state.position_m + other.state.orientation * corner;
    const Vector3d between_m = place - box.state.position_m;
    corners.push_back({place, outward.dot(between_m) - box.half_m[face.axis]});
    local.push_back(box.state.orientation.conjugate() * between_m);
    outside = outside || std::abs(local.back()[u]) > box.half_m[u] + slack_m ||
              std::abs(local.back()[v]) > box.half_m[v] + slack_m;
  }
  if (!outside) return corners;
  for (const Index axis : {u, v}) {
    for (const double sign : {1.0, -1.0}) {
      local = clipped(local, axis, sign, box.half_m[axis], slack_m);
    }
  }
  corners.clear();
  for (const Vector3d& corner : local) {
    corners.push_back({box.state.position_m + box.state.orientation * corner,
                       face.side * corner[face.axis] - box.half_m[face.axis]});
  }
  return corners;
}

// The middle of the edge of `box` along axis i that reaches furthest towards `direction`.
Vector3d supporting_edge(const Box& box, Index i, const Vector3d& direction) {
  Vector3d middle = box.state.position_m;
  for (Index k = 0; k < 3; ++k) {
    if (k == i) continue;
    const double side = direction.dot(box.axes.col(k)) > 0.0 ? 1.0 : -1.0;
    middle += side * box.half_m[k] * box.axes.col(k);
  }
  return middle;
}

// Midway between the closest points of the lines of two edges, each within its length.
Vector3d between_edges(const Box& a, Index i, const Box& b, Index j, const Vector3d& normal) {
  const Vector3d p = supporting_edge(a, i, normal), q = supporting_edge(b, j, -normal);
  const Vector3d d = a.axes.col(i), e = b.axes.col(j);
  Eigen::Matrix2d lines;
  lines << 1.0, -d.dot(e), -d.dot(e), 1.0;
  const Eigen::Vector2d along = lines.inverse() * Eigen::Vector2d(d.dot(q - p), -e.dot(q - p));
  return 0.5 * (p + std::clamp(along.x(), -a.half_m[i], a.half_m[i]) * d + q +
                std::clamp(along.y(), -b.half_m[j], b.half_m[j]) * e);
}

}  // namespace

const BoxShape* box_of(const Shape& shape) {
  using Found = const BoxShape*;
  return by_shape(
      shape, [](const BoxShape& box) -> Found { return &box; },
      [](const SphereShape&) -> Found { return nullptr; },
      [](const PlaneShape&) -> Found { return nullptr; });
}

BoxPoints box_points(const BoxPlaces& rule, const Vector3d& half_a_m, const State& at_a,
                     const Vector3d& half_b_m, const State& at_b) {
  const Box a{half_a_m, at_a}, b{half_b_m, at_b};
  const double bias_m = rule.axis_bias * thinnest_m(a, b);
  const Face of_a = best_face(a, b), of_b = best_face(b, a);
  const bool on_b = of_b.gap_m > of_a.gap_m + bias_m;
  BoxPoints result;
  result.gap_m = on_b ? of_b.gap_m : of_a.gap_m;
  double to_beat_m = result.gap_m + bias_m;
  Index edge_a = -1, edge_b = -1;
  for (Index i = 0; i < 3; ++i) {
    for (Index j = 0; j < 3; ++j) {
      const Vector3d across = a.axes.col(i).cross(b.axes.col(j));
      if (across.squaredNorm() < rule.parallel) continue;
      const double gap_m = gap_along(across.normalized(), a, b);
      if (gap_m <= to_beat_m) continue;
      result.gap_m = to_beat_m = gap_m;
      edge_a = i;
      edge_b = j;
    }
  }
  if (edge_a >= 0) {
    result.normal = a.axes.col(edge_a).cross(b.axes.col(edge_b)).normalized();
    if (result.normal.dot(at_b.position_m - at_a.position_m) < 0.0) result.normal *= -1.0;
    const Vector3d middle = between_edges(a, edge_a, b, edge_b, result.normal);
    result.points = {{middle + 0.5 * result.gap_m * result.normal, result.gap_m}};
  } else if (on_b) {
    result.normal = at_b.orientation * Vector3d(-of_b.side * Vector3d::Unit(of_b.axis));
    result.points = over_face(rule, b, of_b, a);
    for (BoxPoint& point : result.points) point.on_b_m += point.gap_m * result.normal;
  } else {
    result.normal = at_a.orientation * Vector3d(of_a.side * Vector3d::Unit(of_a.axis));
    result.points = over_face(rule, a, of_a, b);
  }
  return result;
}

}  // namespace brickbench::exact
