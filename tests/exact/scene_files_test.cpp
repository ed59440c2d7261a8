// The shipped scene files: all are sound, and where the motion has a closed form, our engine's is
// it.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "adapters/catalog.hpp"
#include "adapters/seam/shape.hpp"
#include "experiments/scenes/scene_facts.hpp"
#include "experiments/scenes/scene_file.hpp"
#include "experiments/step/stepper.hpp"
#include "tests/support/tolerance.hpp"

namespace brickbench {
namespace {

using Eigen::Vector3d;
using testing::Tolerance;
using testing::Worst;

constexpr double k_g = 9.81;
constexpr double k_step_s = 0.001;

Scenario shipped(const std::string& name) {
  auto scenario = read_scene("experiments/scenes/" + name + ".toml");
  if (scenario) return *std::move(scenario);
  ADD_FAILURE() << scenario.error().text();
  return {};
}

const Adapter& own_adapter() {
  static const std::vector<Adapter> all = adapters();
  return *std::ranges::find(all, true, &Adapter::own);
}

// A run of a scene in our engine's default variant.
class SceneRun {
 public:
  explicit SceneRun(const std::string& name, const ParameterValues& values = {},
                    double step_s = k_step_s)
      : scene_(build(shipped(name), values).value()) {
    const Adapter& adapter = own_adapter();
    Settings settings;
    settings.step_s = step_s;
    settings.variant = adapter.variants.front().name;
    auto started = Stepper::start(adapter, scene_, settings);
    if (started) {
      stepper_.emplace(*std::move(started));
    } else {
      ADD_FAILURE() << name << ": " << started.error().reason;
    }
  }

  void until(double time_s) {
    while (stepper_ && stepper_->time_s() < time_s - 0.5 * k_step_s) {
      const auto stepped = stepper_->advance();
      if (!stepped) {
        ADD_FAILURE() << stepped.error().reason;
        return;
      }
    }
  }

  const World& world() const { return scene_.world; }
  std::size_t index(const std::string& body) const {
    const auto found = std::ranges::find(world().bodies, body, &Body::name);
    return static_cast<std::size_t>(found - world().bodies.begin());
  }
  const State& of(const std::string& body) const { return stepper_->states()[index(body)]; }
  std::span<const State> states() const { return stepper_->states(); }

  // The farthest that any body is from where it started (m).
  double farthest_m() const {
    double farthest = 0.0;
    for (std::size_t i = 0; i < world().bodies.size(); ++i) {
      farthest = std::max(farthest,
                          (states()[i].position_m - world().bodies[i].initial.position_m).norm());
    }
    return farthest;
  }

 private:
  Scene scene_;
  std::optional<Stepper> stepper_;
};

TEST(SceneFiles, AreAllSound) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("experiments/scenes")) {
    if (entry.path().extension() != ".toml") continue;
    ++count;
    const auto scenario = read_scene(entry.path());
    ASSERT_TRUE(scenario) << scenario.error().text();
    const Scene scene = build(*scenario, {}).value();
    for (const Doubt& doubt : doubts(scene, k_step_s)) {
      // What the file is about.
      const bool meant = (doubt.kind == "overlap" && scenario->name == "sunk_boxes") ||
                         (doubt.kind == "overlap" && scenario->name == "rolling_balls");
      EXPECT_TRUE(meant) << scenario->name << ": " << doubt.text;
    }
    for (const Parameter& parameter : scenario->parameters) {
      EXPECT_FALSE(parameter.meaning.empty());
      if (parameter.kind == ParameterKind::choice) continue;
      // Small ends make scenes too; large ones are too large for a test.
      const auto small = build(*scenario, {{parameter.name, parameter.minimum}});
      EXPECT_TRUE(small || small.error().reason.find("overlap") != std::string::npos)
          << parameter.name << ": " << small.error().reason;
    }
  }
  EXPECT_GE(count, 11u);
}

constexpr Tolerance k_sliding = {"speed of sliding boxes (m/s)", 1e-5, 8.6e-7,
                                 "what the solver leaves of the law in each of 500 steps"};

