#include "ourengine/collision/manifold.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <random>
#include <string>

#include "tests/support/tolerance.hpp"

namespace ourengine {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;

std::vector<Eigen::Vector3d> corners(const PosedBox& box) {
  std::vector<Eigen::Vector3d> out;
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector3d sign((k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1, (k & 4) != 0 ? 1 : -1);
    out.push_back(box.centre_m + box.axes * sign.cwiseProduct(box.half_m));
  }
  return out;
}

// Largest separation over all 15 axes, by projecting every corner: shares nothing with separate().
double brute_gap(const PosedBox& a, const PosedBox& b, bool with_edges) {
  std::vector<Eigen::Vector3d> axes;
  for (int i = 0; i < 3; ++i) {
    axes.push_back(a.axes.col(i));
    axes.push_back(b.axes.col(i));
    for (int j = 0; j < 3 && with_edges; ++j) {
      const Eigen::Vector3d cross = a.axes.col(i).cross(b.axes.col(j));
      if (cross.norm() > 1e-3) axes.push_back(cross.normalized());
    }
  }
  double gap = -std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& axis : axes) {
    double a_low = 1e300, a_high = -1e300, b_low = 1e300, b_high = -1e300;
    for (const auto& p : corners(a)) {
      a_low = std::min(a_low, axis.dot(p));
      a_high = std::max(a_high, axis.dot(p));
    }
    for (const auto& p : corners(b)) {
      b_low = std::min(b_low, axis.dot(p));
      b_high = std::max(b_high, axis.dot(p));
    }
    gap = std::max(gap, std::max(b_low - a_high, a_low - b_high));
  }
  return gap;
}

PosedBox random_box(std::mt19937_64& random, double spread) {
  std::uniform_real_distribution<double> size(0.05, 0.3);
  std::uniform_real_distribution<double> place(-spread, spread);
  std::normal_distribution<double> normal;
  const Eigen::Quaterniond q =
      Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
          .normalized();
  return {{size(random), size(random), size(random)},
          {place(random), place(random), place(random)},
          q.toRotationMatrix()};
}

constexpr double k_bias_m = 1e-3 * 0.6;  // of the thickest box drawn: the preference for faces

constexpr Tolerance k_biased_gap = {"gap of two boxes (m)", k_bias_m, 3e-4,
                                    "an edge axis may lose to a face by the stated bias"};

TEST(BoxBox, GapIsTheLargestSeparationOverFifteenAxes) {
  std::mt19937_64 random(1);
  Worst worst;
  int edges = 0;
  for (int i = 0; i < 20000; ++i) {
    const PosedBox a = random_box(random, 0.3);
    const PosedBox b = random_box(random, 0.3);
    const BoxSeparation got = separate(a, b, 1e9);
    edges += got.axis >= 6 ? 1 : 0;
    worst.see(got.gap_m - brute_gap(a, b, true), "pair " + std::to_string(i));
    ASSERT_NEAR(got.normal.norm(), 1.0, 1e-12);
    ASSERT_GE(got.gap_m, brute_gap(a, b, false) - 2 * k_bias_m);
  }
  EXPECT_GT(edges, 1000) << "edge axes were hardly tried";
  EXPECT_TRUE(worst.within(k_biased_gap));
}

TEST(BoxBox, NormalLeadsFromAToBAndSwappingOnlyTurnsIt) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 5000; ++i) {
    const PosedBox a = random_box(random, 0.25);
    const PosedBox b = random_box(random, 0.25);
    const BoxSeparation ab = separate(a, b, 1e9);
    const BoxSeparation ba = separate(b, a, 1e9);
    ASSERT_NEAR(ab.gap_m, ba.gap_m, 2 * k_bias_m);
    ASSERT_TRUE(ab.gap_m <= 0.0 || ab.normal.dot(b.centre_m - a.centre_m) > 0.0);
  }
}

// Pushed apart along the normal by the depth, two overlapping boxes just touch.
constexpr Tolerance k_push = {"gap after pushing out (m)", 5e-14, 2.8e-15,
                              "rounding: the axis separates, whichever was chosen"};

TEST(BoxBox, DepthAlongTheNormalSeparates) {
  std::mt19937_64 random(3);
  Worst worst;
  for (int i = 0; i < 20000; ++i) {
    const PosedBox a = random_box(random, 0.15);
    PosedBox b = random_box(random, 0.15);
    const BoxSeparation got = separate(a, b, 1e9);
    if (got.gap_m >= 0.0) continue;
    b.centre_m -= got.gap_m * got.normal;
    worst.see(std::min(0.0, brute_gap(a, b, true)), "pair " + std::to_string(i));
  }
  EXPECT_TRUE(worst.within(k_push));
}

