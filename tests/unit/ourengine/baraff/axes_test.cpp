// The separating axis against projections of all corners on all 15 axes.
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "ourengine/baraff/collision.hpp"
#include "tests/support/tolerance.hpp"
#include "tests/unit/ourengine/baraff/scenes.hpp"

namespace ourengine::baraff {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;

constexpr int k_axes = 15;
constexpr Tolerance k_axis_rounding{"gap_m", 3e-15, 1.7e-16,
                                    "a few hundred operations of order 0.1 m"};

struct Extent {
  double low = HUGE_VAL;
  double high = -HUGE_VAL;
};

Extent project(const RigidBody& body, const Eigen::Vector3d& axis) {
  const Eigen::Matrix3d turned = body.orientation.toRotationMatrix();
  Extent extent;
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector3d sign(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
    const Eigen::Vector3d corner = sign.cwiseProduct(std::get<Box>(body.solid).half_m);
    const double at = axis.dot(body.position_m + turned * corner);
    extent = {std::min(extent.low, at), std::max(extent.high, at)};
  }
  return extent;
}

// Gap along axis `index`; -infinity where two edges are parallel.
double gap_of_corners(const RigidBody& a, const RigidBody& b, int index) {
  const Eigen::Matrix3d of_a = a.orientation.toRotationMatrix();
  const Eigen::Matrix3d of_b = b.orientation.toRotationMatrix();
  Eigen::Vector3d axis = index < 3 ? of_a.col(index) : of_b.col(index % 3);
  if (index >= 6) axis = of_a.col((index - 6) / 3).cross(of_b.col((index - 6) % 3));
  if (axis.norm() < 1e-3) return -HUGE_VAL;
  axis.normalize();
  const Extent on_a = project(a, axis);
  const Extent on_b = project(b, axis);
  return std::max(on_b.low - on_a.high, on_a.low - on_b.high);
}

TEST(SeparatingAxis, IsTheWidestOfAllFifteenWithinItsBias) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal;
  const auto random_brick = [&](double spread_m) {
    RigidBody body =
        testing::brick({0.1, 0.05, 0.04},
                       spread_m * Eigen::Vector3d(normal(engine), normal(engine), normal(engine)));
    body.orientation =
        Eigen::Quaterniond(normal(engine), normal(engine), normal(engine), normal(engine))
            .normalized();
    compute_derived(body);
    return body;
  };
  // A face of the second brick must win by the bias over the first's, an edge by it over both.
  const double bias_m = 2.0 * 1e-3 * 0.08;
  std::array<int, k_axes> chosen{};
  Worst gap;
  int disagreed = 0;
  for (int i = 0; i < 20000; ++i) {
    const RigidBody a = random_brick(0.0);
    const RigidBody b = random_brick(0.12);
    const Axis axis = separating_axis(a, b);
    ++chosen[static_cast<std::size_t>(axis.index)];
    const std::string where = "pair " + std::to_string(i);
    gap.see(axis.gap_m - gap_of_corners(a, b, axis.index), where);
    double widest = -HUGE_VAL;
    for (int k = 0; k < k_axes; ++k) widest = std::max(widest, gap_of_corners(a, b, k));
    EXPECT_GE(axis.gap_m, widest - bias_m) << where;
    EXPECT_GT(axis.direction.dot(b.position_m - a.position_m), 0.0) << where;
    disagreed += (axis.gap_m > 0.0) != (widest > 0.0) ? 1 : 0;
  }
  EXPECT_TRUE(gap.within(k_axis_rounding));
  for (int k = 0; k < k_axes; ++k) EXPECT_GE(chosen[static_cast<std::size_t>(k)], 100) << k;
  // Only a widest gap below the bias can be overlooked.
  EXPECT_LT(disagreed, 20);
}

}  // namespace
}  // namespace ourengine::baraff
