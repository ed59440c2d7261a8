// What touches, overlaps and is suspicious at the start of a scene.
#include "experiments/scenes/scene_facts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "adapters/seam/shape.hpp"

namespace brickbench {
namespace {

using Eigen::Vector3d;

Body box_at(const std::string& name, const Vector3d& size_m, const Vector3d& position_m) {
  State at;
  at.position_m = position_m;
  return solid_body(name, BoxShape{0.5 * size_m}, 1000.0, at);
}

Body ball_at(const std::string& name, double radius_m, const Vector3d& position_m) {
  State at;
  at.position_m = position_m;
  return solid_body(name, SphereShape{radius_m}, 1000.0, at);
}

Scene scene_with(std::vector<Body> bodies) {
  Scene scene;
  scene.world.bodies = std::move(bodies);
  return scene;
}

std::vector<std::string> kinds(const Scene& scene, std::optional<double> step_s = std::nullopt) {
  std::vector<std::string> found;
  for (const Doubt& doubt : doubts(scene, step_s)) {
    found.push_back(doubt.kind);
    EXPECT_GT(doubt.value, doubt.limit) << doubt.text;
    EXPECT_FALSE(doubt.text.empty());
  }
  return found;
}

using Kinds = std::vector<std::string>;

TEST(SceneFacts, TellTouchingFromApartAndFromOverlapping) {
  for (const double gap_m : {-0.01, -1e-6, -1e-12, 0.0, 1e-12, 1e-6, 0.01}) {
    const Scene scene =
        scene_with({ground_plane(), box_at("low", {0.2, 0.2, 0.2}, {0, 0, 0.1}),
                    box_at("high", {0.2, 0.2, 0.2}, {0.05, 0, 0.3 + gap_m}),
                    ball_at("ball", 0.1, {-0.3, 0, 0.1 + gap_m}), ball_at("far", 0.1, {5, 0, 3})});
    const auto touches = touches_at_start(scene.world);
    const bool apart = gap_m > 1e-7;
    ASSERT_EQ(touches.size(), apart ? 1u : 3u) << gap_m;
    EXPECT_EQ(touches[0].body_b, 1u) << "the box on the ground";
    EXPECT_FALSE(touches[0].overlap);
    if (apart) continue;
    for (std::size_t i = 1; i < 3; ++i) {
      EXPECT_EQ(touches[i].overlap, gap_m < -1e-7) << gap_m;
      EXPECT_NEAR(touches[i].depth_m, std::max(0.0, -gap_m), 1e-15);
      EXPECT_FALSE(touches[i].inside);
    }
  }
}

TEST(SceneFacts, SeeBodiesInsideOthersOfEveryShape) {
  const Body large_box = box_at("large", {1, 1, 1}, {0, 0, 2});
  const Body large_ball = ball_at("large", 0.6, {0, 0, 2});
  for (const Body& outer : {large_box, large_ball}) {
    for (const double shift_m : {0.0, 0.3, 0.48, 0.6, 0.7}) {
      for (Body inner : {box_at("inner", {0.1, 0.1, 0.1}, {shift_m, 0, 2}),
                         ball_at("inner", 0.05, {shift_m, 0, 2})}) {
        inner.initial.orientation = Eigen::AngleAxisd(0.3, Vector3d::UnitX());
        const Scene scene = scene_with({outer, inner});
        const auto touches = touches_at_start(scene.world);
        // The box's face is at 0.5 m, the ball's surface at 0.6 m.
        const bool round = is_round(outer.shape);
        const bool within = shift_m < (round ? 0.5 : 0.4);
        const bool meets = shift_m < (round ? 0.65 : 0.55);
        ASSERT_EQ(touches.size(), meets ? 1u : 0u) << shift_m;
        if (meets) {
          EXPECT_EQ(touches[0].inside, within) << shift_m;
        }
      }
    }
  }
  const Scene below = scene_with({ground_plane(), ball_at("ball", 0.1, {0, 0, -0.2})});
  EXPECT_TRUE(touches_at_start(below.world)[0].inside);
  const Scene half = scene_with({ground_plane(), ball_at("ball", 0.1, {0, 0, -0.05})});
  EXPECT_FALSE(touches_at_start(half.world)[0].inside);
}

TEST(SceneDoubts, AreNoneOfASoundScene) {
  const Scene sound = scene_with({ground_plane(), box_at("a", {0.2, 0.1, 0.1}, {0, 0, 0.05}),
                                  box_at("b", {0.2, 0.1, 0.1}, {0, 0, 0.15})});
  EXPECT_EQ(kinds(sound, 0.01), Kinds{});
}

TEST(SceneDoubts, NameWhatNoBodyCanBe) {
  // One block of a published file: 15 cm, 50 g, and an inertia of 1 kg m2.
  Body block = box_at("block", {0.15, 0.05, 0.03}, {0, 0, 1});
  block.mass_kg = 0.05;
  block.inertia_kgm2 = Vector3d::Ones();
  const auto found = doubts(scene_with({block}), std::nullopt);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, "inertia");
  EXPECT_EQ(found[0].value, 1.0);
  EXPECT_LT(found[0].limit, 1e-3);
  // A hollow block is possible, and is said not to be the solid one.
  Body hollow = box_at("hollow", {0.1, 0.1, 0.1}, {0, 0, 1});
  hollow.inertia_kgm2 *= 1.5;
  EXPECT_EQ(kinds(scene_with({hollow})), Kinds{"not_solid"});
  hollow.inertia_kgm2 *= 2.1;  // of three: all mass in the corners
  EXPECT_EQ(kinds(scene_with({hollow})), Kinds{"inertia"});
  Body shell = ball_at("shell", 0.1, {0, 0, 1});
  shell.inertia_kgm2 *= 5.0 / 3.0;
  EXPECT_EQ(kinds(scene_with({shell})), Kinds{"not_solid"});
}

TEST(SceneDoubts, NameRatiosOverlapsAndSteps) {
  const Body small = box_at("small", {0.1, 0.1, 0.1}, {0, 0, 1});
  Body heavy = box_at("heavy", {0.1, 0.1, 0.1}, {0, 0, 2});
  heavy.mass_kg *= 99.0;
  heavy.inertia_kgm2 *= 99.0;
  EXPECT_EQ(kinds(scene_with({small, heavy})), Kinds{});
  heavy.mass_kg *= 1.1;
  heavy.inertia_kgm2 *= 1.1;
  EXPECT_EQ(kinds(scene_with({small, heavy})), Kinds{"mass_ratio"});
  Body sheet = box_at("sheet", {2.0, 0.1, 0.001}, {0, 0, 3});
  EXPECT_EQ(kinds(scene_with({sheet})), Kinds{"size_ratio"});
  const Scene deep = scene_with({small, box_at("other", {0.1, 0.1, 0.1}, {0, 0, 1.08}),
                                 box_at("third", {0.1, 0.1, 0.1}, {0, 0.07, 1})});
  const auto found = doubts(deep, std::nullopt);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_NEAR(found[0].value, 0.03, 1e-15) << "the worst first";
  Body fast = small;
  fast.initial.velocity_mps = {0, 30, 40};
  const Scene thrown = scene_with({fast});
  EXPECT_DOUBLE_EQ(longest_step_s(thrown), 0.001);
  EXPECT_EQ(kinds(thrown, 0.0009), Kinds{});
  EXPECT_EQ(kinds(thrown, 0.0011), Kinds{"step"});
  Scene struck = scene_with({small});
  EXPECT_TRUE(std::isinf(longest_step_s(struck)));
  struck.blows.push_back({.body = 0, .impulse_ns = {50.0 * small.mass_kg, 0, 0}});
  EXPECT_DOUBLE_EQ(longest_step_s(struck), 0.001);
}

}  // namespace
}  // namespace brickbench
