// A finding's plan is read back as the very trial.
#include "experiments/hunt/plan_text.hpp"

#include <gtest/gtest.h>

#include "experiments/exact/cases/exact_case.hpp"
#include "experiments/hunt/draw.hpp"
#include "tests/unit/run/fakes.hpp"

namespace brickbench::hunt {
namespace {

TEST(PlanText, IsReadBackAsTheSameTrial) {
  Catalogues catalogues = brickbench::testing::fake_catalogues();
  catalogues.scenarios = scenarios();
  for (std::uint64_t k = 0; k < 300; ++k) {
    auto trial = draw_scene(catalogues.scenarios, 5, k);
    ASSERT_TRUE(trial.has_value());
    trial->engine = {"good", k % 2 == 0 ? "plain" : "fancy"};
    if (k % 3 == 0) trial->knobs["iterations"] = 3.0;
    Verdict verdict;
    verdict.reason = "solver \"lost\" it \\ \"\"\"";
    verdict.outcome = "crashed";
    verdict.breaches = {{"energy", 2.0, 1.0, "J", 3, 0.1, "a, b"}};
    const std::string text = plan_text(*trial, verdict, "energy", "x.toml", "Seed 5.");
    const auto plan = parse_plan(text, "x.toml", catalogues);
    ASSERT_TRUE(plan.has_value()) << plan.error().text() << "\n" << text;
    const auto trials = trials_of(*plan, catalogues);
    ASSERT_TRUE(trials.has_value()) << trials.error().text();
    ASSERT_EQ(trials->size(), 1u);
    EXPECT_EQ(trials->front(), *trial) << text;
  }
}

TEST(PlanText, OfAnExactCaseIsReadBackAsTheSameTrial) {
  const Catalogues catalogues = brickbench::testing::fake_catalogues();
  std::vector<std::string> cases;
  for (const exact::ExactCase& exact_case : exact::exact_cases()) cases.push_back(exact_case.id);
  ASSERT_FALSE(cases.empty());
  for (std::uint64_t k = 0; k < 300; ++k) {
    Trial trial = draw_case(cases, 5, k);
    trial.engine = {"good", "plain"};
    if (k % 3 == 0) trial.knobs["iterations"] = 3.0;
    Verdict verdict;
    verdict.breaches = {{"scheme", 2.0, 1.0, "1", 0, 0.0, ""}};
    const std::string text = plan_text(trial, verdict, "scheme", "x.toml", "Seed 5.");
    const auto back = case_trial(text, "x.toml", catalogues);
    ASSERT_TRUE(back.has_value()) << back.error().text() << "\n" << text;
    ASSERT_TRUE(back->has_value()) << text;
    EXPECT_EQ((*back)->source, trial.source);
    EXPECT_EQ((*back)->scene, trial.scene);
    EXPECT_EQ((*back)->engine, trial.engine);
    EXPECT_EQ((*back)->parameters, trial.parameters) << text;
    EXPECT_EQ((*back)->knobs, trial.knobs);
  }
}

}  // namespace
}  // namespace brickbench::hunt
