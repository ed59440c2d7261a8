// Draws: they depend on seed and number alone, stay in range, and reach everything.
#include "experiments/hunt/draw.hpp"

#include <gtest/gtest.h>

#include <set>

#include "experiments/hunt/extent.hpp"

namespace brickbench::hunt {
namespace {

constexpr std::uint64_t k_cases = 400;

Catalogues scene_catalogues() {
  Catalogues catalogues;
  catalogues.scenarios = scenarios();
  return catalogues;
}

TEST(Draw, IsTheSameForTheSameSeedAndNumberAndElseAnother) {
  const auto all = scenarios();
  std::set<std::string> labels;
  for (std::uint64_t k = 0; k < k_cases; ++k) {
    const auto trial = draw_scene(all, 7, k);
    ASSERT_TRUE(trial.has_value()) << k;
    EXPECT_EQ(*trial, *draw_scene(all, 7, k));
    labels.insert(label(*trial));
  }
  // Calm draws of one scene may be alike.
  EXPECT_GT(labels.size(), k_cases * 9 / 10);
  EXPECT_NE(label(*draw_scene(all, 7, 0)), label(*draw_scene(all, 8, 0)));
}

TEST(Draw, MakesScenesWithinTheLimits) {
  const Catalogues catalogues = scene_catalogues();
  const DrawLimits limits;
  for (std::uint64_t k = 0; k < k_cases; ++k) {
    const auto trial = draw_scene(catalogues.scenarios, 1, k, limits);
    ASSERT_TRUE(trial.has_value()) << k;
    const auto scene = scene_of(*trial, catalogues);
    ASSERT_TRUE(scene.has_value()) << label(*trial) << ": " << scene.error().reason;
    EXPECT_LE(moving_count(scene->world), limits.bodies) << label(*trial);
    EXPECT_GE(trial->steps, limits.fewest_steps);
    EXPECT_LE(trial->steps, limits.most_steps);
    EXPECT_GE(trial->step_s, 1e-5);
    EXPECT_LE(trial->step_s, 1.0 / 60);
  }
}

TEST(Draw, ReachesEverySceneAndBothEndsOfRestitution) {
  std::set<std::string> scenes;
  std::set<double> restitutions;
  for (std::uint64_t k = 0; k < k_cases; ++k) {
    const auto trial = draw_scene(scenarios(), 3, k);
    ASSERT_TRUE(trial.has_value());
    scenes.insert(trial->scene);
    const auto e = trial->parameters.find("restitution");
    restitutions.insert(e == trial->parameters.end() ? 0.0 : std::get<double>(e->second));
  }
  EXPECT_EQ(scenes.size(), scenarios().size());
  EXPECT_TRUE(restitutions.contains(0.0));
  EXPECT_TRUE(restitutions.contains(1.0));
  EXPECT_GT(restitutions.size(), 20u);
}

}  // namespace
}  // namespace brickbench::hunt
