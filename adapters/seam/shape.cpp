#include "adapters/seam/shape.hpp"

#include <cmath>
#include <limits>
#include <type_traits>

namespace brickbench {
namespace {

using Eigen::Vector3d;

constexpr double k_infinity = std::numeric_limits<double>::infinity();

double difference_m(const BoxShape& a, const BoxShape& b) {
  return (a.half_extents_m - b.half_extents_m).norm();
}
double difference_m(const SphereShape& a, const SphereShape& b) {
  return std::abs(a.radius_m - b.radius_m);
}
double difference_m(const PlaneShape&, const PlaneShape&) { return 0.0; }

}  // namespace

std::string_view shape_word(const Shape& shape) {
  using Word = std::string_view;
  return by_shape(
      shape, [](const BoxShape&) -> Word { return "box"; },
      [](const SphereShape&) -> Word { return "sphere"; },
      [](const PlaneShape&) -> Word { return "plane"; });
}

bool is_half_space(const Shape& shape) {
  return by_shape(
      shape, [](const BoxShape&) { return false; }, [](const SphereShape&) { return false; },
      [](const PlaneShape&) { return true; });
}

bool is_round(const Shape& shape) {
  return by_shape(
      shape, [](const BoxShape&) { return false; }, [](const SphereShape&) { return true; },
      [](const PlaneShape&) { return false; });
}

Vector3d half_extents_m(const Shape& shape) {
  return by_shape(
      shape, [](const BoxShape& box) -> Vector3d { return box.half_extents_m; },
      [](const SphereShape& ball) -> Vector3d { return Vector3d::Constant(ball.radius_m); },
      [](const PlaneShape&) -> Vector3d { return Vector3d::Constant(k_infinity); });
}

double bounding_radius_m(const Shape& shape) {
  return by_shape(
      shape, [](const BoxShape& box) { return box.half_extents_m.norm(); },
      [](const SphereShape& ball) { return ball.radius_m; },
      [](const PlaneShape&) { return k_infinity; });
}

double thickness_m(const Shape& shape) {
  return by_shape(
      shape, [](const BoxShape& box) { return 2.0 * box.half_extents_m.minCoeff(); },
      [](const SphereShape& ball) { return 2.0 * ball.radius_m; },
      [](const PlaneShape&) { return k_infinity; });
}

double reach_m(const Shape& shape, const Vector3d& direction) {
  return by_shape(
      shape, [&](const BoxShape& box) { return box.half_extents_m.dot(direction.cwiseAbs()); },
      [](const SphereShape& ball) { return ball.radius_m; },
      [](const PlaneShape&) { return k_infinity; });
}

Shape scaled(const Shape& shape, double factor) {
  return by_shape(
      shape, [&](const BoxShape& box) -> Shape { return BoxShape{factor * box.half_extents_m}; },
      [&](const SphereShape& ball) -> Shape { return SphereShape{factor * ball.radius_m}; },
      [](const PlaneShape& plane) -> Shape { return plane; });
}

double size_difference_m(const Shape& a, const Shape& b) {
  return std::visit(
      []<class A, class B>(const A& of_a, const B& of_b) {
        if constexpr (std::is_same_v<A, B>) {
          return difference_m(of_a, of_b);
        } else {
          return k_infinity;
        }
      },
      a, b);
}

}  // namespace brickbench
