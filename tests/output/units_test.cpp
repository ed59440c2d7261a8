// Pure numbers have the unit "1" in rows and no unit in messages: each message is the same with "1"
// and without any unit.
#include <gtest/gtest.h>

#include "adapters/catalog.hpp"
#include "adapters/seam/unit.hpp"
#include "experiments/exact/cases/exact_case.hpp"
#include "experiments/hunt/plan_text.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/regression/compare.hpp"
#include "experiments/scenarios/scenario.hpp"

namespace brickbench::testing {
namespace {

TEST(Units, OfPureNumbersAreNotShown) {
  EXPECT_EQ(unit_suffix("1"), "");
  EXPECT_EQ(unit_suffix(""), "");
  EXPECT_EQ(unit_suffix("m/s"), " m/s");
}

// What a scenario says of a value beyond its range.
std::string refusal_of(Scenario scenario, std::size_t parameter, const std::string& unit) {
  scenario.parameters[parameter].unit = unit;
  const auto scene = build(scenario, {{scenario.parameters[parameter].name, 1e300}});
  return scene ? "" : scene.error().reason;
}

TEST(Units, InTheRefusalsOfEveryParameterOfEveryScene) {
  std::size_t tried = 0;
  for (const Scenario& scenario : scenarios()) {
    for (std::size_t i = 0; i < scenario.parameters.size(); ++i) {
      const std::string plain = refusal_of(scenario, i, "");
      if (plain.empty() || scenario.parameters[i].kind == ParameterKind::choice) continue;
      EXPECT_EQ(refusal_of(scenario, i, "1"), plain);
      EXPECT_NE(refusal_of(scenario, i, "zz"), plain) << "the unit is not told at all";
      ++tried;
    }
  }
  EXPECT_GT(tried, 50U);
}

TEST(Units, InTheRefusalsOfEveryParameterOfEveryExactCase) {
  const auto refused = [](exact::ExactCase exact_case, std::size_t i, const std::string& unit) {
    exact_case.parameters[i].unit = unit;
    const auto run = exact::build(exact_case, {{exact_case.parameters[i].name, 1e300}});
    return run ? std::string() : run.error().reason;
  };
  for (const exact::ExactCase& exact_case : exact::exact_cases()) {
    for (std::size_t i = 0; i < exact_case.parameters.size(); ++i) {
      const std::string plain = refused(exact_case, i, "");
      EXPECT_FALSE(plain.empty()) << exact_case.id;
      EXPECT_EQ(refused(exact_case, i, "1"), plain);
      EXPECT_NE(refused(exact_case, i, "zz"), plain);
    }
  }
}

TEST(Units, InTheRefusalsOfEveryKnob) {
  for (const Adapter& adapter : adapters()) {
    for (std::size_t i = 0; i < adapter.knobs.size(); ++i) {
      const auto refused = [&](const std::string& unit) {
        Adapter other = adapter;
        other.knobs[i].unit = unit;
        other.knobs[i].min = 0.0;
        other.knobs[i].max = 5.0;
        Settings settings;
        settings.knobs[other.knobs[i].name] = 7.0;
        const auto built = build(other, {}, settings);
        return built ? std::string() : built.error().reason;
      };
      EXPECT_FALSE(refused("").empty());
      EXPECT_EQ(refused("1"), refused(""));
      EXPECT_NE(refused("zz"), refused(""));
    }
  }
}

// One number of a check, that is out of its bound, not enough runs, the same, or another
// distribution.
std::vector<std::string> messages_of(const std::string& metric, const std::string& unit) {
  std::vector<std::string> messages;
  for (const gate::Kind kind : {gate::Kind::bound, gate::Kind::distribution}) {
    for (const double shift : {1e-6, 0.5, 100.0}) {
      gate::Record before;
      before.engine = "e/v";
      before.metric = metric;
      before.kind = kind;
      before.unit = unit;
      before.better = "lower";
      before.bound = 1e-9;
      before.margin = 0.4;
      gate::Record after = before;
      for (std::uint64_t seed = 1; seed <= 24; ++seed) {
        before.seeds.push_back(seed);
        before.values.push_back(0.1 * static_cast<double>(seed * seed % 7));
        after.values.push_back(before.values.back() + shift * (seed % 2 == 0 ? 1.0 : 0.9));
      }
      after.seeds = before.seeds;
      gate::Suite reference, obtained;
      reference.experiments = {{"x", {before}}};
      obtained.experiments = {{"x", {after}}};
      messages.push_back(gate::compare(reference, obtained, {}, true).front().message);
    }
  }
  return messages;
}

TEST(Units, InTheFindingsOfACheck) {
  const auto plain = messages_of("m", "");
  EXPECT_EQ(messages_of("m", "1"), plain);
  const auto named = messages_of("m", "zz");
  for (std::size_t i = 0; i < plain.size(); ++i) EXPECT_NE(named[i], plain[i]) << plain[i];
  for (const MetricInfo& metric : metrics()) {
    for (const OutputInfo& output : metric.outputs) {
      if (output.unit != "1") continue;
      EXPECT_EQ(messages_of(output.name, output.unit), messages_of(output.name, ""));
    }
  }
}

TEST(Units, InThePlansOfAHunt) {
  const auto text_of_plan = [](hunt::Source source, const std::string& unit) {
    hunt::Trial trial;
    trial.source = source;
    trial.scene = source == hunt::Source::scenario ? "two_bricks" : "impact.corner";
    hunt::Verdict verdict;
    verdict.breaches = {{"scheme", 3.0, 2.0, unit, 4, 0.5, "a"}};
    return hunt::plan_text(trial, verdict, "scheme", "x.toml", "");
  };
  for (const auto source : {hunt::Source::scenario, hunt::Source::exact_case}) {
    EXPECT_EQ(text_of_plan(source, "1"), text_of_plan(source, ""));
    EXPECT_NE(text_of_plan(source, "zz"), text_of_plan(source, ""));
  }
}

}  // namespace
}  // namespace brickbench::testing
