// What a scene file says is what the scene holds.
#include "experiments/scenes/scene_file.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <regex>

#include "adapters/seam/shape.hpp"
#include "experiments/record/file.hpp"

namespace brickbench {
namespace {

using Eigen::Vector3d;

constexpr const char* k_head = "title = \"t\"\nduration_s = 1.5\n";
constexpr const char* k_law = "[law]\nfriction = 0.5\nrestitution = 0.25\n";

Scenario read(const std::string& text) {
  auto scenario = parse_scene(text, "some/where/thing.toml");
  if (scenario) return *std::move(scenario);
  ADD_FAILURE() << scenario.error().text();
  return {};
}

Scene scene_of(const std::string& text, const ParameterValues& values = {}) {
  const Scenario scenario = read(text);
  auto scene = build(scenario, values);
  if (scene) return *std::move(scene);
  ADD_FAILURE() << scene.error().reason;
  return {};
}

TEST(SceneFile, SaysEverythingThatAWorldHolds) {
  const Scene scene = scene_of(std::string(k_head) + R"(
gravity_mps2 = [0.1, -0.2, "-9 - 0.81"]
length_scale_m = 0.125
overlaps = "allowed"
[law]
friction = 0.5
restitution = 0.25
[[pair]]
surfaces = ["ice", "wood"]
friction = 0.01
restitution = 0.75
[[body]]
name = "floor"
shape = "plane"
fixed = true
surface = "ice"
position_m = [0, 0, -3]
[[body]]
name = "box"
shape = "box"
size_m = [0.1, 0.2, 0.7]
mass_kg = 3.0
inertia_kgm2 = [0.1, 0.2, 0.25]
surface = "wood"
position_m = [1, 2, 3]
quaternion = [0.5, 0.5, -0.5, 0.5]
velocity_mps = [4, 5, 6]
angular_velocity_radps = [7, 8, 9]
[[body]]
name = "ball"
shape = "sphere"
radius_m = 0.3
density_kgpm3 = 100.0
role = "projectile"
[[body]]
name = "pebble"
shape = "sphere"
radius_m = 0.01
mass_kg = 1
role = "none"
[[blow]]
body = "box"
time_s = 0.5
impulse_ns = [1, 2, 3]
angular_impulse_nms = [0, 0, 4]
lever_m = [0, 0, 2]
[[force]]
body = "ball"
force_n = [1, 0, 0]
torque_nm = [0, 2, 0]
point_m = [0, 0, 0.25]
from_s = 0.25
until_s = 0.5
)");
  const World& world = scene.world;
  ASSERT_EQ(world.bodies.size(), 4u);
  EXPECT_EQ(world.gravity_mps2, Vector3d(0.1, -0.2, -9.0 - 0.81));
  EXPECT_EQ(scene.length_scale_m, 0.125);
  EXPECT_EQ(contact_law(world, 0, 1).friction, 0.01);
  EXPECT_EQ(contact_law(world, 0, 1).restitution, 0.75);
  EXPECT_EQ(contact_law(world, 0, 2).friction, 0.5);
  EXPECT_EQ(contact_law(world, 1, 2).restitution, 0.25);
  EXPECT_TRUE(world.bodies[0].fixed);
  EXPECT_EQ(world.bodies[0].initial.position_m.z(), -3.0);
  const Body& box = world.bodies[1];
  EXPECT_EQ(half_extents_m(box.shape), Vector3d(0.05, 0.1, 0.35));
  EXPECT_EQ(box.mass_kg, 3.0);
  EXPECT_EQ(box.inertia_kgm2, Vector3d(0.1, 0.2, 0.25));
  EXPECT_EQ(box.initial.position_m, Vector3d(1, 2, 3));
  EXPECT_EQ(box.initial.orientation.w(), 0.5);
  EXPECT_EQ(box.initial.orientation.y(), -0.5);
  EXPECT_EQ(box.initial.velocity_mps, Vector3d(4, 5, 6));
  EXPECT_EQ(box.initial.angular_velocity_radps, Vector3d(7, 8, 9));
  const Body& ball = world.bodies[2];
  EXPECT_EQ(ball.mass_kg, solid_mass_kg(ball.shape, 100.0));
  EXPECT_EQ(ball.inertia_kgm2, solid_inertia_kgm2(ball.shape, ball.mass_kg));
  EXPECT_EQ(scene.bricks, std::vector<std::size_t>{1});
  EXPECT_EQ(scene.projectiles, std::vector<std::size_t>{2});
  ASSERT_EQ(scene.blows.size(), 1u);
  EXPECT_EQ(scene.blows[0].body, 1u);
  EXPECT_EQ(scene.blows[0].time_s, 0.5);
  EXPECT_EQ(scene.blows[0].impulse_ns, Vector3d(1, 2, 3));
  EXPECT_EQ(scene.blows[0].angular_impulse_nms, Vector3d(-4, 2, 4)) << "lever x impulse added";
  ASSERT_EQ(scene.pushes.size(), 1u);
  EXPECT_EQ(scene.pushes[0].body, 2u);
  EXPECT_EQ(scene.pushes[0].force_n, Vector3d(1, 0, 0));
  EXPECT_EQ(scene.pushes[0].torque_nm, Vector3d(0, 2, 0));
  EXPECT_EQ(scene.pushes[0].point_m, Vector3d(0, 0, 0.25));
  EXPECT_EQ(scene.pushes[0].times_s, (std::vector<double>{0.25, 0.5}));
  EXPECT_EQ(scene.pushes[0].shares, (std::vector<double>{1.0, 1.0}));
}

TEST(SceneFile, IsAScenarioLikeTheCompiledOnes) {
  const std::string text = std::string(k_head) + R"(
[parameters]
count = { default = 3, minimum = 1, maximum = 9, whole = true, meaning = "boxes" }
edge_m = { default = 0.5, minimum = 0.1, maximum = 2, unit = "m", meaning = "of each" }
kind = { choices = ["loose", "tight"], meaning = "joints" }
ground = { default = true, meaning = "is there one" }
[define]
gap_m = "kind_loose ? 0.125 : 0"
[law]
friction = 0.5
restitution = 0
[[body]]
name = "ground"
shape = "plane"
fixed = true
when = "ground"
[[body]]
name = "{kind}_{k}"
shape = "box"
size_m = ["edge_m", "edge_m", "edge_m"]
density_kgpm3 = 1000
position_m = [0, 0, "edge_m / 2"]
stack = { count = "count", gap_m = "gap_m" }
)";
  const Scenario scenario = read(text);
  EXPECT_EQ(scenario.name, "thing");
  EXPECT_EQ(scenario.meaning, "t");
  EXPECT_EQ(scenario.duration_s, 1.5);
  EXPECT_EQ(scenario.file, "some/where/thing.toml");
  EXPECT_EQ(scenario.hash.size(), 32u);
  EXPECT_NE(scenario.hash, read(text + " ").hash) << "of the bytes";
  ASSERT_EQ(scenario.parameters.size(), 4u);
  EXPECT_EQ(scenario.parameters[0].kind, ParameterKind::integer);
  EXPECT_EQ(scenario.parameters[1].kind, ParameterKind::number);
  EXPECT_EQ(scenario.parameters[1].unit, "m");
  EXPECT_EQ(scenario.parameters[2].kind, ParameterKind::choice);
  EXPECT_EQ(scenario.parameters[3].kind, ParameterKind::boolean);

