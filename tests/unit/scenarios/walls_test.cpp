// Walls and towers against counts and closed forms of their own.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tests/support/tolerance.hpp"
#include "tests/unit/scenarios/scene_checks.hpp"

namespace brickbench {
namespace {

using namespace brickbench::testing;

// Sums of up to a thousand rounded terms, each wrong by up to half an ulp of the sum.
constexpr Tolerance k_sum = {"sum over a scene (relative)", 2e-14, 2.1e-15, "a hundred ulp"};

void see_relative(Worst& worst, double got, double expected, const std::string& where) {
  worst.see((got - expected) / expected, where);
}

// n courses of `mass_kg` each and of height h: sum of m g z = m g h n^2 / 2.
double wall_potential_j(double course_kg, double height_m, int courses) {
  return course_kg * 9.81 * height_m * courses * courses / 2.0;
}

TEST(BrickWall, IsTheBenchmarkWall) {
  const Scene scene = built("brick_wall");
  EXPECT_EQ(scene.world.bodies.size(), 107u);
  EXPECT_EQ(scene.bricks.size(), 105u);
  ASSERT_EQ(scene.projectiles.size(), 1u);
  Worst worst;
  see_relative(worst, moving_mass_kg(scene.world), 10 * 40.0 + 20.0, "mass");
  see_relative(worst, kinetic_energy_j(scene.world), 0.5 * 20.0 * 400.0, "kinetic energy");
  see_relative(worst, potential_energy_j(scene.world),
               wall_potential_j(40.0, 0.1, 10) + 20.0 * 9.81 * 0.52, "potential energy");
  EXPECT_TRUE(worst.within(k_sum));
}

TEST(BrickWall, GrowsAsTheClosedFormSays) {
  for (const int n : {20, 30}) {
    const double size = n;
    const Scene scene = built("brick_wall", {{"courses", size}, {"columns", size}});
    EXPECT_EQ(scene.world.bodies.size(), static_cast<std::size_t>(n * n + n / 2 + 2));
    Worst worst;
    see_relative(worst, potential_energy_j(scene.world),
                 wall_potential_j(4.0 * n, 0.1, n) + 20.0 * 9.81 * (0.05 * n + 0.02), "potential");
    EXPECT_TRUE(worst.within(k_sum)) << n;
  }
}

TEST(BrickWall, ProjectileMeetsTheWallWhereSaid) {
  const double speed_mps = 10.0;
  const Scene scene = built("brick_wall", {{"projectile_speed_mps", speed_mps},
                                           {"projectile_distance_m", 2.0},
                                           {"projectile_offset_m", -0.3},
                                           {"projectile_above_middle_m", 0.1},
                                           {"projectile_thickness_m", 0.3},
                                           {"projectile_spin_z_radps", 5.0}});
  const Body& thrown = scene.world.bodies[scene.projectiles[0]];
  // Front face to wall face: 2 m less half of each thickness.
  const double flight_s = (2.0 - 0.15 - 0.05) / speed_mps;
  const Eigen::Vector3d there_m =
      thrown.initial.position_m + flight_s * thrown.initial.velocity_mps;
  const Eigen::Vector3d expected_m(-0.3, -0.2, 0.6);
  EXPECT_LT((there_m - expected_m).norm(), 1e-14);
  EXPECT_EQ(thrown.initial.angular_velocity_radps, Eigen::Vector3d(0.0, 0.0, 5.0));
}

TEST(BrickWall, ProjectileMayBeABall) {
  const Scene scene = built("brick_wall", {{"projectile_shape", std::string("sphere")},
                                           {"projectile_length_m", 0.3},
                                           {"projectile_mass_kg", 7.0}});
  const Body& ball = scene.world.bodies[scene.projectiles[0]];
  EXPECT_EQ(std::get<SphereShape>(ball.shape).radius_m, 0.15);
  EXPECT_EQ(ball.mass_kg, 7.0);
  EXPECT_NEAR(ball.inertia_kgm2.x(), 0.4 * 7.0 * 0.15 * 0.15, 1e-16);
}

// Gaps between neighbours of one course, from the bodies alone.
std::vector<double> head_joints_m(const Scene& scene, double z_m) {
  std::vector<std::pair<double, double>> spans_m;
  for (const std::size_t index : scene.bricks) {
    const Body& body = scene.world.bodies[index];
    if (std::abs(body.initial.position_m.z() - z_m) > 1e-9) continue;
    const double half_m = std::get<BoxShape>(body.shape).half_extents_m.x();
    spans_m.emplace_back(body.initial.position_m.x() - half_m,
                         body.initial.position_m.x() + half_m);
  }
  EXPECT_TRUE(std::ranges::is_sorted(spans_m));
  std::vector<double> gaps_m;
  for (std::size_t i = 1; i < spans_m.size(); ++i) {
    gaps_m.push_back(spans_m[i].first - spans_m[i - 1].second);
  }
  return gaps_m;
}

constexpr Tolerance k_joint = {"head joint (m)", 6e-16, 3.2e-17, "a few ulp of 0.5 m"};

TEST(Wall, EveryHeadJointIsAsWideAsAsked) {
  const double gap_m = 0.004;
  const Scene scene = built("standing_wall", {{"head_joint_gap_m", gap_m}});
  Worst worst;
  for (int course = 0; course < 5; ++course) {
    const auto gaps_m = head_joints_m(scene, 0.1 * course + 0.05);
    EXPECT_EQ(gaps_m.size(), course % 2 == 0 ? 4u : 5u);
    for (const double gap : gaps_m) worst.see(gap - gap_m, "course " + std::to_string(course));
  }
  EXPECT_TRUE(worst.within(k_joint));
}

TEST(Wall, BondDecidesWhatLiesOverAJoint) {
  const auto over_a_joint = [](const Scene& scene) {
    // The second course has a brick centred over x = +-0.1005, a joint of the first (4 columns).
    return std::ranges::any_of(scene.bricks, [&](std::size_t index) {
      const Eigen::Vector3d& x_m = scene.world.bodies[index].initial.position_m;
      return std::abs(x_m.z() - 0.15) < 1e-9 && std::abs(x_m.x()) < 1e-9;
    });
  };
  const ParameterValues four = {{"columns", 4.0}, {"courses", 2.0}};
  EXPECT_TRUE(over_a_joint(built("standing_wall", four)));
  ParameterValues stacked = four;
  stacked["bond"] = std::string("stack");
  const Scene stack = built("standing_wall", stacked);
  EXPECT_FALSE(over_a_joint(stack));
  EXPECT_EQ(stack.bricks.size(), 8u);
}

TEST(Wall, WithoutHalfBricksTheEndsAreRackedBack) {
  const Scene scene = built("standing_wall", {{"half_bricks", 0.0}});
  EXPECT_EQ(scene.bricks.size(), 5u + 4u + 3u + 2u + 1u);
  for (const std::size_t index : scene.bricks) {
    EXPECT_DOUBLE_EQ(scene.world.bodies[index].mass_kg, 4.0);
  }
}

TEST(Wall, OneColumnOfHalvesStillHasTheRightMass) {
  const Scene scene = built("standing_wall", {{"columns", 1.0}, {"courses", 2.0}});
  EXPECT_EQ(scene.bricks.size(), 3u);
  EXPECT_DOUBLE_EQ(moving_mass_kg(scene.world), 8.0);
}

TEST(Tower, LeansAndOpensItsJointsAsAsked) {
  const Scene scene =
      built("tower", {{"count", 4.0}, {"offset_m", 0.02}, {"gap_m", 0.001}, {"friction", 0.8}});
  ASSERT_EQ(scene.bricks.size(), 4u);
  const Eigen::Vector3d top_m = scene.world.bodies[scene.bricks[3]].initial.position_m;
  EXPECT_LT((top_m - Eigen::Vector3d(0.06, 0.0, 0.353)).norm(), 1e-15);
  EXPECT_EQ(scene.world.law.friction, 0.8);
}

TEST(KaplaTower, HasThePublishedBlocks) {
  const Scene scene = built("kapla_tower");
  EXPECT_EQ(scene.bricks.size(), 102u);
  Worst worst;
  see_relative(worst, moving_mass_kg(scene.world), 1020.0, "mass");
  // Per floor: 8 blocks at 0.05 m and 9 at 0.15 m above its foot.
  see_relative(worst, potential_energy_j(scene.world),
               10.0 * 9.81 * (6 * (8 * 0.05 + 9 * 0.15) + 17 * 0.2 * 15), "potential energy");
  EXPECT_TRUE(worst.within(k_sum));
  EXPECT_EQ(scene.world.law.friction, 0.64);
}

}  // namespace
}  // namespace brickbench
