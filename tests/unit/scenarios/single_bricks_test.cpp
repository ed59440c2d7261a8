// Scenes of one, two and exploding bricks against closed forms of their own.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/tolerance.hpp"
#include "tests/unit/scenarios/scene_checks.hpp"

namespace brickbench {
namespace {

using namespace brickbench::testing;

const Body& first_brick(const Scene& scene) { return scene.world.bodies[scene.bricks[0]]; }

TEST(FreeBrick, SpinsNearItsMiddleAxisButOffTheSeparatrix) {
  const Scene scene = built("free_brick");
  EXPECT_TRUE(scene.world.gravity_mps2.isZero(0.0));
  EXPECT_EQ(scene.world.bodies.size(), 1u);
  const Body& brick = first_brick(scene);
  const Eigen::Vector3d inertia = brick.inertia_kgm2;
  EXPECT_LT(inertia.x(), inertia.y());
  EXPECT_LT(inertia.y(), inertia.z());
  const Eigen::Vector3d momentum = inertia.cwiseProduct(brick.initial.angular_velocity_radps);
  const double twice_energy = momentum.dot(brick.initial.angular_velocity_radps);
  // On the separatrix this ratio is 1 and the flip takes for ever.
  EXPECT_GT(std::abs(momentum.squaredNorm() / (twice_energy * inertia.y()) - 1.0), 1e-6);
}

TEST(FreeBrick, TakesThePublishedBox) {
  // Peters & Hsu, "Comparison of rigid body dynamic simulators for robotic simulation in Gazebo":
  // box 0.1 x 0.4 x 0.9 m of 10 kg, principal inertia (0.8083333, 0.6833333, 0.1416667) kg m2.
  const Scene scene = built("free_brick", {{"brick_length_m", 0.1},
                                           {"brick_thickness_m", 0.4},
                                           {"brick_height_m", 0.9},
                                           {"density_kgpm3", 10.0 / 0.036}});
  EXPECT_LT((first_brick(scene).inertia_kgm2 - Eigen::Vector3d(9.7, 8.2, 1.7) / 12.0).norm(),
            1e-14);
}

TEST(BrickDrop, LowestCornerStartsAtTheGivenHeight) {
  const double height_m = 0.7;
  Worst worst;
  for (const double tilt_rad : {0.0, 0.3, 0.7, 1.2, -2.0, 2.9, 4.0, 5.5}) {
    const Scene scene = built(
        "brick_drop",
        {{"drop_height_m", height_m}, {"tilt_x_rad", tilt_rad}, {"tilt_y_rad", 0.5 * tilt_rad}});
    const Body& brick = first_brick(scene);
    double lowest_m = HUGE_VAL;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d signs((corner & 1) ? 1 : -1, (corner & 2) ? 1 : -1,
                                  (corner & 4) ? 1 : -1);
      const Eigen::Vector3d local_m =
          signs.cwiseProduct(std::get<BoxShape>(brick.shape).half_extents_m);
      const Eigen::Vector3d world_m =
          brick.initial.position_m + brick.initial.orientation * local_m;
      lowest_m = std::min(lowest_m, world_m.z());
    }
    worst.see(lowest_m - height_m, "tilt " + std::to_string(tilt_rad));
  }
  // A few ulp of 1 m; nothing was left when this was written.
  EXPECT_LT(worst.residual(), 1e-15) << "lowest corner (m)";
}

TEST(TwoBricks, MeetAfterTheGapAtTheGivenOffset) {
  const Scene scene = built("two_bricks", {{"gap_m", 0.6},
                                           {"a_speed_mps", 2.0},
                                           {"b_speed_mps", -1.0},
                                           {"b_length_m", 0.4},
                                           {"offset_y_m", 0.04}});
  const Body& a = scene.world.bodies[0];
  const Body& b = scene.world.bodies[1];
  const double meet_s = 0.6 / 3.0;
  const double a_face_m = a.initial.position_m.x() + meet_s * 2.0 + 0.1;
  const double b_face_m = b.initial.position_m.x() - meet_s * 1.0 - 0.2;
  EXPECT_NEAR(a_face_m, b_face_m, 1e-15);
  EXPECT_EQ(b.initial.position_m.y(), 0.04);
  EXPECT_TRUE(scene.world.gravity_mps2.isZero(0.0));
}

TEST(Incline, BrickLiesOnTheSlopeAndStartsAlongIt) {
  const double angle_rad = 0.3;
  for (const char* slope : {"plane", "box"}) {
    const Scene scene = built(
        "incline", {{"angle_rad", angle_rad}, {"slope", std::string(slope)}, {"speed_mps", 2.0}});
    std::string where;
    EXPECT_NEAR(deepest_overlap_m(scene.world, where), 0.0, 1e-13) << slope;
    const Eigen::Vector3d downhill(std::cos(angle_rad), 0.0, -std::sin(angle_rad));
    EXPECT_LT((first_brick(scene).initial.velocity_mps - 2.0 * downhill).norm(), 1e-15) << slope;
  }
}

TEST(Incline, HeadingTurnsTheSpeedWithinTheSlope) {
  const Scene scene =
      built("incline", {{"angle_rad", 0.3}, {"speed_mps", 2.0}, {"heading_rad", M_PI / 2}});
  EXPECT_LT((first_brick(scene).initial.velocity_mps - Eigen::Vector3d(0, 2, 0)).norm(), 1e-15);
}

struct Sums {
  Eigen::Vector3d impulse_ns = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_impulse_nms = Eigen::Vector3d::Zero();  // about the centre of mass
  double absolute_ns = 0.0;
  double work_j = 0.0;
};

Sums sum_blows(const Scene& scene) {
  Eigen::Vector3d first_moment = Eigen::Vector3d::Zero();
  for (const Body& body : scene.world.bodies) {
    if (!body.fixed) first_moment += body.mass_kg * body.initial.position_m;
  }
  const Eigen::Vector3d centre_m = first_moment / moving_mass_kg(scene.world);
  Sums sums;
  for (const Blow& blow : scene.blows) {
    const Body& body = scene.world.bodies[blow.body];
    sums.impulse_ns += blow.impulse_ns;
    sums.angular_impulse_nms += (body.initial.position_m - centre_m).cross(blow.impulse_ns);
    sums.absolute_ns += blow.impulse_ns.norm();
    sums.work_j += blow.impulse_ns.squaredNorm() / (2.0 * body.mass_kg);
  }
  return sums;
}

constexpr Tolerance k_blows = {"sum of blows", 8e-15, 4.5e-16,
                               "relative to the sum of sizes; distances from the centre are "
                               "differences of rounded heights of about 1 m"};

TEST(Explosion, DoesThePrescribedWorkWithoutMovingTheCentre) {
  Worst worst;
  for (const char* profile : {"homologous", "equal_speed"}) {
    for (const double count_x : {2.0, 3.0, 5.0}) {
      const Scene scene = built("explosion", {{"profile", std::string(profile)},
                                              {"count_x", count_x},
                                              {"work_j", 321.0},
                                              {"blow_time_s", 0.1}});
      const Sums sums = sum_blows(scene);
      const std::string where = std::string(profile) + ", " + std::to_string(count_x);
      worst.see(sums.impulse_ns.norm() / sums.absolute_ns, where + ": impulse");
      worst.see(sums.angular_impulse_nms.norm() / sums.absolute_ns, where + ": angular impulse");
      worst.see(sums.work_j / 321.0 - 1.0, where + ": work");
      EXPECT_EQ(scene.blows.size(), scene.bricks.size());
      EXPECT_EQ(scene.blows[0].time_s, 0.1);
    }
  }
  EXPECT_TRUE(worst.within(k_blows));
}

TEST(Explosion, EveryBlowPointsOutwards) {
  const Scene scene =
      built("explosion", {{"count_x", 4.0}, {"profile", std::string("equal_speed")}});
  const double first = scene.blows[0].impulse_ns.norm();
  double least_outward = HUGE_VAL;
  double uneven = 0.0;
  const Eigen::Vector3d centre_m(0.0, 0.0, 1.15);
  for (const Blow& blow : scene.blows) {
    const Eigen::Vector3d away =
        (scene.world.bodies[blow.body].initial.position_m - centre_m).normalized();
    least_outward = std::min(least_outward, away.dot(blow.impulse_ns.normalized()));
    uneven = std::max(uneven, std::abs(blow.impulse_ns.norm() / first - 1.0));
  }
  EXPECT_GT(least_outward, 1.0 - 1e-12);
  EXPECT_LT(uneven, 1e-13);
}

}  // namespace
}  // namespace brickbench
