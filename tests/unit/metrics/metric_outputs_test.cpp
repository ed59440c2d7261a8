// The remaining metrics on runs known by heart, what every metric owes, and the documentation.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>

#include "experiments/metrics/outputs.hpp"
#include "tests/unit/metrics/metric_runs.hpp"

namespace brickbench::testing {
namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

TEST(EveryMetric, SaysNothingAfterANumberThatIsNone) {
  std::string silent;
  for (const char* name :
       {"energy", "momentum", "penetration", "displaced", "outcomes", "projectile"}) {
    SyntheticRun run = free_flight();
    run.states = [exact = run.states](std::size_t step) {
      auto states = exact(step);
      if (step == 7) states[0].velocity_mps.x() = k_nan;  // one step only: the end looks well
      return states;
    };
    for (const Measurement& one : measure(name, run)) {
      if (std::isnan(one.value) && one.note == "not finite: body 'light' at 0.007 s") continue;
      silent += one.name + " ";
    }
  }
  EXPECT_EQ(silent, "");
}

TEST(EveryMetric, RefusesAQuaternionThatIsNoRotation) {
  SyntheticRun run = free_flight();
  run.states = [exact = run.states](std::size_t step) {
    auto states = exact(step);
    states[1].orientation.coeffs() *= 0.9;
    return states;
  };
  EXPECT_TRUE(std::isnan(value(measure("energy", run), "energy_created_j")));
}

// The quick answer for almost every state is never another one than that of the definition.
TEST(StateGuard, AdmitsWhatIsFiniteAndARotation) {
  constexpr double huge = std::numeric_limits<double>::max();
  World world;
  world.bodies = {solid_body("b", SphereShape{0.5}, 1.0)};
  const auto admits = [&](const State& state) {
    StateGuard guard(world);
    Sample sample;
    sample.states = {&state, 1};
    return guard.admits(sample);
  };
  std::string wrong;
  for (int place = 0; place < 13; ++place) {
    for (const double value : {huge, -huge, 1.0, -0.0, HUGE_VAL, -HUGE_VAL, std::nan("")}) {
      State state;
      double* const groups[] = {state.position_m.data(), state.velocity_mps.data(),
                                state.angular_velocity_radps.data()};
      if (place < 9) {
        groups[place / 3][place % 3] = value;
        if (std::isfinite(value)) groups[place / 3][(place + 1) % 3] = value;
      } else {
        state.orientation.coeffs().setZero();
        state.orientation.coeffs()[place - 9] = value;
      }
      const bool expected =
          place < 9 ? std::isfinite(value) : std::abs(std::abs(value) - 1.0) <= 0.01;
      if (admits(state) != expected) wrong = "place " + std::to_string(place);
    }
  }
  for (int step = -200; step <= 200; ++step) {
    const double length = 1.0 + 1e-4 * (step + 0.5);
    State state;
    state.orientation.coeffs() = length * Eigen::Vector4d(0.5, -0.5, 0.5, 0.5);
    if (admits(state) != (std::abs(length - 1.0) <= 0.01)) {
      wrong = "length " + std::to_string(length);
    }
  }
  EXPECT_EQ(wrong, "");
}

TEST(EveryMetric, ReportsExactlyWhatItDeclares) {
  std::set<std::string> names;
  for (const MetricInfo& info : metrics()) {
    const auto reported = measure(info.name, free_flight());
    ASSERT_EQ(reported.size(), info.outputs.size()) << info.name;
    for (std::size_t i = 0; i < reported.size(); ++i) {
      EXPECT_EQ(reported[i].name, info.outputs[i].name);
      EXPECT_EQ(reported[i].unit, info.outputs[i].unit);
      EXPECT_TRUE(std::isfinite(reported[i].value) || !applies(reported[i])) << reported[i].name;
    }
    const auto watcher = info.make(free_flight().scene, 0.001);
    const auto states = free_flight().states(0);
    watcher->observe(
        {.step = 0, .time_s = 0.0, .states = states, .wrenches = {}, .diagnostics = {}});
    std::vector<Measurement> curves;
    watcher->trace(curves);
    ASSERT_EQ(curves.size(), info.curves.size()) << info.name;
    for (const auto* list : {&info.outputs, &info.curves}) {
      for (const OutputInfo& output : *list) {
        EXPECT_TRUE(names.insert(output.name).second) << output.name << " is there twice";
        EXPECT_FALSE(output.meaning.empty() || output.good.empty() || output.unit.empty())
            << output.name;
      }
    }
  }
}

TEST(EveryMetric, IsDocumented) {
  std::ifstream file("docs/metrics.md");
  ASSERT_TRUE(file) << "docs/metrics.md is not there";
  std::stringstream text;
  text << file.rdbuf();
  const std::string page = text.str();
  std::string missing;
  for (const MetricInfo& info : metrics()) {
    if (page.find("\n## " + info.name + "\n") == std::string::npos)
      missing += "## " + info.name + " ";
    for (const auto* list : {&info.outputs, &info.curves}) {
      for (const OutputInfo& output : *list) {
        const std::string entry = "| `" + output.name + "` | " + output.unit + " |";
        if (page.find(entry) == std::string::npos) missing += output.name + " ";
      }
    }
  }
  EXPECT_EQ(missing, "");
}

// Three bricks; the last two leave by 3 cm and 9 cm of an edge of 10 cm.
TEST(Displaced, CountsBeyondHalfTheSmallestEdge) {
  SyntheticRun run{
      .scene = scene_of({test_brick("a"), test_brick("b", {1, 0, 0}), test_brick("c", {2, 0, 0})},
                        {0, 0, 0}),
      .steps = 1};
  run.states = [start = initial_states(run.scene)](std::size_t step) {
    auto states = start;
    if (step == 0) return states;
    states[1].position_m.y() += 0.03;
    states[2].position_m.z() -= 0.09;
    states[2].velocity_mps = {0, 3, 0};
    return states;
  };
  const auto found = measure("displaced", run);
  EXPECT_EQ(value(found, "bricks_displaced"), 1.0);
  EXPECT_NEAR(value(found, "brick_displacement_max_m"), 0.09, 1e-15);
  EXPECT_NEAR(value(found, "brick_displacement_mean_m"), 0.04, 1e-15);
  EXPECT_NEAR(value(found, "brick_speed_rms_mps"), std::sqrt(3.0), 1e-15);
  run.scene.bricks.clear();
  EXPECT_FALSE(applies(find(measure("displaced", run), "bricks_displaced")));
}

TEST(Displaced, NoticesSwappedBricksAndHalfGravity) {
  SyntheticRun run{.scene = scene_of({test_brick("a"), test_brick("b", {1, 0, 0})}, {0, 0, 0})};
  run.states = [start = initial_states(run.scene)](std::size_t step) {
    auto states = start;
    if (step > 0) std::swap(states[0], states[1]);
    return states;
  };
  EXPECT_EQ(value(measure("displaced", run), "bricks_displaced"), 2.0);
  EXPECT_NE(value(measure("displaced", free_flight()), "brick_displacement_max_m"),
            value(measure("displaced", free_flight(0.5)), "brick_displacement_max_m"));
}

TEST(Projectile, FollowsAParabola) {
  const auto found = measure("projectile", free_flight());
  const double v_z = 4.0 - 0.981;
  EXPECT_NEAR(value(found, "projectile_run_out_m"), 0.3, 1e-15);
  EXPECT_NEAR(value(found, "projectile_speed_mps"), std::hypot(3.0, v_z), 1e-14);
  EXPECT_NEAR(value(found, "projectile_kinetic_energy_j"), 9.0 + v_z * v_z + 12.5 * 0.02 / 6,
              1e-13);
  EXPECT_GT(value(measure("projectile", free_flight(0.5)), "projectile_speed_mps"),
            value(found, "projectile_speed_mps") + 0.1);
  SyntheticRun none = free_flight();
  none.scene.projectiles.clear();
  EXPECT_FALSE(applies(find(measure("projectile", none), "projectile_speed_mps")));
}

TEST(Contacts, CountsAndPassesDiagnosticsOn) {
  SyntheticRun run = free_flight();
  run.steps = 4;
  run.contacts = [](std::size_t step) { return std::vector<Contact>(step == 3 ? 8 : 4); };
  run.diagnostics = {{"residual_mps", "m/s", 0.25}};
  const auto found = measure("contacts", run);
  EXPECT_EQ(value(found, "contacts_mean"), 5.0);
  EXPECT_EQ(value(found, "contacts_max"), 8.0);
  EXPECT_EQ(value(found, "diag_residual_mps_max"), 0.25);
  EXPECT_EQ(value(found, "diag_residual_mps_mean"), 0.25);
  run.diagnostics[0].value = k_nan;
  EXPECT_TRUE(std::isnan(value(measure("contacts", run), "diag_residual_mps_max")));
  run.contacts = {};
  EXPECT_FALSE(applies(find(measure("contacts", run), "contacts_max")));
}

}  // namespace
}  // namespace brickbench::testing
