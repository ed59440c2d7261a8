// The gate end to end, in this process: a suite is green against its own references and red, naming
// the right number, against an engine with a seeded fault.
#include "experiments/regression/check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "adapters/catalog.hpp"
#include "experiments/run/plan_files.hpp"

namespace brickbench::gate {
namespace {

// The first linked engine with an iterative solver, as its library comes; empty name: none.
Adapter sound_engine() {
  for (Adapter adapter : adapters()) {
    const auto iterates = [](const Knob& knob) { return knob.name == "iterations"; };
    const auto library = [](const Variant& variant) { return variant.name == "default"; };
    if (std::ranges::any_of(adapter.knobs, iterates) &&
        std::ranges::any_of(adapter.variants, library)) {
      return adapter;
    }
  }
  return {};
}

enum class Fault { none, friction, gravity, restitution, iterations };

template <Fault fault>
Expected<std::unique_ptr<Simulation>> build_with(const World& world, const Settings& settings) {
  const Adapter sound = sound_engine();
  World changed = world;
  Settings turned = settings;
  const auto for_all_laws = [&](auto change) {
    change(changed.law);
    for (PairLaw& pair : changed.exceptions) change(pair.law);
  };
  if (fault == Fault::friction) for_all_laws([](ContactLaw& law) { law.friction *= 0.95; });
  if (fault == Fault::restitution) for_all_laws([](ContactLaw& law) { law.restitution += 0.05; });
  if (fault == Fault::gravity) changed.gravity_mps2 *= 1.01;
  if (fault == Fault::iterations) {
    for (const Knob& knob : sound.knobs) {
      if (knob.name == "iterations")
        turned.knobs[knob.name] = std::floor(0.5 * knob.engine_default);
    }
  }
  return sound.build(changed, turned);
}

class Check : public ::testing::Test {
 protected:
  void SetUp() override {
    engine_ = sound_engine();
    if (engine_.name.empty()) GTEST_SKIP() << "no linked engine has a knob named iterations";
    catalogues_ = {scenarios(), metrics(), {engine_}, {engine_.name}};
    const auto file = find_plan("gate_smoke");
    ASSERT_TRUE(file.has_value());
    const auto plan = read_plan(*file, catalogues_,
                                {.set = {}, .engines = {engine_.name + "/default"}, .only = {}});
    ASSERT_TRUE(plan.has_value()) << plan.error().text();
    plan_ = *plan;
    cells_ = expand(plan_, catalogues_).value();
    static const Suite once = run(Fault::none, {}, true).obtained;
    reference_ = once;
  }

  CheckResult run(Fault fault, const Suite& reference, bool all_starts) const {
    Catalogues with = catalogues_;
    Adapter& engine = with.adapters.front();
    if (fault == Fault::friction) engine.build = build_with<Fault::friction>;
    if (fault == Fault::gravity) engine.build = build_with<Fault::gravity>;
    if (fault == Fault::restitution) engine.build = build_with<Fault::restitution>;
    if (fault == Fault::iterations) engine.build = build_with<Fault::iterations>;
    return check(plan_, cells_, with, reference, {.compare = {}, .all_starts = all_starts}, {});
  }

  // "experiment metric" of all red numbers.
  std::set<std::string> red(Fault fault) const {
    const CheckResult result = run(fault, reference_, false);
    EXPECT_EQ(exit_code(result), 1);
    std::set<std::string> names;
    for (const Comparison& c : result.comparisons) {
      if (!is_red(c)) continue;
      names.insert(c.experiment + ' ' + (c.obtained.metric.empty() ? "hash" : c.obtained.metric));
    }
    return names;
  }

  Adapter engine_;
  Catalogues catalogues_;
  Plan plan_;
  std::vector<Cell> cells_;
  Suite reference_;
};

std::string listed(const std::set<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += name + "; ";
  return text;
}

bool any_of_experiment(const std::set<std::string>& names, const std::string& experiment) {
  return std::ranges::any_of(
      names, [&](const std::string& name) { return name.starts_with(experiment + ' '); });
}

TEST_F(Check, IsGreenWhenNothingChanged) {
  const CheckResult result = run(Fault::none, reference_, false);
  EXPECT_EQ(exit_code(result), 0);
  EXPECT_GT(result.comparisons.size(), 10u);
  EXPECT_GT(result.cells_spared, 0u);
}

TEST_F(Check, NamesTheSlideWhenFrictionIsFivePercentLow) {
  const auto names = red(Fault::friction);
  EXPECT_TRUE(names.contains("slide brick_displacement_max_m")) << listed(names);
  EXPECT_FALSE(any_of_experiment(names, "flight")) << listed(names);
}

TEST_F(Check, NamesTheSlideAndTheFallWhenGravityIsOnePercentHigh) {
  const auto names = red(Fault::gravity);
  EXPECT_TRUE(names.contains("slide brick_displacement_max_m")) << listed(names);
  EXPECT_TRUE(any_of_experiment(names, "drop")) << listed(names);
  EXPECT_FALSE(any_of_experiment(names, "flight")) << listed(names);  // there is none
}

TEST_F(Check, NamesTheWallWhenRestitutionIsHigh) {
  const auto names = red(Fault::restitution);
  EXPECT_TRUE(any_of_experiment(names, "wall")) << listed(names);
  EXPECT_FALSE(any_of_experiment(names, "slide")) << listed(names);  // nothing bounces there
  EXPECT_FALSE(any_of_experiment(names, "flight")) << listed(names);
}

TEST_F(Check, NamesTheWallsWhenIterationsAreHalved) {
  const auto names = red(Fault::iterations);
  EXPECT_TRUE(any_of_experiment(names, "wall")) << listed(names);
  EXPECT_TRUE(names.contains("stand penetration_mean_m")) << listed(names);
  EXPECT_FALSE(any_of_experiment(names, "flight")) << listed(names);
}

// Not of the first engine alone: of each that iterates, with the library's own settings. A solver
// that is done before half its iterations moves no bit, and there is nothing to name.
TEST_F(Check, NamesTheWallThatStandsWhenIterationsOfAnyEngineAreHalved) {
  std::string missed;
  std::size_t moved = 0;
  for (const Adapter& adapter : adapters()) {
    const auto knob = std::ranges::find(adapter.knobs, "iterations", &Knob::name);
    const auto library = std::ranges::find(adapter.variants, "default", &Variant::name);
    if (knob == adapter.knobs.end() || library == adapter.variants.end()) continue;
    const Catalogues with = {scenarios(), metrics(), {adapter}, {adapter.name}};
    auto plan = read_plan(*find_plan("gate_smoke"), with,
                          {.set = {}, .engines = {adapter.name + "/default"}, .only = "stand"});
    ASSERT_TRUE(plan.has_value()) << plan.error().text();
    plan->experiments.at(0).seeds.resize(16);
    std::vector<Cell> cells = expand(*plan, with).value();
    const CheckPlan how = {.compare = {}, .all_starts = true};
    const Suite sound = check(*plan, cells, with, {}, how, {}).obtained;
    for (Cell& cell : cells) cell.knobs["iterations"] = std::floor(0.5 * knob->engine_default);
    const CheckResult result = check(*plan, cells, with, sound, {.compare = {}}, {});
    if (std::ranges::all_of(result.comparisons, &Comparison::identical)) continue;
    ++moved;
    if (exit_code(result) != 1) missed += adapter.name + ' ';
  }
  EXPECT_GT(moved, 0u);
  EXPECT_EQ(missed, "");
}

}  // namespace
}  // namespace brickbench::gate
