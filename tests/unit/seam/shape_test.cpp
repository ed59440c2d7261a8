// What the seam says of shapes, over random shapes and directions.
#include "adapters/seam/shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/tolerance.hpp"

namespace brickbench {
namespace {

using Eigen::Vector3d;
using testing::Tolerance;
using testing::Worst;

constexpr Tolerance k_rounding = {"shape", 1e-14, 7e-16, "relative: some ten operations"};

std::vector<Shape> random_shapes(std::mt19937& random) {
  std::uniform_real_distribution<double> exponent(-3.0, 2.0);
  const auto size_m = [&] { return std::pow(10.0, exponent(random)); };
  std::vector<Shape> shapes;
  for (int i = 0; i < 20; ++i) {
    shapes.push_back(BoxShape{{size_m(), size_m(), size_m()}});
    shapes.push_back(SphereShape{size_m()});
  }
  return shapes;
}

Vector3d random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vector3d(normal(random), normal(random), normal(random)).normalized();
}

TEST(Shape, ReachLiesBetweenHalfTheThicknessAndTheBoundingRadius) {
  std::mt19937 random(1);
  for (const Shape& shape : random_shapes(random)) {
    const double most = bounding_radius_m(shape) * (1.0 + k_rounding.value);
    const double least = 0.5 * thickness_m(shape) * (1.0 - k_rounding.value);
    for (int i = 0; i < 100; ++i) {
      const double reach = reach_m(shape, random_direction(random));
      EXPECT_LE(reach, most) << shape_word(shape);
      EXPECT_GE(reach, least) << shape_word(shape);
    }
  }
}

TEST(Shape, TheBoundsAreMet) {
  std::mt19937 random(2);
  Worst worst;
  for (const Shape& shape : random_shapes(random)) {
    const Vector3d half_m = half_extents_m(shape);
    const Vector3d corner = half_m.normalized();
    const double furthest = is_round(shape) ? half_m.x() : half_m.norm();
    worst.see(reach_m(shape, corner) / furthest - 1.0, "corner");
    worst.see(bounding_radius_m(shape) / furthest - 1.0, "bounding radius");
    for (int axis = 0; axis < 3; ++axis) {
      worst.see(reach_m(shape, Vector3d::Unit(axis)) / half_m[axis] - 1.0, "half extent");
    }
    worst.see(thickness_m(shape) / (2.0 * half_m.minCoeff()) - 1.0, "thickness");
  }
  EXPECT_TRUE(worst.within(k_rounding));
}

TEST(Shape, APlaneHasNoEnd) {
  const Shape plane = PlaneShape{};
  EXPECT_TRUE(is_half_space(plane));
  EXPECT_FALSE(is_round(plane));
  EXPECT_TRUE(std::isinf(bounding_radius_m(plane)));
  EXPECT_TRUE(std::isinf(thickness_m(plane)));
  EXPECT_TRUE(std::isinf(solid_mass_kg(plane, 1.0)));
  EXPECT_EQ(size_difference_m(plane, scaled(plane, 7.0)), 0.0);
}

TEST(Shape, ScalingScalesAllItsSizes) {
  std::mt19937 random(3);
  Worst worst;
  for (const Shape& shape : random_shapes(random)) {
    for (const double factor : {1e-3, 0.5, 1.001, 30.0}) {
      const Shape other = scaled(shape, factor);
      EXPECT_EQ(shape_word(other), shape_word(shape));
      const double radius_m = bounding_radius_m(shape);
      worst.see(bounding_radius_m(other) / (factor * radius_m) - 1.0, "radius");
      worst.see(thickness_m(other) / (factor * thickness_m(shape)) - 1.0, "thickness");
      const double difference_m =
          size_difference_m(shape, other) - std::abs(factor - 1.0) * radius_m;
      worst.see(difference_m / (std::max(1.0, factor) * radius_m), "difference");
    }
  }
  EXPECT_TRUE(worst.within(k_rounding));
}

TEST(Shape, ShapesOfTwoKindsAreInfinitelyDifferent) {
  const Shape box = BoxShape{{1.0, 1.0, 1.0}}, ball = SphereShape{1.0}, plane = PlaneShape{};
  for (const Shape& a : {box, ball, plane}) {
    for (const Shape& b : {box, ball, plane}) {
      EXPECT_EQ(size_difference_m(a, b), a.index() == b.index() ? 0.0 : HUGE_VAL);
    }
  }
}

}  // namespace
}  // namespace brickbench
