// What several rooms ask of a shape, stated once, and the one way to branch on it.
#pragma once

#include <string_view>
#include <utility>
#include <variant>

#include "adapters/seam/world.hpp"

namespace brickbench {

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

// What the case for the shape at hand returns. There is one case for each kind of shape: where a
// kind is added, nothing that branches compiles until it says what it does with it.
template <class... Cases>
decltype(auto) by_shape(const Shape& shape, Cases&&... cases) {
  static_assert(sizeof...(Cases) == std::variant_size_v<Shape>, "one case for each kind of shape");
  return std::visit(Overloaded{std::forward<Cases>(cases)...}, shape);
}

// "box", "sphere", "plane".
std::string_view shape_word(const Shape& shape);

// Whether it is the solid side of a plane, without end.
bool is_half_space(const Shape& shape);

// Whether it looks the same however it is turned.
bool is_round(const Shape& shape);

// Half the edges (m) of the smallest box along the body axes that holds the shape; infinite for a
// plane.
Eigen::Vector3d half_extents_m(const Shape& shape);

// Radius (m) of the smallest ball about the centre of mass that holds the shape; infinite for a
// plane.
double bounding_radius_m(const Shape& shape);

// Least distance (m) between two parallel planes that hold the shape; infinite for a plane.
double thickness_m(const Shape& shape);

// How far (m) the shape reaches from its centre of mass along a unit direction (body frame);
// infinite for a plane.
double reach_m(const Shape& shape, const Eigen::Vector3d& direction);

// The shape with all its lengths multiplied by `factor` > 0.
Shape scaled(const Shape& shape, double factor);

// Distance (m) between the sizes of two shapes of one kind; infinite where the kinds differ.
double size_difference_m(const Shape& a, const Shape& b);

}  // namespace brickbench