  const Scene plain = scene_of(text);
  ASSERT_EQ(plain.world.bodies.size(), 4u);
  EXPECT_EQ(plain.world.bodies[3].name, "loose_2");
  EXPECT_EQ(plain.world.bodies[3].initial.position_m.z(), 0.25 + 2 * 0.625);
  EXPECT_EQ(plain.length_scale_m, 0.5);
  const Scene other = scene_of(
      text, {{"count", 2.0}, {"edge_m", 1.0}, {"kind", std::string("tight")}, {"ground", 0.0}});
  ASSERT_EQ(other.world.bodies.size(), 2u);
  EXPECT_EQ(other.world.bodies[1].name, "tight_1");
  EXPECT_EQ(other.world.bodies[1].initial.position_m.z(), 1.5);

  const auto refused = build(scenario, {{"count", 10.0}});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().reason.find("1 .. 9"), std::string::npos) << refused.error().reason;
}

// One box under the given keys, on the ground or in the air.
Scene arranged(const std::string& keys) {
  return scene_of(std::string(k_head) + k_law + "[[body]]\nname = \"b\"\nshape = \"box\"\n" +
                  "size_m = [0.2, 0.4, 0.6]\nmass_kg = 1\n" + keys);
}

TEST(SceneFile, RepeatsWithIndices) {
  const Scene scene = arranged(
      "repeat = { row = 3, column = \"3 - row\" }\nwhen = \"row + column != 1\"\n"
      "position_m = [\"column\", \"row * 2\", 0]\n");
  std::vector<std::string> names;
  for (const Body& body : scene.world.bodies) names.push_back(body.name);
  EXPECT_EQ(names, (std::vector<std::string>{"b_0_0", "b_0_2", "b_1_1", "b_2_0"}));
  EXPECT_EQ(scene.world.bodies[2].initial.position_m, Vector3d(1, 2, 0));
}

TEST(SceneFile, LaysGrids) {
  const Scene corner = arranged(
      "grid = { count = [2, 3, 1], pitch_m = [1, 2, 3] }\n"
      "position_m = [10, 0, 0]\n");
  ASSERT_EQ(corner.world.bodies.size(), 6u);
  EXPECT_EQ(corner.world.bodies[1].initial.position_m, Vector3d(11, 0, 0)) << "x fastest";
  EXPECT_EQ(corner.world.bodies[4].initial.position_m, Vector3d(10, 4, 0));
  const Scene centred =
      arranged("grid = { count = [2, 1, 3], pitch_m = [1, 2, 3], centred = true }");
  EXPECT_EQ(centred.world.bodies[0].initial.position_m, Vector3d(-0.5, 0, -3));
  EXPECT_EQ(centred.world.bodies[5].initial.position_m, Vector3d(0.5, 0, 3));
}