TEST(BoxBox, FlushBricksTouchAtTheFourCornersOfTheirOverlap) {
  const Eigen::Vector3d half(0.1, 0.05, 0.05);
  const PosedBox below{half, {0.0, 0.0, 0.05}, Eigen::Matrix3d::Identity()};
  std::mt19937_64 random(4);
  std::normal_distribution<double> noise(0.0, 1e-12);
  for (int i = 0; i < 1000; ++i) {
    PosedBox above{half, {0.1, 0.0, 0.15}, Eigen::Matrix3d::Identity()};
    above.centre_m += Eigen::Vector3d(noise(random), noise(random), noise(random));
    above.axes = (Eigen::AngleAxisd(noise(random), Eigen::Vector3d::UnitX()) *
                  Eigen::AngleAxisd(noise(random), Eigen::Vector3d::UnitZ()))
                     .toRotationMatrix();
    const Manifold manifold = box_box(below, above, 1e-3);
    ASSERT_EQ(manifold.count, 4);
    ASSERT_NEAR(manifold.normal.z(), 1.0, 1e-9);
    Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9);
    Eigen::Vector3d high = -low;
    for (int k = 0; k < 4; ++k) {
      low = low.cwiseMin(manifold.points[static_cast<std::size_t>(k)].position_m);
      high = high.cwiseMax(manifold.points[static_cast<std::size_t>(k)].position_m);
    }
    ASSERT_LT((low - Eigen::Vector3d(0.0, -0.05, 0.1)).norm(), 1e-6);
    ASSERT_LT((high - Eigen::Vector3d(0.1, 0.05, 0.1)).norm(), 1e-6);
  }
}

TEST(BoxBox, PointsLieMidwayBetweenTheSurfaces) {
  std::mt19937_64 random(5);
  int points = 0;
  for (int i = 0; i < 20000; ++i) {
    const PosedBox a = random_box(random, 0.3);
    const PosedBox b = random_box(random, 0.3);
    const double margin = 0.02;
    const Manifold manifold = box_box(a, b, margin);
    // Two edges that pass each other's ends: their closest points are not along the normal.
    const double off_surface = separate(a, b, margin).axis >= 6 ? margin : 1e-6;
    for (int k = 0; k < manifold.count; ++k) {
      const ManifoldPoint& point = manifold.points[static_cast<std::size_t>(k)];
      ASSERT_LE(point.gap_m, margin);
      // From the point, half the gap back along the normal is on or in a, forward on or in b.
      for (const auto& [box, sign] : {std::pair{&a, -1.0}, std::pair{&b, 1.0}}) {
        const Eigen::Vector3d on = point.position_m + 0.5 * sign * point.gap_m * manifold.normal;
        const Eigen::Vector3d local = box->axes.transpose() * (on - box->centre_m);
        ASSERT_LT((local.cwiseAbs() - box->half_m).maxCoeff(), off_surface) << "pair " << i;
      }
      ++points;
    }
  }
  EXPECT_GT(points, 10000);
}

TEST(BoxBox, NearlyParallelStacksKeepFaceContacts) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> noise(0.0, 1e-3);
  const Eigen::Vector3d half(0.1, 0.05, 0.05);
  int single = 0;
  for (int i = 0; i < 5000; ++i) {
    const PosedBox a{half, {0.0, 0.0, 0.0}, Eigen::Matrix3d::Identity()};
    const Eigen::Vector3d turn(noise(random), noise(random), noise(random));
    PosedBox b{half, {0.07, 0.01, 0.1}, Eigen::Matrix3d::Identity()};
    b.axes = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    single += box_box(a, b, 2e-3).count < 3 ? 1 : 0;
  }
  EXPECT_LT(single, 50) << "of 5000 stacked pairs lost their face contact";
}

TEST(Primitives, ClosedForms) {
  const PosedBox box{{0.1, 0.2, 0.3}, {1.0, 0.0, 0.0}, Eigen::Matrix3d::Identity()};

  const Manifold face = box_sphere(box, {{1.0, 0.0, 0.45}, 0.1}, 0.1);
  ASSERT_EQ(face.count, 1);
  EXPECT_NEAR(face.points[0].gap_m, 0.05, 1e-15);
  EXPECT_NEAR(face.points[0].position_m.z(), 0.325, 1e-15);
  EXPECT_NEAR(face.normal.z(), 1.0, 1e-15);

  const Manifold inside = box_sphere(box, {{1.08, 0.0, 0.0}, 0.05}, 0.1);
  ASSERT_EQ(inside.count, 1);
  EXPECT_NEAR(inside.normal.x(), 1.0, 1e-15);
  EXPECT_NEAR(inside.points[0].gap_m, -0.07, 1e-15);

  const Manifold balls = sphere_sphere({{0, 0, 0}, 0.5}, {{0, 0.9, 0}, 0.3}, 0.2);
  ASSERT_EQ(balls.count, 1);
  EXPECT_NEAR(balls.points[0].gap_m, 0.1, 1e-15);
}

TEST(Primitives, MarginIsHonoured) {
  const PosedPlane ground{Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ()};
  const PosedBox box{{0.1, 0.2, 0.3}, {0.0, 0.0, 0.35}, Eigen::Matrix3d::Identity()};
  EXPECT_EQ(plane_box(ground, box, 0.04).count, 0);
  const Manifold near = plane_box(ground, box, 0.06);
  ASSERT_EQ(near.count, 4);
  EXPECT_NEAR(near.points[0].gap_m, 0.05, 1e-15);
  EXPECT_EQ(sphere_sphere({{0, 0, 0}, 0.5}, {{0, 0.9, 0}, 0.3}, 0.11).count, 1);
  EXPECT_EQ(sphere_sphere({{0, 0, 0}, 0.5}, {{0, 0.9, 0}, 0.3}, 0.09).count, 0);
  EXPECT_EQ(plane_sphere(ground, {{0, 0, 0.2}, 0.1}, 0.05).count, 0);
  EXPECT_NEAR(plane_sphere(ground, {{0, 0, 0.2}, 0.1}, 0.2).points[0].gap_m, 0.1, 1e-15);
}

}  // namespace
}  // namespace ourengine
