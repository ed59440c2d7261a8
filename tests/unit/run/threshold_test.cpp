// Thresholds: the bracket closes round the place where the condition turns, and what cannot be
// answered says why.
#include "experiments/run/threshold.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/run/fakes.hpp"

namespace brickbench::testing {
namespace {

// Balls of mass_kg get a blow along x: their speed at the end is push_ns / mass_kg.
ThresholdQuestion question(const std::string& until, const std::string& engine = "good") {
  const Catalogues catalogues = fake_catalogues();
  ThresholdQuestion question;
  auto condition = threshold_condition(until, "--until", catalogues);
  EXPECT_TRUE(condition.has_value()) << condition.error().text();
  question.until = condition->condition;
  Cell& cell = question.cell;
  cell.experiment = cell.scenario = "fall";
  cell.engine = {engine, "plain"};
  cell.parameters = complete(*find_scenario(catalogues, "fall"), {{"push_ns", 2.0}}).value();
  cell.step_s = 0.01;
  cell.duration_s = 0.1;
  cell.metrics = condition->metrics;
  question.parameter = "mass_kg";
  question.low = 0.1;
  question.high = 10.0;
  return question;
}

ThresholdAnswer answer(const ThresholdQuestion& asked) {
  return find_threshold(asked, fake_catalogues(), {"rev", "machine"});
}

TEST(Threshold, IsBracketedToTheWidthFromEitherSide) {
  for (const double speed_mps : {0.25, 1.0, 15.0}) {
    for (const char* relation : {"<", ">"}) {
      for (const double width : {0.1, 1e-6}) {
        ThresholdQuestion asked =
            question(std::string("speed_mps ") + relation + " " + std::to_string(speed_mps));
        asked.width = width;
        const ThresholdAnswer found = answer(asked);
        ASSERT_EQ(found.outcome, "ok") << found.reason;
        EXPECT_LE(found.low, 2.0 / speed_mps);
        EXPECT_GE(found.high, 2.0 / speed_mps);
        EXPECT_LE(found.high - found.low, width * 9.9);
        EXPECT_EQ(found.held_at_high, relation[0] == '<');
        EXPECT_LE(static_cast<double>(found.trials.size()), 3.0 + std::log2(1.0 / width));
      }
    }
  }
}

TEST(Threshold, OfWholeNumbersLiesBetweenNeighbours) {
  ThresholdQuestion asked = question("speed_mps < 0.5");  // above 4 kg
  asked.whole = true;
  asked.high = 1000.0;
  for (const double low : {1.0, 3.0, 4.0}) {
    asked.low = low;
    const ThresholdAnswer found = answer(asked);
    EXPECT_EQ(found.low, 4.0);
    EXPECT_EQ(found.high, 5.0);
    for (const ThresholdTrial& trial : found.trials) {
      EXPECT_EQ(trial.value, std::round(trial.value));
    }
  }
}

TEST(Threshold, IsNoneWhereNothingChanges) {
  const ThresholdAnswer same = answer(question("speed_mps > 1000"));
  EXPECT_EQ(same.outcome, "no_change");
  EXPECT_EQ(same.trials.size(), 2u);
  EXPECT_NE(same.reason.find("does not hold"), std::string::npos);
  EXPECT_NE(answer(question("speed_mps > 0.001")).reason.find("holds at both"), std::string::npos);
}

TEST(Threshold, SaysWhyARunHasNoNumber) {
  const ThresholdAnswer failed = answer(question("speed_mps > 1", "failer"));
  EXPECT_EQ(failed.outcome, "crashed");
  EXPECT_NE(failed.reason.find("mass_kg = 0.1"), std::string::npos) << failed.reason;
  EXPECT_EQ(answer(question("never > 1")).outcome, "not_applicable");
  // A condition on the outcome itself takes any end of a run as an answer.
  EXPECT_EQ(answer(question("outcome == crashed", "failer")).outcome, "no_change");
}

TEST(Threshold, KnowsTheNamesOfNumbers) {
  const auto condition = threshold_condition("speed_mp > 1", "--until", fake_catalogues());
  ASSERT_FALSE(condition);
  EXPECT_NE(condition.error().text().find("did you mean 'speed_mps'"), std::string::npos);
  const auto both = threshold_condition("height_m > 1 and speed_mps < 2", "", fake_catalogues());
  ASSERT_TRUE(both);
  EXPECT_EQ(both->metrics, std::vector<std::string>{"fall"});
}

}  // namespace
}  // namespace brickbench::testing
