// Every scene: its parameters, its defaults, and what it answers to bad ones.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "experiments/scenarios/nearest_name.hpp"
#include "tests/support/tolerance.hpp"
#include "tests/unit/scenarios/scene_checks.hpp"

namespace brickbench {
namespace {

using namespace brickbench::testing;

// Values in which a parameter shows that does nothing at the defaults.
ParameterValues setting_for(const std::string& scenario, const std::string& parameter) {
  if (scenario == "explosion" && parameter == "profile") return {{"count_x", 4.0}};
  if (scenario == "assembly" && parameter == "lean") return {{"arrangement", std::string("stack")}};
  if (scenario == "incline" && parameter == "heading_rad") return {{"speed_mps", 2.0}};
  if (parameter == "half_bricks") return {{"courses", 4.0}};
  return {};
}

// A value in range other than the default, small steps first so that the scene stays possible.
ParameterValue other_value(const Parameter& parameter) {
  if (parameter.kind == ParameterKind::choice) return parameter.choices.back();
  const double x = std::get<double>(parameter.default_value);
  if (parameter.kind == ParameterKind::boolean) return 1.0 - x;
  if (parameter.kind == ParameterKind::integer)
    return x + 1.0 <= parameter.maximum ? x + 1.0 : x - 1;
  const double step = x == 0.0 ? 0.01 : 0.05 * std::abs(x);
  return x + step <= parameter.maximum ? x + step : x - step;
}

TEST(Parameters, EveryOneChangesItsScene) {
  for (const Scenario& scenario : scenarios()) {
    for (const Parameter& parameter : scenario.parameters) {
      ParameterValues values = setting_for(scenario.name, parameter.name);
      const std::string before = image(built(scenario.name, values));
      values[parameter.name] = other_value(parameter);
      EXPECT_NE(before, image(built(scenario.name, values)))
          << scenario.name << "." << parameter.name;
    }
  }
}

TEST(Parameters, AreNamedDescribedAndInRange) {
  std::set<std::string> scenes;
  for (const Scenario& scenario : scenarios()) {
    EXPECT_TRUE(scenes.insert(scenario.name).second) << scenario.name << " twice";
    EXPECT_FALSE(scenario.meaning.empty()) << scenario.name;
    EXPECT_GT(scenario.duration_s, 0.0) << scenario.name;
    std::set<std::string> names;
    for (const Parameter& parameter : scenario.parameters) {
      const std::string id = scenario.name + "." + parameter.name;
      EXPECT_TRUE(names.insert(parameter.name).second) << id << " twice";
      EXPECT_FALSE(parameter.meaning.empty()) << id;
      EXPECT_FALSE(parameter.unit.empty()) << id;
      // Given explicitly, a default passes the same checks as any other value.
      EXPECT_TRUE(complete(scenario, {{parameter.name, parameter.default_value}}).has_value())
          << id;
    }
  }
}

TEST(Parameters, TheEndsOfEachRangeAreInAndBeyondIsOut) {
  for (const Scenario& scenario : scenarios()) {
    for (const Parameter& parameter : scenario.parameters) {
      if (parameter.kind == ParameterKind::choice) continue;
      const double inf = std::numeric_limits<double>::infinity();
      const auto fits = [&](double x) {
        return complete(scenario, {{parameter.name, x}}).has_value();
      };
      const bool good = fits(parameter.minimum) && fits(parameter.maximum);
      const bool bad = fits(std::nextafter(parameter.minimum, -inf)) ||
                       fits(std::nextafter(parameter.maximum, inf)) || fits(inf) ||
                       fits(std::numeric_limits<double>::quiet_NaN());
      EXPECT_TRUE(good && !bad) << scenario.name << "." << parameter.name;
    }
  }
}

TEST(Parameters, BadInputIsNamedWithWhatIsAllowed) {
  struct Case {
    const char* scenario;
    ParameterValues values;
    std::vector<const char*> words;
  };
  const Case cases[] = {
      {"brick_wall", {{"frictoin", 0.5}}, {"frictoin", "did you mean 'friction'"}},
      {"brick_wall", {{"column", 3.0}}, {"did you mean 'columns'"}},
      {"brick_wall", {{"courses", 0.0}}, {"courses", "0", "1 .. 200"}},
      {"brick_wall", {{"courses", 2.5}}, {"courses", "2.5", "whole number"}},
      {"brick_wall", {{"density_kgpm3", -5.0}}, {"density_kgpm3", "-5", "kg/m3"}},
      {"brick_wall", {{"brick_length_m", 0.0}}, {"brick_length_m", "0.001 .. 10"}},
      {"brick_wall", {{"half_bricks", 0.5}}, {"half_bricks", "whole number"}},
      {"brick_wall", {{"friction", std::string("high")}}, {"friction", "number", "high"}},
      {"brick_wall", {{"bond", 1.0}}, {"bond", "word", "running, stack"}},
      {"brick_wall", {{"bond", std::string("stak")}}, {"stak", "did you mean 'stack'"}},
      {"brick_wall", {{"restitution", 1.5}}, {"restitution", "0 .. 1"}},
      {"brick_wall", {{"projectile_distance_m", 0.05}}, {"inside the wall", "at least 0.1"}},
      {"brick_wall", {{"projectile_above_middle_m", -0.48}}, {"inside the ground"}},
      {"brick_wall", {{"head_joint_gap_m", 0.1}}, {"head_joint_gap_m", "0.1"}},
      {"brick_wall",
       {{"half_bricks", 0.0}, {"courses", 11.0}},
       {"racked-back", "10 courses", "11"}},
      {"tower", {{"offset_m", 0.2}}, {"offset_m", "0.2"}},
      {"two_bricks", {{"b_speed_mps", 6.0}}, {"b_speed_mps", "part"}},
      {"explosion", {{"count_x", 1.0}, {"count_y", 1.0}, {"count_z", 1.0}}, {"driven apart", "2"}},
      {"explosion",
       {{"count_x", 100.0}, {"count_y", 100.0}, {"count_z", 100.0}},
       {"1000000", "20000"}},
  };
  for (const Case& test : cases) {
    const std::string reason = refusal(test.scenario, test.values);
    EXPECT_NE(reason.find(test.scenario), std::string::npos) << reason;
    for (const char* word : test.words) {
      EXPECT_NE(reason.find(word), std::string::npos) << "'" << word << "' not in: " << reason;
    }
  }
}

TEST(Parameters, CompleteFillsInEveryDefaultAndKeepsWhatIsGiven) {
  const Scenario wall = scenario_named("brick_wall");
  const auto values = complete(wall, {{"courses", 3.0}});
  ASSERT_TRUE(values.has_value());
  EXPECT_EQ(values->size(), wall.parameters.size());
  EXPECT_EQ(number(*values, "courses"), 3.0);
  EXPECT_EQ(word(*values, "bond"), "running");
}

// Centres and half edges are rounded once each, at coordinates below 2 m.
constexpr Tolerance k_touching = {"overlap of touching bodies (m)", 2e-15, 1.4e-16,
                                  "a few ulp of 1 m"};

TEST(Scenes, StartWithoutOverlapAndAreTheSameEachTime) {
  Worst worst;
  for (const Scenario& scenario : scenarios()) {
    const Scene scene = built(scenario.name);
    std::string where;
    if (scene.world.bodies.size() > 1) {
      const double overlap_m = std::max(0.0, deepest_overlap_m(scene.world, where));
      worst.see(overlap_m, scenario.name + ": " + where);
    }
    EXPECT_EQ(image(scene), image(built(scenario.name))) << scenario.name;
  }
  EXPECT_TRUE(worst.within(k_touching));
}

TEST(Scenes, NumberTheGroundFirstThenTheBricksThenTheProjectile) {
  for (const Scenario& scenario : scenarios()) {
    const Scene scene = built(scenario.name);
    std::vector<std::size_t> order;
    std::set<std::string> names;
    for (std::size_t i = 0; i < scene.world.bodies.size(); ++i) {
      if (scene.world.bodies[i].fixed) order.push_back(i);
      EXPECT_TRUE(names.insert(scene.world.bodies[i].name).second) << scene.world.bodies[i].name;
    }
    order.insert(order.end(), scene.bricks.begin(), scene.bricks.end());
    order.insert(order.end(), scene.projectiles.begin(), scene.projectiles.end());
    std::vector<std::size_t> expected(scene.world.bodies.size());
    for (std::size_t i = 0; i < expected.size(); ++i) expected[i] = i;
    EXPECT_EQ(order, expected) << scenario.name;
  }
}

TEST(NearestName, CountsEditsAndTakesTheFirstOfEquals) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  const std::vector<std::string> known = {"bat", "cat", "house"};
  EXPECT_EQ(nearest_name("rat", known), "bat");
  EXPECT_EQ(nearest_name("hose", known), "house");
  EXPECT_EQ(nearest_name("x", {}), "");
  const std::vector<std::string> keys = {"friction", "restitution", "brick_length_m",
                                         "drop_height_m", "step_s"};
  EXPECT_EQ(nearest_name("brick_size", keys), "brick_length_m") << "shares a word";
  EXPECT_EQ(nearest_name("height", keys), "drop_height_m") << "is a part";
  EXPECT_EQ(nearest_name("steps", keys), "step_s") << "a slip comes before a shared word";
}

}  // namespace
}  // namespace brickbench
