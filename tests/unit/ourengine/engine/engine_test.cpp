// The library's public face: what it refuses, and that both methods do what their own classes do.
#include "ourengine/engine.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "ourengine/model/mass_properties.hpp"

namespace ourengine {
namespace {

struct Scene {
  std::vector<BodyModel> bodies;
  std::vector<Motion> motions;
  SurfaceLaws laws{1, {.friction = 0.5, .restitution = 0.0}};
  EngineOptions options;
};

// A brick above the ground and one on it.
Scene two_bricks(Method method) {
  const BodyModel brick = uniform_box({0.1, 0.05, 0.05}, 2000.0);
  Scene scene;
  scene.bodies = {fixed_plane(), brick, brick};
  scene.motions.resize(3);
  scene.motions[1].position_m = {0.0, 0.0, 0.05};
  scene.motions[2].position_m = {0.02, 0.01, 0.3};
  scene.motions[2].angular_momentum_kgm2ps = {0.01, 0.02, 0.0};
  scene.options.method = method;
  return scene;
}

tl::expected<Engine, std::string> make(const Scene& scene) {
  return Engine::make(scene.bodies, scene.motions, scene.laws, scene.options);
}

class EveryMethod : public ::testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(Engine, EveryMethod, ::testing::Values(Method::exact, Method::fast));

TEST_P(EveryMethod, BricksComeToRestOnEachOther) {
  auto engine = make(two_bricks(GetParam()));
  ASSERT_TRUE(engine) << engine.error();
  for (int step = 0; step < 480; ++step) engine->step();
  const auto motions = engine->motions();
  // Soft contact sags by a fraction of a millimetre.
  EXPECT_NEAR(motions[1].position_m.z(), 0.05, 1e-4);
  EXPECT_NEAR(motions[2].position_m.z(), 0.15, 2e-4);
  EXPECT_LT(motions[2].velocity_mps.norm(), 1e-3);
  double lift_ns = 0.0;
  for (const EngineContact& contact : engine->contacts()) {
    if (contact.body_a == 0) lift_ns += contact.impulse_ns.z();
  }
  const double weight_ns = 2.0 * engine->bodies()[1].mass_kg * 9.81 * engine->options().step_s;
  EXPECT_NEAR(lift_ns, weight_ns, 1e-3 * weight_ns);
}

TEST_P(EveryMethod, SameCallsGiveTheSameBits) {
  auto first = make(two_bricks(GetParam()));
  auto second = make(two_bricks(GetParam()));
  ASSERT_TRUE(first && second);
  const Engine moved = std::move(*second);
  second = make(two_bricks(GetParam()));
  for (int step = 0; step < 100; ++step) {
    first->step();
    second->step();
  }
  for (std::size_t i = 0; i < first->motions().size(); ++i) {
    EXPECT_EQ(first->motions()[i].position_m, second->motions()[i].position_m);
    EXPECT_EQ(first->motions()[i].velocity_mps, second->motions()[i].velocity_mps);
  }
}

TEST_P(EveryMethod, LoadsLastOneStep) {
  Scene scene = two_bricks(GetParam());
  scene.options.gravity_mps2.setZero();
  scene.motions[2].angular_momentum_kgm2ps.setZero();
  auto engine = make(scene);
  ASSERT_TRUE(engine);
  std::vector<Load> loads(3);
  loads[2].force_n = {0.0, 0.0, 10.0};
  engine->apply(loads);
  engine->step();
  engine->step();
  const double gained_mps = 10.0 * scene.options.step_s / scene.bodies[2].mass_kg;
  EXPECT_NEAR(engine->motions()[2].velocity_mps.z(), gained_mps, 1e-6 * gained_mps);
}

TEST_P(EveryMethod, AFixedBodyNeverMoves) {
  Scene scene = two_bricks(GetParam());
  scene.bodies[1] = fixed(scene.bodies[1]);
  scene.motions[1].velocity_mps = {1.0, 2.0, 3.0};
  auto engine = make(scene);
  ASSERT_TRUE(engine);
  for (int step = 0; step < 100; ++step) engine->step();
  EXPECT_EQ(engine->motions()[1].position_m, scene.motions[1].position_m);
  EXPECT_EQ(engine->motions()[1].velocity_mps, Eigen::Vector3d(0, 0, 0));
}

TEST(EngineRefuses, WhatNoEngineCanHave) {
  constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<std::string, std::function<void(Scene&)>>> faults = {
      {"step_s is not positive", [](Scene& s) { s.options.step_s = 0.0; }},
      {"step_s is not positive", [](Scene& s) { s.options.step_s = k_nan; }},
      {"gravity is not finite", [](Scene& s) { s.options.gravity_mps2.x() = k_nan; }},
      {"threads is below 1", [](Scene& s) { s.options.threads = 0; }},
      {"bodies and motions differ in number", [](Scene& s) { s.motions.pop_back(); }},
      {"body 1: mass is not positive", [](Scene& s) { s.bodies[1].mass_kg = -1.0; }},
      {"body 2: inertia is not positive", [](Scene& s) { s.bodies[2].inertia_kgm2.y() = 0.0; }},
      {"body 1: half edges are not positive",
       [](Scene& s) {
         s.bodies[1].geometry = BoxGeometry{{0.1, 0.0, 0.1}};
       }},
      {"body 1: radius is not positive",
       [](Scene& s) { s.bodies[1].geometry = SphereGeometry{-0.1}; }},
      {"body 1: a plane must be fixed", [](Scene& s) { s.bodies[1].geometry = PlaneGeometry{}; }},
      {"body 2: its surface has no law", [](Scene& s) { s.bodies[2].surface = 1; }},
      {"body 1: position is not finite", [](Scene& s) { s.motions[1].position_m.z() = k_nan; }},
      {"body 1: velocity is not finite", [](Scene& s) { s.motions[1].velocity_mps.z() = k_nan; }},
      {"body 1: angular momentum is not finite",
       [](Scene& s) { s.motions[1].angular_momentum_kgm2ps.z() = k_nan; }},
      {"body 1: attitude is not a quaternion of length 1",
       [](Scene& s) { s.motions[1].attitude.coeffs() *= 1.1; }},
  };
  for (const auto& [reason, seed] : faults) {
    Scene scene = two_bricks(Method::exact);
    seed(scene);
    const auto engine = make(scene);
    ASSERT_FALSE(engine) << reason;
    EXPECT_EQ(engine.error(), reason);
  }
}

TEST(UniformBodies, HaveTheMassAndInertiaOfTheirShape) {
  // Cuboid of edges a, b, c: I_xx = m (b^2 + c^2) / 12.
  const BodyModel box = uniform_box({0.1, 0.2, 0.3}, 500.0);
  EXPECT_DOUBLE_EQ(box.mass_kg, 24.0);
  EXPECT_NEAR(box.inertia_kgm2.x(), 24.0 * (0.4 * 0.4 + 0.6 * 0.6) / 12.0, 1e-14);
  EXPECT_NEAR(box.inertia_kgm2.y(), 24.0 * (0.2 * 0.2 + 0.6 * 0.6) / 12.0, 1e-14);
  EXPECT_NEAR(box.inertia_kgm2.z(), 24.0 * (0.2 * 0.2 + 0.4 * 0.4) / 12.0, 1e-14);
  const BodyModel ball = uniform_sphere(0.5, 3.0 / std::numbers::pi);
  EXPECT_NEAR(ball.mass_kg, 0.5, 1e-15);
  EXPECT_NEAR(ball.inertia_kgm2.x(), 0.4 * 0.5 * 0.25, 1e-15);
}

}  // namespace
}  // namespace ourengine
