// Every compiled scene, written as a file and read back, is the same scene to the bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "experiments/scenes/scene_file.hpp"
#include "experiments/scenes/scene_text.hpp"
#include "tests/unit/scenarios/scene_checks.hpp"

namespace brickbench {
namespace {

using namespace brickbench::testing;

constexpr int k_draws = 25;  // of parameters, of each scene

// Near the default: a factor up to 2 either way, small counts, any word; now and then the default.
ParameterValues drawn(const Scenario& scenario, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  ParameterValues values;
  for (const Parameter& parameter : scenario.parameters) {
    if (unit(random) < 0.3) continue;
    if (parameter.kind == ParameterKind::choice) {
      const auto pick =
          static_cast<std::size_t>(unit(random) * static_cast<double>(parameter.choices.size()));
      values[parameter.name] = parameter.choices[pick];
      continue;
    }
    const double usual = std::get<double>(parameter.default_value);
    double value =
        usual == 0.0 ? 2.0 * unit(random) - 1.0 : usual * std::exp2(2 * unit(random) - 1);
    if (parameter.kind != ParameterKind::number) value = std::round(value);
    values[parameter.name] = std::clamp(value, parameter.minimum, parameter.maximum);
  }
  return values;
}

// The scene that the written scene is read as, and its duration.
Scene read_back(const Scene& scene, double duration_s) {
  const auto text =
      scene_text(scene, {.title = "a \"b\" \\ c", .comment = "x", .duration_s = duration_s});
  if (!text) {
    ADD_FAILURE() << text.error().reason;
    return {};
  }
  const auto scenario = parse_scene(*text, "written.toml");
  if (!scenario) {
    ADD_FAILURE() << scenario.error().text();
    return {};
  }
  EXPECT_EQ(scenario->meaning, "a \"b\" \\ c");
  EXPECT_EQ(scenario->duration_s, duration_s);
  return build(*scenario, {}).value();
}

TEST(RoundTrip, KeepsEveryBitOfEveryCompiledScene) {
  std::mt19937_64 random(7);
  for (const Scenario& scenario : scenarios()) {
    int made = 0;
    for (int draw = 0; draw < k_draws; ++draw) {
      const auto scene = build(scenario, draw == 0 ? ParameterValues{} : drawn(scenario, random));
      if (!scene) continue;  // no scene at these values
      ++made;
      ASSERT_EQ(image(read_back(*scene, scenario.duration_s)), image(*scene)) << scenario.name;
    }
    EXPECT_GT(made, k_draws / 4) << scenario.name;
  }
}

// Numbers that no scene of ours has, names that need quoting, laws of surfaces, loads of each kind.
TEST(RoundTrip, KeepsWhatNoCompiledSceneHas) {
  Scene scene;
  World& world = scene.world;
  world.gravity_mps2 = {-0.0, 5e-324, -1e300};
  world.law = {0.1 + 0.2, 1.0 / 3.0};
  world.exceptions = {{2, 1, {1e-310, 0.0}}, {1, 1, {12345678901234567890.0, 1.0}}};
  world.bodies.push_back(fixed_body("a {\"brace\"} \\ \x01 name", SphereShape{0.1}));
  for (int i = 0; i < 3; ++i) {
    Body body = solid_body("b" + std::to_string(i), BoxShape{{0.1, 1.0 / 3.0, 123.456}},
                           std::nextafter(1000.0, 0.0));
    body.surface = 3 - i;
    body.initial.position_m = {-0.0, 1e22, std::nextafter(1.0, 2.0)};
    body.initial.orientation = Eigen::Quaterniond(-0.0, 0.6, -0.8, 0.0);
    world.bodies.push_back(body);
  }
  scene.bricks = {1};
  scene.projectiles = {3};
  scene.length_scale_m = 0.1;
  scene.blows = {{2, 0.1, {1, -0.0, 3}, {0, 0, 1e-9}}};
  scene.pushes = {{.body = 1, .force_n = {1, 2, 3}, .times_s = {0.0, HUGE_VAL}, .shares = {1, 1}},
                  {.body = 3,
                   .torque_nm = {0, 1, 0},
                   .point_m = {1, 0, 0},
                   .times_s = {0.5, 0.5, 2},
                   .shares = {0, 1, 0.1}},
                  {.body = 1, .force_n = {0, 0, 1}, .times_s = {1, 2}, .shares = {1, 1}}};
  const Scene back = read_back(scene, 1.0);
  // Surfaces are numbered anew; the laws that they name are the same.
  ASSERT_EQ(back.world.bodies.size(), world.bodies.size());
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    for (std::size_t j = 0; j < world.bodies.size(); ++j) {
      EXPECT_EQ(contact_law(back.world, i, j).friction, contact_law(world, i, j).friction);
      EXPECT_EQ(contact_law(back.world, i, j).restitution, contact_law(world, i, j).restitution);
    }
  }
  const auto without_surfaces = [](Scene of) {
    for (Body& body : of.world.bodies) body.surface = 0;
    of.world.exceptions.clear();
    return image(of);
  };
  EXPECT_EQ(without_surfaces(back), without_surfaces(scene));
}

TEST(RoundTrip, RefusesWhatAFileCannotSay) {
  Scene scene;
  scene.world.bodies = {solid_body("same", SphereShape{1}, 1),
                        solid_body("same", SphereShape{1}, 1)};
  EXPECT_FALSE(scene_text(scene, {.title = "t", .comment = ""}));
  scene.world.bodies[1].name = "other";
  EXPECT_TRUE(scene_text(scene, {.title = "t", .comment = ""}));
  scene.bricks = {1, 0};
  EXPECT_FALSE(scene_text(scene, {.title = "t", .comment = ""}));
}

}  // namespace
}  // namespace brickbench