TEST(SceneFiles, BoxesSlideAsCoulombSays) {
  Worst worst;
  for (const double force_n : {40.0, 80.0, 200.0}) {
    SceneRun run("pushed_box", {{"force_n", force_n}});
    run.until(0.5);
    const double a = std::max(0.0, force_n / 10.0 - 0.5 * k_g);
    worst.see(run.of("box").velocity_mps.x() - 0.5 * a, "pushed box");
  }
  {
    SceneRun run("pushed_box", {{"ramp_s", 0.4}, {"force_n", 100.0}});
    run.until(0.5);
    // It starts when the force has grown to the friction, at 0.4 mu m g / F.
    const double a = 10.0 - 0.5 * k_g;
    const double start_s = 0.4 * 0.5 * k_g / 10.0;
    worst.see(run.of("box").velocity_mps.x() - (0.5 * a * (0.4 - start_s) + a * 0.1), "ramp");
  }
  for (const double lean : {0.2, 0.6, 1.0}) {
    SceneRun run("tilted_gravity", {{"lean_rad", lean}});
    run.until(0.5);
    const double a = std::max(0.0, k_g * (std::sin(lean) - 0.3 * std::cos(lean)));
    worst.see(run.of("box").velocity_mps.x() - 0.5 * a, "leaning gravity");
  }
  SceneRun run("mixed_boxes");
  run.until(0.5);
  const double mu[] = {0.0, 0.1, 0.3, 0.5, 0.8, 1.2};
  for (std::size_t i = 0; i < 6; ++i) {
    const double a = std::max(0.0, k_g * (std::sin(0.4) - mu[i] * std::cos(0.4)));
    const State& box = run.of("box_" + std::to_string(i));
    worst.see(box.velocity_mps.norm() - 0.5 * a, "box_" + std::to_string(i));
  }
  EXPECT_TRUE(worst.within(k_sliding));
}

constexpr Tolerance k_rolling = {"speeds of box and balls (m/s)", 4e-8, 2.3e-9,
                                 "what the solver leaves of the law in each of 500 steps"};

// Friction of the ground holds back the weight of all; a ball that rolls without sliding on a box
// of acceleration a has 2/7 a, and holds the box back with 2/7 m a.
TEST(SceneFiles, BallsRollOnTheDraggedBox) {
  Worst worst;
  for (const double heading : {0.0, 1.0471975511965976}) {
    SceneRun run("rolling_balls", {{"heading_rad", heading}, {"sunk_m", 0.0}});
    run.until(0.5);
    const double a = (150.0 - 0.4 * 35.0 * k_g) / (10.0 + 25.0 * 2.0 / 7.0);
    const Vector3d along(std::sin(heading), std::cos(heading), 0.0);
    worst.see((run.of("box").velocity_mps - 0.5 * a * along).norm(), "box");
    for (std::size_t i = 2; i < run.world().bodies.size(); ++i) {
      worst.see((run.states()[i].velocity_mps - 0.5 * 2.0 / 7.0 * a * along).norm(),
                run.world().bodies[i].name);
    }
  }
  EXPECT_TRUE(worst.within(k_rolling));
}

constexpr Tolerance k_standing = {"way of what stands (m)", 2e-12, 1.1e-13,
                                  "rounding at coordinates of 1000 m"};

TEST(SceneFiles, WhatStandsStands) {
  Worst worst;
  for (const char* name : {"stair", "round_tower", "far_stack"}) {
    SceneRun run(name, {}, 0.005);
    run.until(0.5);
    worst.see(run.farthest_m(), name);
  }
  EXPECT_TRUE(worst.within(k_standing));
}

TEST(SceneFiles, DominoesFallOneAfterTheOther) {
  SceneRun run("domino_row", {{"count", 4.0}});
  run.until(0.6);
  for (const char* name : {"domino_0", "domino_1", "domino_2", "domino_3"}) {
    const double upright = (run.of(name).orientation * Vector3d::UnitZ()).z();
    EXPECT_LT(upright, 0.9) << name;
  }
}

}  // namespace
}  // namespace brickbench
