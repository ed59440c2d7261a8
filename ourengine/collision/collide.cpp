#include "ourengine/collision/collide.hpp"

#include <algorithm>
#include <limits>
#include <type_traits>

#include "ourengine/model/by_kind.hpp"

namespace ourengine {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
// Of the thinner body: approaches beyond this within one step are traced to the time of contact
// before the manifold is made, since the shapes face each other differently there.
constexpr double k_fast_approach = 0.5;
// Of the thinner body: tracing stops this close to contact.
constexpr double k_trace_tolerance = 1e-3;
constexpr int k_trace_limit = 40;

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

}  // namespace

double bounding_radius_m(const Geometry& geometry) {
  return by_kind(
      geometry, [](const BoxGeometry& box) { return box.half_m.norm(); },
      [](const SphereGeometry& ball) { return ball.radius_m; },
      [](const PlaneGeometry&) { return k_infinity; });
}

double thickness_m(const Geometry& geometry) {
  return by_kind(
      geometry, [](const BoxGeometry& box) { return 2.0 * box.half_m.minCoeff(); },
      [](const SphereGeometry& ball) { return 2.0 * ball.radius_m; },
      [](const PlaneGeometry&) { return k_infinity; });
}

Aabb bounds(const Geometry& geometry, const Motion& motion, double margin_m) {
  using Vector = Eigen::Vector3d;
  Vector reach = by_kind(
      geometry,
      [&](const BoxGeometry& box) -> Vector {
        return motion.attitude.toRotationMatrix().cwiseAbs() * box.half_m;
      },
      [](const SphereGeometry& ball) -> Vector { return Vector::Constant(ball.radius_m); },
      [](const PlaneGeometry&) -> Vector { return Vector::Constant(k_infinity); });
  reach += Vector::Constant(margin_m);
  return {motion.position_m - reach, motion.position_m + reach};
}

Manifold collide(const BodyModel& a, const Motion& at_a, const BodyModel& b, const Motion& at_b,
                 double margin_m) {
  return std::visit(
      [&](const auto& shape_a, const auto& shape_b) {
        return Collide{margin_m}(posed(shape_a, at_a), posed(shape_b, at_b));
      },
      a.geometry, b.geometry);
}

Manifold collide_fast(const BodyModel& a, const Motion& at_a, const BodyModel& b,
                      const Motion& at_b, double step_s, double margin_m) {
  const Eigen::Vector3d relative = at_b.velocity_mps - at_a.velocity_mps;
  const double tolerance =
      k_trace_tolerance * std::min(thickness_m(a.geometry), thickness_m(b.geometry));
  return std::visit(
      [&](const auto& shape_a, const auto& shape_b) {
        const auto posed_a = posed(shape_a, at_a);
        Motion moving = at_b;
        double time_s = 0.0;
        for (int k = 0; k < k_trace_limit; ++k) {
          const Separation now = separation(posed_a, posed(shape_b, moving), margin_m);
          const double approach_mps = -now.normal.dot(relative);
          if (now.gap_m <= tolerance || approach_mps <= 0.0 || time_s >= step_s) break;
          time_s = std::min(step_s, time_s + now.gap_m / approach_mps);
          moving.position_m = at_b.position_m + time_s * relative;
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
      a.geometry, b.geometry);
}

Manifold collide_within_step(const BodyModel& a, const Motion& at_a, const BodyModel& b,
                             const Motion& at_b, double step_s, double approach_m,
                             double margin_m) {
  const double thin = std::min(thickness_m(a.geometry), thickness_m(b.geometry));
  return approach_m > k_fast_approach * thin ? collide_fast(a, at_a, b, at_b, step_s, margin_m)
                                             : collide(a, at_a, b, at_b, margin_m);
}

}  // namespace ourengine
