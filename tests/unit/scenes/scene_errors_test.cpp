// Bad scene files: where, what is wrong, and what is right.
#include <gtest/gtest.h>

#include "experiments/scenes/scene_file.hpp"

namespace brickbench {
namespace {

// A good scene; each case below replaces one line of it, counted from 1.
const std::vector<std::string> k_good_lines = {
    "title = 't'",
    "duration_s = 1",
    "gravity_mps2 = [0, 0, -9.81]",
    "overlaps = 'refused'",
    "[parameters]",
    "edge_m = { default = 0.5, minimum = 0.1, maximum = 2, unit = 'm', meaning = 'of each' }",
    "kind = { choices = ['loose', 'tight'], meaning = 'joints' }",
    "[define]",
    "half_m = 'edge_m / 2'",
    "[law]",
    "friction = 0.5",
    "restitution = 0",
    "[[pair]]",
    "surfaces = ['ice', 'wood']",
    "friction = 0.1",
    "restitution = 0",
    "[[body]]",
    "name = 'ground'",
    "shape = 'plane'",
    "fixed = true",
    "surface = 'ice'",
    "[[body]]",
    "name = 'box_{k}'",
    "shape = 'box'",
    "size_m = ['edge_m', 'edge_m', 'edge_m']",
    "mass_kg = 2",
    "surface = 'wood'",
    "position_m = [0, 0, 'half_m']",
    "stack = { count = 2, gap_m = 0.1 }",
    "role = 'brick'",
    "[[blow]]",
    "body = 'box_1'",
    "time_s = 0",
    "impulse_ns = [1, 0, 0]",
    "[[force]]",
    "body = 'box_0'",
    "force_n = [1, 0, 0]",
    "times_s = [0, 1]",
    "shares = [0, 1]"};

std::string with_line(std::size_t line, const std::string& text) {
  std::string all;
  for (std::size_t i = 1; i <= k_good_lines.size(); ++i) {
    all += (i == line ? text : k_good_lines[i - 1]) + '\n';
  }
  return all;
}

struct BadLine {
  std::size_t line;    // that is replaced
  const char* text;    // by this
  std::size_t at;      // line of the complaint; 0: the file as a whole
  std::size_t column;  // 0: any
  std::vector<const char*> words;
};

TEST(SceneErrors, PointAtThePlaceAndNameWhatIsRight) {
  ASSERT_TRUE(parse_scene(with_line(0, ""), "a.toml").has_value());
  const BadLine cases[] = {
      {1, "titel = 't'", 1, 1, {"titel", "did you mean 'title'"}},
      {1, "", 0, 0, {"needs the key 'title'"}},
      {2, "duration_s = -1", 2, 14, {"duration_s", "positive"}},
      {3, "gravity_mps2 = [0, -9.81]", 3, 16, {"three numbers, not 2"}},
      {3, "gravity_mps2 = [0, 0, nan]", 3, 0, {"finite"}},
      {3, "gravity_mps2 = -9.81", 3, 16, {"must be an array, not a number"}},
      {4, "overlaps = 'maybe'", 4, 12, {"maybe", "allowed, refused"}},
      {6,
       "edge_m = { default = 5, minimum = 0.1, maximum = 2, meaning = 'x' }",
       6,
       22,
       {"default = 5", "0.1 .. 2"}},
      {6, "edge_m = { default = 0.5, maximum = 2, meaning = 'x' }", 6, 0, {"'minimum'"}},
      {6, "edge_m = { default = 0.5, minimum = 0.1, maximum = 2 }", 6, 0, {"'meaning'"}},
      {6,
       "edge_m = { default = 0.5, minimum = 0.1, maximum = 2, units = 'm', meaning = 'x' }",
       6,
       55,
       {"units", "did you mean 'unit'"}},
      {6,
       "sin = { default = 0.5, minimum = 0.1, maximum = 2, meaning = 'x' }",
       6,
       1,
       {"'sin' is taken"}},
      {6,
       "step_s = { default = 0.5, minimum = 0.1, maximum = 2, meaning = 'x' }",
       6,
       1,
       {"'step_s' is taken"}},
      {7, "kind = { choices = ['loose'], meaning = 'x' }", 7, 0, {"two words or more"}},
      {7, "kind = { choices = ['a', 'b'], default = 'c', meaning = 'x' }", 7, 0, {"a, b"}},
      {9, "half_m = 'edge_n / 2'", 9, 11, {"edge_n", "did you mean 'edge_m'"}},
      {9, "half_m = '1 / 0'", 9, 10, {"half_m", "no finite value"}},
      {9, "edge_m = 1", 9, 1, {"'edge_m' is taken"}},
      {11, "friction = -0.5", 11, 12, {"friction = -0.5", "at least 0"}},
      {12, "restitution = 1.5", 12, 15, {"restitution = 1.5", "0 .. 1"}},
      {12, "bounce = 1", 12, 1, {"bounce"}},
      {12, "", 10, 1, {"needs the key 'restitution'"}},
      {14, "surfaces = ['ice', 'wod']", 14, 20, {"wod", "did you mean 'wood'"}},
      {14, "surfaces = ['ice']", 14, 12, {"two names"}},
      {18, "name = 'box_1'", 23, 8, {"two bodies", "box_1"}},
      {19, "shape = 'cone'", 19, 9, {"cone", "box, sphere, plane"}},
      {20, "fixed = false", 19, 9, {"a plane must be fixed"}},
      {20, "fixed = true\nvelocity_mps = [1, 0, 0]", 21, 16, {"never moves", "velocity_mps"}},
      {20, "fixed = true\nmass_kg = 1", 21, 11, {"never moves", "mass_kg"}},
      {23, "name = 'box_{j}'", 23, 13, {"knows no 'j'"}},
      {23, "name = 'box_{edge_m}'", 23, 8, {"no whole number"}},
      {23, "name = 'box_{k'", 23, 13, {"without }"}},
      {23, "nmae = 'box_{k}'", 23, 1, {"nmae", "did you mean 'name'"}},
      {25, "", 22, 1, {"a box needs the key 'size_m'"}},
      {25, "size_m = [1, 1, 'edge_m - 0.5']", 25, 10, {"positive"}},
      {25, "size_m = [1, 1, '1 + edge_m +']", 25, 0, {"formula ends"}},
      {25, "radius_m = 1\nsize_m = [1, 1, 1]", 25, 12, {"a box has no radius_m"}},
      {26, "", 22, 1, {"density_kgpm3", "mass_kg"}},
      {26, "mass_kg = 2\ndensity_kgpm3 = 1", 22, 1, {"one of"}},
      {26, "mass_kg = 0", 26, 11, {"positive"}},
      {26, "mass_kg = 2\ninertia_kgm2 = [1, 1, 5]", 22, 1, {"not that of a rigid body"}},
      {28, "quaternion = [1, 1, 0, 0]", 22, 1, {"length"}},
      {28, "quaternion = [1, 0, 0]", 28, 14, {"four numbers"}},
      {28, "turn = { axis = [0, 0, 0], angle_rad = 1 }", 28, 8, {"no direction"}},
      {28, "turn = { axis = [0, 0, 1] }", 28, 8, {"angle_rad"}},
      {28, "position_m = [0, 0, 0]", 22, 1, {"overlap by", "overlaps = \"allowed\""}},
      {29, "stack = { count = 2.5 }", 29, 19, {"whole number"}},
      {29, "stack = { count = -1 }", 29, 19, {"whole number"}},
      {29, "stack = { count = 1e9 }", 29, 19, {"whole number", "100000"}},
      {29,
       "stack = { count = 2 }\ngrid = { count = [1, 1, 1], pitch_m = [1, 1, 1] }",
       22,
       1,
       {"one of grid, stack and ring"}},
      {29, "stack = { count = 3 }\nwhen = 'k != 1'", 29, 9, {"leaves no copy out"}},
      {29, "grid = { count = [1, 1], pitch_m = [1, 1, 1] }", 29, 18, {"three numbers"}},
      {29, "grid = { count = 4, pitch_m = [1, 1, 1] }", 29, 18, {"an array"}},
      {29, "ring = { count = 3, radius_m = 1, axis = 'w' }", 29, 42, {"\"x\", \"y\" or \"z\""}},
      {29, "repeat = {}", 29, 10, {"names no index"}},
      {29, "repeat = { edge_m = 2 }", 29, 12, {"is taken"}},
      {30, "role = 'wall'", 30, 8, {"wall", "brick, projectile, none"}},
      {32, "body = 'box_2'", 32, 8, {"no body 'box_2'", "box_1"}},
      {32, "body = 'ground'", 32, 8, {"fixed"}},
      {33, "time_s = -1", 33, 10, {"before the start"}},
      {34, "", 31, 1, {"impulse_ns or angular_impulse_nms"}},
      {37, "", 35, 1, {"force_n or torque_nm"}},
      {38, "times_s = [1, 0]", 35, 1, {"ascend"}},
      {38, "times_s = [0, 1, 2]", 39, 10, {"3 and 2"}},
      {38, "", 35, 1, {"go together"}},
      {38, "from_s = 1\ntimes_s = [0, 1]", 35, 1, {"not both"}},
  };
  for (const BadLine& bad : cases) {
    const auto scenario = parse_scene(with_line(bad.line, bad.text), "a.toml");
    ASSERT_FALSE(scenario) << bad.text;
    const std::string text = scenario.error().text();
    EXPECT_EQ(scenario.error().at.file, "a.toml") << text;
    EXPECT_EQ(scenario.error().at.line, bad.at) << bad.text << "\n  " << text;
    if (bad.column > 0) {
      EXPECT_EQ(scenario.error().at.column, bad.column) << bad.text << "\n  " << text;
    }
    for (const char* word : bad.words) {
      EXPECT_NE(text.find(word), std::string::npos) << "'" << word << "' not in: " << text;
    }
  }
}

// What is fine at the defaults and wrong elsewhere is told when it is built there.
TEST(SceneErrors, OfOtherValuesAreLocatedToo) {
  const auto scenario =
      parse_scene(with_line(28, "position_m = [0, 0, '0.25 + (0.5 - edge_m)']"), "a.toml");
  ASSERT_TRUE(scenario);
  const auto scene = build(*scenario, {{"edge_m", 1.0}});
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().fault, Fault::invalid);
  EXPECT_NE(scene.error().reason.find("a.toml:22:1: "), std::string::npos) << scene.error().reason;
}

TEST(SceneErrors, NameTheFileThatIsNotThere) {
  const auto scenario = read_scene("no/such/file.toml");
  ASSERT_FALSE(scenario);
  EXPECT_NE(scenario.error().text().find("no/such/file.toml"), std::string::npos);
  const auto named = parse_scene(with_line(0, ""), "2 words.toml");
  ASSERT_FALSE(named);
  EXPECT_NE(named.error().text().find("2 words"), std::string::npos) << named.error().text();
}

}  // namespace
}  // namespace brickbench
