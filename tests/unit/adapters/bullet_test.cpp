// What only Bullet needs: its clamps of spins and turns, and boxes with sharp edges.
#include <cmath>

#include "tests/unit/adapters/cases.hpp"

namespace brickbench {
Adapter bullet_adapter();

namespace testing {
namespace {

TEST(Bullet, RefusesASpinThatItWouldClamp) {
  World world;
  world.bodies = {brick({})};
  Settings settings;
  settings.step_s = 0.01;
  world.bodies[0].initial.angular_velocity_radps = {0, 0, 157.0};  // pi/2 per step = 157.08 rad/s
  EXPECT_TRUE(build(bullet_adapter(), world, settings));
  world.bodies[0].initial.angular_velocity_radps = {0, 0, 157.2};
  const auto built = build(bullet_adapter(), world, settings);
  ASSERT_FALSE(built);
  EXPECT_EQ(built.error().fault, Fault::unsupported);
}

TEST(Bullet, CountsASpinThatItClamped) {
  World world;
  world.bodies = {brick({})};
  const auto simulation = make(bullet_adapter(), world, {});
  std::vector<Wrench> wrenches(1);
  wrenches[0].torque_nm.x() = 1e6;
  simulation->apply(wrenches);
  run(*simulation, 1);
  const auto diagnostics = simulation->diagnostic_view()->diagnostics();
  ASSERT_EQ(diagnostics[0].name, "spin_clamped_bodies");
  EXPECT_EQ(diagnostics[0].value, 1.0);
}

// Up to an eighth of a turn per step the pose follows the spin; beyond, it lags as the scheme says.
TEST(Bullet, TurnsBeyondAnEighthComeOutAsTheSchemeStates) {
  constexpr double k_pi = 3.14159265358979323846;
  const Scheme scheme = scheme_of(bullet_adapter(), {.variant = "si"}).value();
  EXPECT_EQ(scheme.turn_limit_rad, 0.25 * k_pi);
  for (const double turn_rad : {0.1, 0.78, 0.79, 1.0, 1.3, 1.57}) {
    World world;
    world.gravity_mps2.setZero();
    world.bodies = {solid_body("ball", SphereShape{0.1}, k_density_kgpm3, {})};
    Settings settings;
    settings.step_s = 0.01;
    world.bodies[0].initial.angular_velocity_radps.z() = turn_rad / settings.step_s;
    const auto simulation = make(bullet_adapter(), world, settings);
    run(*simulation, 1);
    const double share = turn_rad / scheme.turn_limit_rad;
    const double stated_rad =
        share > 1.0 ? 2.0 * std::atan(share * std::tan(0.5 * scheme.turn_limit_rad)) : turn_rad;
    const Eigen::Quaterniond turned = states_of(*simulation, world)[0].orientation;
    EXPECT_NEAR(turned.angularDistance(Eigen::Quaterniond::Identity()), stated_rad, 1e-14);
    const auto diagnostics = simulation->diagnostic_view()->diagnostics();
    ASSERT_EQ(diagnostics[1].name, "turn_cut_bodies");
    EXPECT_EQ(diagnostics[1].value, share > 1.0 ? 1.0 : 0.0);
  }
}

// A sphere above a box's edge, diagonally: with the library's rounded edges (5 mm) it would fall
// 0.0021 m further before it touches.
TEST(Bullet, BoxesHaveSharpEdgesForSpheres) {
  constexpr double k_radius_m = 0.05;
  World world;
  world.gravity_mps2.setZero();
  world.law = {0.0, 0.0};
  const double reach_m = k_radius_m / std::sqrt(2.0);
  State above = at(0.05 + reach_m + 0.01, 0, 0.05 + reach_m + 0.01);
  above.velocity_mps = {-0.1, 0, -0.1};
  world.bodies = {fixed_body("box", BoxShape{{0.05, 0.05, 0.05}}),
                  solid_body("ball", SphereShape{k_radius_m}, k_density_kgpm3, above)};
  const auto simulation = make(bullet_adapter(), world, {});
  run(*simulation, 300);
  const Eigen::Vector3d end_m = states_of(*simulation, world)[1].position_m;
  EXPECT_NEAR(end_m.x() - 0.05, reach_m, 2e-4) << "one step of 0.1 m/s and Bullet's GJK";
}

}  // namespace
}  // namespace testing
}  // namespace brickbench
