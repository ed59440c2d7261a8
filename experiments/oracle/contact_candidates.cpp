#include "experiments/oracle/contact_candidates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "adapters/seam/shape.hpp"
#include "experiments/metrics/placed.hpp"

namespace brickbench::gate {
namespace {

using Polygon = std::vector<Eigen::Vector3d>;

double projected_half_m(const Placed& box, const Eigen::Vector3d& axis) {
  return box.half_m.dot((box.axes.transpose() * axis).cwiseAbs());
}

// The corners, edge or face of the box that lie furthest along `direction`, up to `tilt` (rad); an
// edge or face is `border_m` larger at each of its ends.
Polygon support(const Placed& box, const Eigen::Vector3d& direction, double tilt, double border_m) {
  const Eigen::Vector3d local = box.axes.transpose() * direction;
  std::vector<Eigen::Vector3d> signs = {Eigen::Vector3d::Zero()};
  std::vector<int> free;
  for (int k = 0; k < 3; ++k) {
    if (std::abs(local[k]) <= tilt) {
      free.push_back(k);
    } else {
      signs[0][k] = local[k] > 0.0 ? 1.0 : -1.0;
    }
  }
  if (free.size() == 3) free.pop_back();
  for (std::size_t n = 0; n < free.size(); ++n) {
    std::vector<Eigen::Vector3d> split;
    // In order around the face: the second split runs backwards over the mirrored half.
    for (const double side : {1.0, -1.0}) {
      std::vector<Eigen::Vector3d> half = signs;
      for (auto& s : half) s[free[n]] = side;
      if (side < 0.0) std::ranges::reverse(half);
      split.insert(split.end(), half.begin(), half.end());
    }
    signs = split;
  }
  Eigen::Vector3d half_m = box.half_m;
  for (const int k : free) half_m[k] = std::max(0.0, half_m[k] + border_m);
  Polygon corners;
  for (const auto& s : signs) {
    corners.push_back(box.center_m + box.axes * half_m.cwiseProduct(s));
  }
  return corners;
}

// Sutherland and Hodgman: what of the polygon (or segment, or point) lies below plane.x <= offset.
Polygon clip(const Polygon& polygon, const Eigen::Vector3d& plane, double offset) {
  if (polygon.size() == 1) {
    return plane.dot(polygon[0]) <= offset ? polygon : Polygon{};
  }
  Polygon out;
  const std::size_t edges = polygon.size() == 2 ? 1 : polygon.size();
  for (std::size_t i = 0; i < edges; ++i) {
    const Eigen::Vector3d& p = polygon[i];
    const Eigen::Vector3d& q = polygon[(i + 1) % polygon.size()];
    const double dp = plane.dot(p) - offset;
    const double dq = plane.dot(q) - offset;
    if (dp <= 0.0) out.push_back(p);
    if ((dp < 0.0 && dq > 0.0) || (dp > 0.0 && dq < 0.0))
      out.push_back(p + dp / (dp - dq) * (q - p));
    if (edges == 1 && dq <= 0.0) out.push_back(q);
  }
  return out;
}

constexpr double k_face_tilt = 0.1;  // rad: faces that far from the normal still count as touching

// Corners of the overlap of the two features that face each other along `axis`.
void overlap_corners(const Placed& a, const Placed& b, const Eigen::Vector3d& axis,
                     const CandidateRange& range, std::vector<ContactCandidate>& out) {
  const double face_a = (a.axes.transpose() * axis).cwiseAbs().maxCoeff();
  const double face_b = (b.axes.transpose() * axis).cwiseAbs().maxCoeff();
  const bool a_leads = face_a >= face_b;
  const Placed& lead = a_leads ? a : b;
  const Placed& other = a_leads ? b : a;
  const Eigen::Vector3d outward = a_leads ? axis : Eigen::Vector3d(-axis);
  Polygon points = support(other, -outward, k_face_tilt, range.border_m);
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d side = lead.axes.col(k);
    if (std::abs(side.dot(axis)) > 0.7) continue;
    const double middle = side.dot(lead.center_m);
    const double reach = lead.half_m[k] + range.border_m;
    points = clip(points, side, middle + reach);
    points = clip(points, -side, -middle + reach);
  }
  const double surface = outward.dot(lead.center_m) + projected_half_m(lead, outward);
  const double deepest = range.margin_m + range.slack_m;
  for (const Eigen::Vector3d& point : points) {
    const double gap = outward.dot(point) - surface;
    if (gap > deepest) continue;
    out.push_back({point - 0.5 * gap * outward, axis, gap});
  }
}

// The nearest points of the two edges that face each other along `axis`.
void edge_point(const Placed& a, const Placed& b, const Eigen::Vector3d& axis, int edge_a,
                int edge_b, double gap, std::vector<ContactCandidate>& out) {
  const auto on_edge = [](const Placed& box, const Eigen::Vector3d& direction, int edge) {
    Eigen::Vector3d point = box.center_m;
    for (int k = 0; k < 3; ++k) {
      if (k == edge) continue;
      const double side = box.axes.col(k).dot(direction) > 0.0 ? 1.0 : -1.0;
      point += side * box.half_m[k] * box.axes.col(k);
    }
    return point;
  };
  const Eigen::Vector3d pa = on_edge(a, axis, edge_a);
  const Eigen::Vector3d pb = on_edge(b, -axis, edge_b);
  const Eigen::Vector3d u = a.axes.col(edge_a);
  const Eigen::Vector3d v = b.axes.col(edge_b);
  const double c = u.dot(v);
  const Eigen::Vector3d d = pb - pa;
  const double s = (u.dot(d) - c * v.dot(d)) / (1.0 - c * c);
  const double t = (c * u.dot(d) - v.dot(d)) / (1.0 - c * c);
  const double on_a = std::clamp(s, -a.half_m[edge_a], a.half_m[edge_a]);
  const double on_b = std::clamp(t, -b.half_m[edge_b], b.half_m[edge_b]);
  out.push_back({0.5 * (pa + on_a * u + pb + on_b * v), axis, gap});
}

struct Axis {
  Eigen::Vector3d direction;  // from a towards b
  double gap_m;
  int edge_a = -1;  // both -1: a face normal
  int edge_b = -1;
};

void box_box(const Placed& a, const Placed& b, const CandidateRange& range,
             std::vector<ContactCandidate>& out) {
  const Eigen::Vector3d between = b.center_m - a.center_m;
  std::vector<Axis> axes;
  const auto add = [&](Eigen::Vector3d axis, int edge_a, int edge_b) {
    if (axis.dot(between) < 0.0) axis = -axis;
    const double gap = axis.dot(between) - projected_half_m(a, axis) - projected_half_m(b, axis);
    axes.push_back({axis, gap, edge_a, edge_b});
  };
  for (int k = 0; k < 3; ++k) {
    add(a.axes.col(k), -1, -1);
    add(b.axes.col(k), -1, -1);
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector3d cross = a.axes.col(i).cross(b.axes.col(j));
      if (cross.norm() > k_face_tilt) add(cross.normalized(), i, j);
    }
  }
  double largest = -std::numeric_limits<double>::infinity();
  for (const Axis& axis : axes) largest = std::max(largest, axis.gap_m);
  if (largest > range.margin_m) return;
  for (const Axis& axis : axes) {
    if (axis.gap_m < largest - range.slack_m) continue;
    if (axis.edge_a < 0) {
      overlap_corners(a, b, axis.direction, range, out);
    } else {
      edge_point(a, b, axis.direction, axis.edge_a, axis.edge_b, axis.gap_m, out);
    }
  }
}

