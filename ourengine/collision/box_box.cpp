// Box against box: separating axes and clipped faces. Sources in manifold.hpp.
#include <algorithm>
#include <cmath>
#include <limits>

#include "ourengine/collision/manifold.hpp"

namespace ourengine {
namespace {

double thinnest_m(const PosedBox& a, const PosedBox& b) {
  return 2.0 * std::min(a.half_m.minCoeff(), b.half_m.minCoeff());
}

// A convex polygon in the plane of a face, with its height over the reference face.
struct Polygon {
  std::array<Eigen::Vector3d, 12> corners;  // (along u, along v, height)
  int count = 0;
  void add(const Eigen::Vector3d& corner) { corners[static_cast<std::size_t>(count++)] = corner; }
  const Eigen::Vector3d& operator[](int i) const { return corners[static_cast<std::size_t>(i)]; }
};

// Keeps the part with sign * corner[axis] <= limit (Sutherland and Hodgman, Reentrant polygon
// clipping, CACM 17, 1974).
Polygon clip(const Polygon& in, int axis, double sign, double limit, double slack) {
  Polygon out;
  for (int i = 0; i < in.count; ++i) {
    const Eigen::Vector3d& here = in[i];
    const Eigen::Vector3d& next = in[(i + 1) % in.count];
    const double from = sign * here[axis] - limit;
    const double to = sign * next[axis] - limit;
    if (from <= slack) out.add(here);
    if ((from <= slack) != (to <= slack)) {
      const double along = std::clamp(from / (from - to), 0.0, 1.0);
      out.add(here + along * (next - here));
    }
  }
  return out;
}

// `reference` owns the face with outward unit normal `outward` along its axis `face`.
void clip_faces(const PosedBox& reference, int face, const Eigen::Vector3d& outward,
                const PosedBox& incident, double margin_m, double slack, Manifold& manifold) {
  const int u = (face + 1) % 3;
  const int v = (face + 2) % 3;
  const Eigen::Vector3d in_incident = incident.axes.transpose() * outward;
  Eigen::Index opposite = 0;
  in_incident.cwiseAbs().maxCoeff(&opposite);
  const double side = in_incident[opposite] > 0.0 ? -1.0 : 1.0;
  const Eigen::Index s = (opposite + 1) % 3;
  const Eigen::Index t = (opposite + 2) % 3;

  const Eigen::Vector3d face_centre =
      incident.centre_m + side * incident.half_m[opposite] * incident.axes.col(opposite);
  const Eigen::Vector3d along_s = incident.half_m[s] * incident.axes.col(s);
  const Eigen::Vector3d along_t = incident.half_m[t] * incident.axes.col(t);
  const Eigen::Vector3d reference_point = reference.centre_m + reference.half_m[face] * outward;
  const auto to_face = [&](const Eigen::Vector3d& point) {
    const Eigen::Vector3d d = point - reference_point;
    return Eigen::Vector3d(d.dot(reference.axes.col(u)), d.dot(reference.axes.col(v)),
                           d.dot(outward));
  };

  Polygon polygon;
  polygon.add(to_face(face_centre + along_s + along_t));
  polygon.add(to_face(face_centre - along_s + along_t));
  polygon.add(to_face(face_centre - along_s - along_t));
  polygon.add(to_face(face_centre + along_s - along_t));
  for (const auto& [axis, half] :
       {std::pair{0, reference.half_m[u]}, std::pair{1, reference.half_m[v]}}) {
    polygon = clip(polygon, axis, 1.0, half, slack);
    polygon = clip(polygon, axis, -1.0, half, slack);
  }
  for (int i = 0; i < polygon.count; ++i) {
    const double gap = polygon[i].z();
    if (gap > margin_m) continue;
    manifold.add(reference_point + polygon[i].x() * reference.axes.col(u) +
                     polygon[i].y() * reference.axes.col(v) + 0.5 * gap * outward,
                 gap);
  }
}

// Centre of the edge of `box` along its axis i that reaches furthest towards `direction`.
Eigen::Vector3d supporting_edge(const PosedBox& box, int i, const Eigen::Vector3d& direction) {
  Eigen::Vector3d centre = box.centre_m;
  for (int k = 0; k < 3; ++k) {
    if (k == i) continue;
    const double sign = direction.dot(box.axes.col(k)) > 0.0 ? 1.0 : -1.0;
    centre += sign * box.half_m[k] * box.axes.col(k);
  }
  return centre;
}

// The point midway between the closest points of the two supporting edges.
void touch_edges(const PosedBox& a, const PosedBox& b, int i, int j, double gap_m,
                 Manifold& manifold) {
  const Eigen::Vector3d p = supporting_edge(a, i, manifold.normal);
  const Eigen::Vector3d q = supporting_edge(b, j, -manifold.normal);
  const Eigen::Vector3d d = a.axes.col(i);
  const Eigen::Vector3d e = b.axes.col(j);
  const double cosine = d.dot(e);
  const double sine_squared = 1.0 - cosine * cosine;
  const Eigen::Vector3d between = q - p;
  double along_a = (between.dot(d) - cosine * between.dot(e)) / sine_squared;
  double along_b = (cosine * between.dot(d) - between.dot(e)) / sine_squared;
  along_a = std::clamp(along_a, -a.half_m[i], a.half_m[i]);
  along_b = std::clamp(along_b, -b.half_m[j], b.half_m[j]);
  manifold.add(0.5 * (p + along_a * d + q + along_b * e), gap_m);
}

}  // namespace

BoxSeparation separate(const PosedBox& a, const PosedBox& b, double margin_m) {
  const Eigen::Matrix3d r = a.axes.transpose() * b.axes;
  const Eigen::Matrix3d abs_r = r.cwiseAbs();
  const Eigen::Vector3d d = b.centre_m - a.centre_m;
  const Eigen::Vector3d in_a = a.axes.transpose() * d;
  const Eigen::Vector3d in_b = b.axes.transpose() * d;
  const Eigen::Vector3d gap_a = in_a.cwiseAbs() - a.half_m - abs_r * b.half_m;
  const Eigen::Vector3d gap_b = in_b.cwiseAbs() - b.half_m - abs_r.transpose() * a.half_m;
  const double bias = k_axis_bias * thinnest_m(a, b);

  Eigen::Index face_a = 0;
  Eigen::Index face_b = 0;
  const double best_a = gap_a.maxCoeff(&face_a);
  const double best_b = gap_b.maxCoeff(&face_b);
  BoxSeparation best;
  if (best_b > best_a + bias) {
    const double sign = in_b[face_b] >= 0.0 ? 1.0 : -1.0;
    best = {best_b, 3 + static_cast<int>(face_b), sign * b.axes.col(face_b)};
  } else {
    const double sign = in_a[face_a] >= 0.0 ? 1.0 : -1.0;
    best = {best_a, static_cast<int>(face_a), sign * a.axes.col(face_a)};
  }
  if (std::max(best_a, best_b) > margin_m) return best;

  double threshold = best.gap_m + bias;
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3;
    const int i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const double length_squared = 1.0 - r(i, j) * r(i, j);
      if (length_squared < k_parallel_edges) continue;
      const int j1 = (j + 1) % 3;
      const int j2 = (j + 2) % 3;
      const double length = std::sqrt(length_squared);
      // a_i x b_j in the frame of a is r(i1, j) e_i2 - r(i2, j) e_i1.
      const double distance = in_a[i2] * r(i1, j) - in_a[i1] * r(i2, j);
      const double reach = a.half_m[i1] * abs_r(i2, j) + a.half_m[i2] * abs_r(i1, j) +
                           b.half_m[j1] * abs_r(i, j2) + b.half_m[j2] * abs_r(i, j1);
      const double gap = (std::abs(distance) - reach) / length;
      if (gap <= threshold) continue;
      const double sign = distance >= 0.0 ? 1.0 : -1.0;
      best = {gap, 6 + 3 * i + j, sign / length * a.axes.col(i).cross(b.axes.col(j))};
      threshold = gap;
      if (gap > margin_m) return best;
    }
  }
  return best;
}

Manifold box_box(const PosedBox& a, const PosedBox& b, double margin_m) {
  Manifold manifold;
  const BoxSeparation best = separate(a, b, margin_m);
  if (best.gap_m > margin_m) return manifold;
  manifold.normal = best.normal;
  const double slack = k_clip_slack * thinnest_m(a, b);
  if (best.axis < 3) {
    clip_faces(a, best.axis, best.normal, b, margin_m, slack, manifold);
  } else if (best.axis < 6) {
    clip_faces(b, best.axis - 3, -best.normal, a, margin_m, slack, manifold);
  } else {
    touch_edges(a, b, (best.axis - 6) / 3, (best.axis - 6) % 3, best.gap_m, manifold);
  }
  return manifold;
}

}  // namespace ourengine