TEST(SceneFile, StacksByTheHeightOfEachBody) {
  const Scene scene = arranged(
      "stack = { count = 3, gap_m = 0.125, shift_m = [0.5, 0, 0], turn_rad = 0.25 }\n"
      "turn = { axis = [1, 0, 0], angle_rad = \"pi / 2\" }\nposition_m = [1, 0, 0.2]\n");
  ASSERT_EQ(scene.world.bodies.size(), 3u);
  const State& third = scene.world.bodies[2].initial;
  EXPECT_NEAR(third.position_m.z(), 0.2 + 2 * (0.4 + 0.125), 1e-15) << "0.4 m high, lying";
  EXPECT_EQ(third.position_m.x(), 2.0);
  const Vector3d along = third.orientation * Vector3d::UnitX();
  EXPECT_NEAR(std::atan2(along.y(), along.x()), 0.5, 1e-15);
}

TEST(SceneFile, TurnsAboutAnAxisInTheOrderWritten) {
  const Scene scene = arranged(
      "turn = [{ axis = [0, 0, 2], angle_rad = \"pi / 2\" }, "
      "{ axis = [1, 0, 0], angle_rad = \"pi / 2\" }]\n");
  const Vector3d x = scene.world.bodies[0].initial.orientation * Vector3d::UnitX();
  EXPECT_NEAR((x - Vector3d::UnitZ()).norm(), 0.0, 1e-15) << "x to y, then y to z";
}

TEST(SceneFile, LaysRings) {
  for (const char axis : {'x', 'y', 'z'}) {
    const Scene scene = arranged(std::string("ring = { count = 4, radius_m = 5, axis = \"") + axis +
                                 "\", start_rad = 0.1 }\nposition_m = [1, 2, 3]\n");
    ASSERT_EQ(scene.world.bodies.size(), 4u);
    const Vector3d about = Vector3d::Unit(axis - 'x');
    const Vector3d out = axis == 'x' ? Vector3d::UnitY() : Vector3d::UnitX();
    for (int k = 0; k < 4; ++k) {
      const Eigen::AngleAxisd turn(0.1 + k * std::numbers::pi / 2.0, about);
      const State& at = scene.world.bodies[static_cast<std::size_t>(k)].initial;
      EXPECT_NEAR((at.position_m - Vector3d(1, 2, 3) - turn * (5.0 * out)).norm(), 0.0, 4e-15);
      EXPECT_NEAR((at.orientation * about - about).norm(), 0.0, 1e-15);
      EXPECT_NEAR((at.orientation * out - turn * out).norm(), 0.0, 1e-15);
    }
  }
}

TEST(SceneFile, RefusesOverlapsUnlessItSaysSo) {
  const std::string head = k_head;
  const std::string bodies = std::string(k_law) +
                             "[[body]]\nname = \"b\"\nshape = \"box\"\nsize_m = [1, 1, 1]\n"
                             "mass_kg = 1\nstack = { count = 3, gap_m = -0.25 }\n";
  const auto refused = parse_scene(head + bodies, "x.toml");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().reason.find("overlap by 0.25 m"), std::string::npos)
      << refused.error().reason;
  EXPECT_EQ(refused.error().at.line, 6u);
  EXPECT_EQ(scene_of(head + "overlaps = \"allowed\"\n" + bodies).world.bodies.size(), 3u);
}

TEST(SceneFile, KeepsTheCourseOfAForce) {
  const std::string body = std::string(k_head) +
                           "[[body]]\nname = \"b\"\nshape = \"sphere\"\nradius_m = 1\nmass_kg = 1\n"
                           "[[force]]\nbody = \"b\"\nforce_n = [1, 0, 0]\n";
  const Scene table = scene_of(body + "times_s = [0, 1, 1, 2]\nshares = [0, \"1/2\", 1, 0]\n");
  EXPECT_EQ(table.pushes[0].times_s, (std::vector<double>{0, 1, 1, 2}));
  EXPECT_EQ(table.pushes[0].shares, (std::vector<double>{0, 0.5, 1, 0}));
  const Scene always = scene_of(body);
  EXPECT_EQ(always.pushes[0].times_s[0], 0.0);
  EXPECT_TRUE(std::isinf(always.pushes[0].times_s[1]));
}

TEST(SceneFile, IsDocumentedByScenesThatRead) {
  const std::string text = read_file("docs/scene.md").value();
  const std::regex block("```toml\n([^`]*)```");
  std::size_t count = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), block), end; it != end; ++it) {
    const auto scenario = parse_scene((*it)[1].str(), "docs/scene.toml");
    EXPECT_TRUE(scenario.has_value()) << scenario.error().text();
    ++count;
  }
  EXPECT_EQ(count, 2u);
}

}  // namespace
}  // namespace brickbench