// A sphere or a box above the plane's half space; the normal leaves the plane.
void on_plane(const Placed& plane, const Placed& body, const CandidateRange& range, bool plane_is_a,
              std::vector<ContactCandidate>& out) {
  const Eigen::Vector3d up = plane.axes.col(2);
  const Eigen::Vector3d normal = plane_is_a ? up : Eigen::Vector3d(-up);
  const auto add = [&](const Eigen::Vector3d& point) {
    const double gap = up.dot(point - plane.center_m);
    if (gap <= range.margin_m) out.push_back({point - 0.5 * gap * up, normal, gap});
  };
  if (body.kind == PlacedKind::sphere) {
    add(body.center_m - body.half_m[0] * up);
    return;
  }
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    add(body.center_m + body.axes * body.half_m.cwiseProduct(sign));
  }
}

// The sphere against the nearest point of the other shape (a box, or another sphere).
void on_sphere(const Placed& sphere, const Placed& other, const CandidateRange& range,
               bool sphere_is_b, std::vector<ContactCandidate>& out) {
  Eigen::Vector3d nearest = other.center_m;
  double radius = sphere.half_m[0];
  if (other.kind == PlacedKind::box) {
    const Eigen::Vector3d local = other.axes.transpose() * (sphere.center_m - other.center_m);
    Eigen::Vector3d inside = local.cwiseMax(-other.half_m).cwiseMin(other.half_m);
    if (inside == local) {  // the centre is within the box: out through the nearest face
      int k = 0;
      (other.half_m - local.cwiseAbs()).minCoeff(&k);
      const Eigen::Vector3d out_of_face = (local[k] < 0.0 ? -1.0 : 1.0) * other.axes.col(k);
      const double gap = std::abs(local[k]) - other.half_m[k] - radius;
      out.push_back(
          {sphere.center_m, sphere_is_b ? out_of_face : Eigen::Vector3d(-out_of_face), gap});
      return;
    }
    nearest = other.center_m + other.axes * inside;
  } else {
    radius += other.half_m[0];
  }
  const Eigen::Vector3d apart = sphere.center_m - nearest;
  const double gap = apart.norm() - radius;
  if (gap > range.margin_m || apart.norm() == 0.0) return;
  const Eigen::Vector3d normal = apart.normalized();
  out.push_back({sphere.center_m - (sphere.half_m[0] + 0.5 * gap) * normal,
                 sphere_is_b ? normal : Eigen::Vector3d(-normal), gap});
}

}  // namespace

void contact_candidates(const Shape& a, const State& at_a, const Shape& b, const State& at_b,
                        const CandidateRange& range, std::vector<ContactCandidate>& out) {
  const Placed pa = place(a, at_a);
  const Placed pb = place(b, at_b);
  const auto plane_first = [&] { on_plane(pa, pb, range, true, out); };
  const auto plane_second = [&] { on_plane(pb, pa, range, false, out); };
  const auto ball_first = [&] { on_sphere(pa, pb, range, false, out); };
  const auto ball_second = [&] { on_sphere(pb, pa, range, true, out); };
  std::visit(Overloaded{[&](const BoxShape&, const BoxShape&) { box_box(pa, pb, range, out); },
                        [&](const BoxShape&, const SphereShape&) { ball_second(); },
                        [&](const BoxShape&, const PlaneShape&) { plane_second(); },
                        [&](const SphereShape&, const BoxShape&) { ball_first(); },
                        [&](const SphereShape&, const SphereShape&) { ball_second(); },
                        [&](const SphereShape&, const PlaneShape&) { plane_second(); },
                        [&](const PlaneShape&, const BoxShape&) { plane_first(); },
                        [&](const PlaneShape&, const SphereShape&) { plane_first(); },
                        [&](const PlaneShape&, const PlaneShape&) {}},
             a, b);
}

}  // namespace brickbench::gate
