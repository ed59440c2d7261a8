#include "ourengine/dynamics/contact_set.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace ourengine {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
// Of the thinner body: a point that moved less than this over its body is the same point.
constexpr double k_same_point = 0.1;
// Cosine between normals of the same point.
constexpr double k_same_normal = 0.9;
// Of the thinner body: approaches beyond this within one step are traced to the time of contact
// before the manifold is made, since the shapes face each other differently there.
constexpr double k_fast_approach = 0.5;
// Of the thinner body: tracing stops this close to contact.
constexpr double k_trace_tolerance = 1e-3;
constexpr int k_trace_limit = 40;

double thickness_m(const Geometry& geometry) {
  if (const auto* box = std::get_if<BoxGeometry>(&geometry)) return 2.0 * box->half_m.minCoeff();
  if (const auto* sphere = std::get_if<SphereGeometry>(&geometry)) return 2.0 * sphere->radius_m;
  return k_infinity;
}

PosedBox posed(const BoxGeometry& box, const Motion& motion) {
  return {box.half_m, motion.position_m, motion.attitude.toRotationMatrix()};
}
PosedSphere posed(const SphereGeometry& sphere, const Motion& motion) {
  return {motion.position_m, sphere.radius_m};
}
PosedPlane posed(const PlaneGeometry&, const Motion& motion) {
  return {motion.position_m, motion.attitude * Eigen::Vector3d::UnitZ()};
}

Manifold flipped(Manifold manifold) {
  manifold.normal = -manifold.normal;
  return manifold;
}

// One overload per pair of shapes; the catalogue of who meets whom.
struct Collide {
  double margin_m;
  Manifold operator()(const PosedBox& a, const PosedBox& b) const {
    return box_box(a, b, margin_m);
  }
  Manifold operator()(const PosedBox& a, const PosedSphere& b) const {
    return box_sphere(a, b, margin_m);
  }
  Manifold operator()(const PosedSphere& a, const PosedBox& b) const {
    return flipped(box_sphere(b, a, margin_m));
  }
  Manifold operator()(const PosedSphere& a, const PosedSphere& b) const {
    return sphere_sphere(a, b, margin_m);
  }
  Manifold operator()(const PosedPlane& a, const PosedBox& b) const {
    return plane_box(a, b, margin_m);
  }
  Manifold operator()(const PosedBox& a, const PosedPlane& b) const {
    return flipped(plane_box(b, a, margin_m));
  }
  Manifold operator()(const PosedPlane& a, const PosedSphere& b) const {
    return plane_sphere(a, b, margin_m);
  }
  Manifold operator()(const PosedSphere& a, const PosedPlane& b) const {
    return flipped(plane_sphere(b, a, margin_m));
  }
  Manifold operator()(const PosedPlane&, const PosedPlane&) const { return {}; }
};

// Gap along one separating normal: a lower bound of the distance.
struct Separation {
  double gap_m;
  Eigen::Vector3d normal;
};

template <typename A, typename B>
Separation separation(const A& a, const B& b, double margin_m) {
  if constexpr (std::is_same_v<A, PosedBox> && std::is_same_v<B, PosedBox>) {
    const BoxSeparation boxes = separate(a, b, margin_m);
    return {boxes.gap_m, boxes.normal};
  } else {
    const Manifold manifold = Collide{margin_m}(a, b);
    double gap_m = k_infinity;
    for (int p = 0; p < manifold.count; ++p) {
      gap_m = std::min(gap_m, manifold.points[static_cast<std::size_t>(p)].gap_m);
    }
    return {gap_m, manifold.normal};
  }
}

Aabb bounds(const Geometry& geometry, const Motion& motion, double margin_m) {
  Eigen::Vector3d reach = Eigen::Vector3d::Constant(k_infinity);
  if (const auto* box = std::get_if<BoxGeometry>(&geometry)) {
    reach = motion.attitude.toRotationMatrix().cwiseAbs() * box->half_m;
  } else if (const auto* sphere = std::get_if<SphereGeometry>(&geometry)) {
    reach = Eigen::Vector3d::Constant(sphere->radius_m);
  }
  reach += Eigen::Vector3d::Constant(margin_m);
  return {motion.position_m - reach, motion.position_m + reach};
}

std::vector<bool> fixed_flags(std::span<const BodyModel> bodies) {
  std::vector<bool> flags;
  for (const BodyModel& body : bodies) flags.push_back(body.fixed);
  return flags;
}

bool same_pair(const ContactPoint& point, int a, int b) {
  return point.body_a == a && point.body_b == b;
}

bool before(const ContactPoint& point, int a, int b) {
  return point.body_a != a ? point.body_a < a : point.body_b < b;
}

}  // namespace

double bounding_radius_m(const Geometry& geometry) {
  if (const auto* box = std::get_if<BoxGeometry>(&geometry)) return box->half_m.norm();
  if (const auto* sphere = std::get_if<SphereGeometry>(&geometry)) return sphere->radius_m;
  return k_infinity;
}

ContactSet::ContactSet(std::span<const BodyModel> bodies, double margin_m)
    : bodies_(bodies), margin_m_(margin_m), broad_phase_(fixed_flags(bodies), 4.0 * margin_m) {
  for (const BodyModel& body : bodies) thickness_m_.push_back(thickness_m(body.geometry));
}

void ContactSet::clear() {
  broad_phase_.clear();
  points_.clear();
  previous_.clear();
  next_id_ = 1;
}

