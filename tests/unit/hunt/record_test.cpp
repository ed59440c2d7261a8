// The hunt as a whole, with fake engines: order, resumption, isolation, what it writes.
#include "experiments/hunt/record.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "experiments/hunt/findings.hpp"
#include "experiments/hunt/hunt.hpp"
#include "experiments/hunt/plan_text.hpp"
#include "tests/support/troubled_engine.hpp"

namespace brickbench::hunt {
namespace {

namespace fs = std::filesystem;

// Scenes of the catalogue for engines that let everything fall, or die of it.
Catalogues hunted_catalogues() {
  Catalogues catalogues = brickbench::testing::troubled_catalogues();
  catalogues.scenarios = scenarios();
  return catalogues;
}

class Hunted : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              ("brickbench-hunt-" + std::to_string(::getpid()) + "-" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  Record hunt(const Quarry& quarry, std::uint64_t trials, std::size_t workers,
              const std::string& name, bool resume = false) const {
    Record record;
    const auto file = resume ? ProgressFile::resume(folder_ / name, quarry, record)
                             : ProgressFile::create(folder_ / name, quarry);
    EXPECT_TRUE(file.has_value()) << file.error().reason;
    HuntOptions options;
    options.budget_s = 1e4;
    options.most_trials = trials;
    options.workers = workers;
    const auto ran = run_hunt(quarry, catalogues_, options, *file, record);
    EXPECT_TRUE(ran.has_value()) << ran.error().reason;
    return record;
  }

  std::string summary(const Quarry& quarry, const Record& record) const {
    return summary_json(quarry, record, findings(record, catalogues_));
  }

  Catalogues catalogues_ = hunted_catalogues();
  Quarry quarry_ = {3, {{"good", "plain"}}, {"brick_drop", "two_bricks"}, {}};
  fs::path folder_;
};

TEST_F(Hunted, FindsTheSameWithOneProcessOrThree) {
  const std::string one = summary(quarry_, hunt(quarry_, 12, 1, "one"));
  const std::string three = summary(quarry_, hunt(quarry_, 12, 3, "three"));
  EXPECT_EQ(one, three);
  EXPECT_NE(one.find("\"passage\""), std::string::npos) << one;
}

TEST_F(Hunted, GoesOnWhereItWasCutOff) {
  const std::string whole = summary(quarry_, hunt(quarry_, 12, 2, "whole"));
  hunt(quarry_, 7, 2, "parts");
  // A machine that stops while it writes leaves half a line.
  std::ofstream(folder_ / "parts" / "progress.jsonl", std::ios::app) << "{\"number\": 7, \"tri";
  EXPECT_EQ(summary(quarry_, hunt(quarry_, 12, 2, "parts", true)), whole);
}

TEST_F(Hunted, RefusesAnotherHuntsFolderAndAnExistingOne) {
  hunt(quarry_, 2, 1, "first");
  EXPECT_FALSE(ProgressFile::create(folder_ / "first", quarry_).has_value());
  Quarry other = quarry_;
  other.seed = 4;
  Record record;
  const auto refused = ProgressFile::resume(folder_ / "first", other, record);
  ASSERT_FALSE(refused.has_value());
  EXPECT_NE(refused.error().reason.find("another hunt"), std::string::npos);
  EXPECT_FALSE(ProgressFile::resume(folder_ / "none", quarry_, record).has_value());
}

TEST_F(Hunted, CallsAnEngineThatDiesAFindingAndOneThatFailsTold) {
  for (const char* engine : {"segfault", "abort", "exit"}) {
    Quarry quarry = quarry_;
    quarry.engines = {{engine, "plain"}};
    const Record record = hunt(quarry, 2, 1, engine);
    ASSERT_FALSE(record.finds().empty()) << engine;
    EXPECT_EQ(record.finds().front().oracle, "process") << engine;
    const auto& shrunk = record.shrunk().at(0);
    EXPECT_TRUE(shrunk.trial.parameters.empty()) << label(shrunk.trial);
  }
  Quarry quarry = quarry_;
  quarry.engines = {{"nan", "plain"}, {"refuser", "plain"}};
  const Record record = hunt(quarry, 4, 1, "told");
  EXPECT_TRUE(record.finds().empty());
  EXPECT_EQ(record.outcomes().at("diverged"), 2u);
  EXPECT_EQ(record.outcomes().at("refused"), 2u);
}

// Of an exact case with no knob turned; any other is new.
TEST_F(Hunted, KnowsAFindingByItsOpenQuestion) {
  Trial trial;
  trial.source = Source::exact_case;
  trial.scene = "tipping.overhang";
  trial.engine = {"good", "plain"};
  const Verdict verdict = {"ok", "", {{"scheme", 1e-3, 1e-6, "1", 0, 0.0, ""}}};
  const auto found = [&](const Trial& of, const std::string& case_id) {
    Record record;
    record.add(record.add(0, of, verdict).at(0), {of, verdict});
    return findings(record, catalogues_,
                    {{"good", "plain", case_id, {.at_defaults = false}, "", "", "why"}});
  };
  const auto known = found(trial, trial.scene);
  ASSERT_EQ(known.size(), 1U);
  EXPECT_EQ(known.front().question, "why");
  EXPECT_EQ(new_findings(known), 0U);
  EXPECT_EQ(new_findings(found(trial, "tipping.rocking")), 1U);
  Trial turned = trial;
  turned.knobs["iterations"] = 1.0;
  EXPECT_EQ(new_findings(found(turned, trial.scene)), 1U);
}

TEST_F(Hunted, WritesPlansThatShowTheFindingAgain) {
  const Record record = hunt(quarry_, 12, 2, "plans");
  const auto list = findings(record, catalogues_);
  ASSERT_FALSE(list.empty());
  ASSERT_TRUE(write_plans(folder_ / "plans", list, "Seed 3.").has_value());
  for (const Finding& finding : list) {
    const auto plan = read_plan(folder_ / "plans" / (finding.id + ".toml"), catalogues_);
    ASSERT_TRUE(plan.has_value()) << plan.error().text();
    const auto trials = trials_of(*plan, catalogues_);
    ASSERT_TRUE(trials.has_value()) << trials.error().text();
    const Verdict verdict = judge(trials->front(), catalogues_);
    ASSERT_NE(verdict.find(finding.oracle), nullptr) << label(trials->front());
    EXPECT_EQ(verdict.find(finding.oracle)->observed, finding.breach().observed);
  }
}

}  // namespace
}  // namespace brickbench::hunt
