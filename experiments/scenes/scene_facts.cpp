#include "experiments/scenes/scene_facts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "adapters/seam/shape.hpp"
#include "experiments/metrics/penetration_depth.hpp"
#include "experiments/scenes/scene_file.hpp"

namespace brickbench {
namespace {

using Eigen::Vector3d;

Shape swollen(const Shape& shape, double by_m) {
  return by_shape(
      shape,
      [&](const BoxShape& box) -> Shape {
        return BoxShape{box.half_extents_m + Vector3d::Constant(by_m)};
      },
      [&](const SphereShape& ball) -> Shape { return SphereShape{ball.radius_m + by_m}; },
      [](const PlaneShape& plane) -> Shape { return plane; });
}

// How far (m) a body reaches from its centre along a unit direction of the world.
double reach_along_m(const Body& body, const Vector3d& direction) {
  return reach_m(body.shape, body.initial.orientation.conjugate() * direction);
}

// Distance (m) from a point to the farthest point of a body.
double farthest_m(const Body& body, const Vector3d& from_m) {
  const Vector3d seen = body.initial.orientation.conjugate() * (body.initial.position_m - from_m);
  return by_shape(
      body.shape,
      [&](const BoxShape& box) { return (seen.cwiseAbs() + box.half_extents_m).norm(); },
      [&](const SphereShape& ball) { return seen.norm() + ball.radius_m; },
      [](const PlaneShape&) { return std::numeric_limits<double>::infinity(); });
}

bool lies_within(const Body& inner, const Body& outer) {
  if (is_half_space(inner.shape)) return false;
  const Vector3d offset_m = inner.initial.position_m - outer.initial.position_m;
  const auto beyond = [&](int axis, double sign) {
    const Vector3d normal = outer.initial.orientation * Vector3d(sign * Vector3d::Unit(axis));
    return normal.dot(offset_m) + reach_along_m(inner, normal);
  };
  return by_shape(
      outer.shape,
      [&](const BoxShape& box) {
        for (int axis = 0; axis < 3; ++axis) {
          for (const double sign : {-1.0, 1.0}) {
            if (beyond(axis, sign) > box.half_extents_m[axis]) return false;
          }
        }
        return true;
      },
      [&](const SphereShape& ball) {
        return farthest_m(inner, outer.initial.position_m) <= ball.radius_m;
      },
      [&](const PlaneShape&) { return beyond(2, 1.0) <= 0.0; });
}

double smaller_extent_m(const Body& a, const Body& b) {
  return std::min(half_extents_m(a.shape).maxCoeff(), half_extents_m(b.shape).maxCoeff());
}

bool may_touch(const Body& a, const Body& b, double margin_m) {
  const double reach = bounding_radius_m(a.shape) + bounding_radius_m(b.shape) + 2.0 * margin_m;
  return (a.initial.position_m - b.initial.position_m).squaredNorm() <= reach * reach;
}

std::optional<Touch> touch_of(const World& world, std::size_t i, std::size_t j) {
  const Body& a = world.bodies[i];
  const Body& b = world.bodies[j];
  if (a.fixed && b.fixed) return std::nullopt;
  const double margin_m = 0.5 * k_overlap_share * smaller_extent_m(a, b);
  if (!may_touch(a, b, margin_m)) return std::nullopt;
  const double near_m = penetration_depth_m(swollen(a.shape, margin_m), a.initial,
                                            swollen(b.shape, margin_m), b.initial);
  if (near_m == 0.0) return std::nullopt;
  Touch touch;
  touch.body_a = i;
  touch.body_b = j;
  touch.depth_m = penetration_depth_m(a.shape, a.initial, b.shape, b.initial);
  touch.overlap = touch.depth_m > 2.0 * margin_m;
  touch.inside = touch.overlap && (lies_within(a, b) || lies_within(b, a));
  touch.law = contact_law(world, i, j);
  return touch;
}

}  // namespace

std::vector<Touch> touches_at_start(const World& world) {
  std::vector<Touch> touches;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < world.bodies.size(); ++j) {
      if (const auto touch = touch_of(world, i, j)) touches.push_back(*touch);
    }
  }
  return touches;
}

double longest_step_s(const Scene& scene) {
  std::vector<double> speeds_mps;
  for (const Body& body : scene.world.bodies) {
    speeds_mps.push_back(body.initial.velocity_mps.norm());
  }
  for (const Blow& blow : scene.blows) {
    speeds_mps[blow.body] += blow.impulse_ns.norm() / scene.world.bodies[blow.body].mass_kg;
  }
  double longest_s = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < speeds_mps.size(); ++i) {
    const Body& body = scene.world.bodies[i];
    if (body.fixed || speeds_mps[i] == 0.0) continue;
    longest_s = std::min(longest_s, 0.5 * thickness_m(body.shape) / speeds_mps[i]);
  }
  return longest_s;
}

}  // namespace brickbench