Manifold ContactSet::collide(int a, int b, std::span<const Motion> motions, double margin_m) const {
  const auto i = static_cast<std::size_t>(a);
  const auto j = static_cast<std::size_t>(b);
  return std::visit(
      [&](const auto& shape_a, const auto& shape_b) {
        return Collide{margin_m}(posed(shape_a, motions[i]), posed(shape_b, motions[j]));
      },
      bodies_[i].geometry, bodies_[j].geometry);
}

// The manifold where the bodies first meet if both keep their velocity and attitude, with gaps
// counted back to where they are now (conservative advancement: B. Mirtich, Impulse-based Dynamic
// Simulation of Rigid Body Systems, thesis, Berkeley 1996, section 2.3).
Manifold ContactSet::collide_fast(int a, int b, std::span<const Motion> motions, double step_s,
                                  double margin_m) const {
  const auto i = static_cast<std::size_t>(a);
  const auto j = static_cast<std::size_t>(b);
  const Eigen::Vector3d relative = motions[j].velocity_mps - motions[i].velocity_mps;
  const double tolerance = k_trace_tolerance * std::min(thickness_m_[i], thickness_m_[j]);
  return std::visit(
      [&](const auto& shape_a, const auto& shape_b) {
        const auto posed_a = posed(shape_a, motions[i]);
        Motion moving = motions[j];
        double time_s = 0.0;
        for (int k = 0; k < k_trace_limit; ++k) {
          const Separation now = separation(posed_a, posed(shape_b, moving), margin_m);
          const double approach_mps = -now.normal.dot(relative);
          if (now.gap_m <= tolerance || approach_mps <= 0.0 || time_s >= step_s) break;
          time_s = std::min(step_s, time_s + now.gap_m / approach_mps);
          moving.position_m = motions[j].position_m + time_s * relative;
        }
        Manifold manifold = Collide{margin_m}(posed_a, posed(shape_b, moving));
        for (int p = 0; p < manifold.count; ++p) {
          ManifoldPoint& point = manifold.points[static_cast<std::size_t>(p)];
          point.gap_m -= time_s * manifold.normal.dot(relative);
          // Body b goes back to where it is: the point, midway between the two, goes back half.
          point.position_m -= 0.5 * time_s * relative;
        }
        return manifold;
      },
      bodies_[i].geometry, bodies_[j].geometry);
}

void ContactSet::inherit(ContactPoint& point, std::size_t first_of_pair) {
  const double thin = std::min(thickness_m_[static_cast<std::size_t>(point.body_a)],
                               thickness_m_[static_cast<std::size_t>(point.body_b)]);
  double nearest = k_same_point * k_same_point * thin * thin;
  std::size_t found = previous_.size();
  for (std::size_t k = first_of_pair;
       k < previous_.size() && same_pair(previous_[k], point.body_a, point.body_b); ++k) {
    if (inherited_[k] || previous_[k].normal.dot(point.normal) < k_same_normal) continue;
    const double distance = (previous_[k].anchor_m - point.anchor_m).squaredNorm();
    if (distance < nearest) {
      nearest = distance;
      found = k;
    }
  }
  if (found == previous_.size()) {
    point.id = next_id_++;
    return;
  }
  inherited_[found] = true;
  point.id = previous_[found].id;
  point.impulse_ns = previous_[found].impulse_ns;
}

void ContactSet::add_manifold(int a, int b, const Manifold& manifold,
                              std::span<const Motion> motions) {
  const Motion& frame = motions[static_cast<std::size_t>(b)];
  for (int p = 0; p < manifold.count; ++p) {
    const ManifoldPoint& from = manifold.points[static_cast<std::size_t>(p)];
    ContactPoint point;
    point.body_a = a;
    point.body_b = b;
    point.position_m = from.position_m;
    point.normal = manifold.normal;
    point.gap_m = from.gap_m;
    point.anchor_m = frame.attitude.conjugate() * (from.position_m - frame.position_m);
    points_.push_back(point);
  }
}

void ContactSet::update(std::span<const Motion> motions, std::span<const double> reach_m,
                        double step_s) {
  std::swap(points_, previous_);
  points_.clear();
  inherited_.assign(previous_.size(), false);
  boxes_.resize(motions.size());
  for (std::size_t i = 0; i < motions.size(); ++i) {
    boxes_[i] = bounds(bodies_[i].geometry, motions[i], 0.5 * margin_m_ + reach_m[i]);
  }
  broad_phase_.update(boxes_);

  std::size_t old = 0;
  for (const BodyPair& pair : broad_phase_.pairs()) {
    const auto i = static_cast<std::size_t>(pair.first);
    const auto j = static_cast<std::size_t>(pair.second);
    const std::size_t first_new = points_.size();
    if (boxes_[i].overlaps(boxes_[j])) {
      const double approach_m = reach_m[i] + reach_m[j];
      const double thin = std::min(thickness_m_[i], thickness_m_[j]);
      const double margin = margin_m_ + approach_m;
      add_manifold(pair.first, pair.second,
                   approach_m > k_fast_approach * thin
                       ? collide_fast(pair.first, pair.second, motions, step_s, margin)
                       : collide(pair.first, pair.second, motions, margin),
                   motions);
    }
    while (old < previous_.size() && before(previous_[old], pair.first, pair.second)) ++old;
    for (std::size_t k = first_new; k < points_.size(); ++k) inherit(points_[k], old);
  }
}

}  // namespace ourengine
