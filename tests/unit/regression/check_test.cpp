// References, comparisons and blessings: what is red, why, and what a blessing may touch.
#include "experiments/regression/check.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <set>

#include "experiments/regression/observe.hpp"

namespace brickbench::gate {
namespace {

Record bound_record(double value, double bound) {
  Record record;
  record.engine = "some/variant";
  record.axes = "step_s=0.001";
  record.metric = "energy_final_j";
  record.kind = Kind::bound;
  record.unit = "J";
  record.better = "lower";
  record.seeds = {1, 2};
  record.values = {value, value};
  record.bound = bound;
  record.why = "test";
  return record;
}

Record sample_record(double mean, std::uint64_t seed) {
  Record record = bound_record(0.0, 0.0);
  record.kind = Kind::distribution;
  record.metric = "bricks_displaced";
  record.better = "neither";
  record.margin = 1.0;
  record.seeds.clear();
  record.values.clear();
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(mean, 1.0);
  for (std::uint64_t s = 1; s <= 40; ++s) {
    record.seeds.push_back(s);
    record.values.push_back(normal(random));
  }
  return record;
}

Record hash_record(const std::string& hash, const std::string& version) {
  Record record = bound_record(0.0, 0.0);
  record.kind = Kind::hash;
  record.metric.clear();
  record.seeds = {0};
  record.values.clear();
  record.hashes = {hash};
  record.engine_version = version;
  return record;
}

Suite suite_of(std::vector<Record> records) { return {{{"experiment", std::move(records)}}}; }

Comparison only(const Record& reference, const Record& obtained) {
  return compare(suite_of({reference}), suite_of({obtained}), {}, true).at(0);
}

TEST(Gate, BoundsAreInclusiveAndTellBetterFromWorse) {
  EXPECT_EQ(only(bound_record(1.0, 0.5), bound_record(1.5, 0.5)).finding, Finding::fine);
  const Comparison worse = only(bound_record(1.0, 0.25), bound_record(2.0, 0.25));
  EXPECT_EQ(worse.finding, Finding::deviation);
  EXPECT_EQ(worse.trend, Trend::worse);
  EXPECT_DOUBLE_EQ(worse.factor, 4.0);
  EXPECT_EQ(only(bound_record(1.0, 0.25), bound_record(0.0, 0.25)).trend, Trend::better);
}

TEST(Gate, HashesCountOnTheSameEngineVersionAlone) {
  EXPECT_EQ(only(hash_record("a", "1"), hash_record("a", "1")).finding, Finding::fine);
  EXPECT_EQ(only(hash_record("a", "1"), hash_record("b", "1")).finding, Finding::deviation);
  EXPECT_EQ(only(hash_record("a", "1"), hash_record("b", "2")).finding, Finding::not_comparable);
}

TEST(Gate, SamplesAreComparedAsDistributions) {
  EXPECT_EQ(only(sample_record(5.0, 1), sample_record(5.0, 1)).finding, Finding::fine);
  EXPECT_EQ(only(sample_record(5.0, 1), sample_record(5.0, 2)).finding, Finding::fine);
  EXPECT_EQ(only(sample_record(5.0, 1), sample_record(7.0, 2)).finding, Finding::deviation);
  Record narrow = sample_record(5.0, 1);
  narrow.margin = 0.05;
  const Comparison open = only(narrow, sample_record(5.0, 2));
  EXPECT_EQ(open.finding, Finding::open);
  for (const char* part :
       {"some/variant has ", "more starts, 'same within 0.05 J' by ", "threshold"})
    EXPECT_NE(open.message.find(part), std::string::npos) << open.message;
}

// What a comparison says, by experiment and number; p and threshold included.
std::map<std::string, std::string> said(const std::vector<Comparison>& comparisons) {
  std::map<std::string, std::string> all;
  for (const Comparison& c : comparisons) {
    all[c.experiment + '|' + c.obtained.key()] =
        fmt::format("{} {} {} {}", to_word(c.finding), c.p_value, c.bound, c.message);
  }
  return all;
}

TEST(Gate, VerdictsDoNotDependOnCompany) {
  // Numbers from the same to far apart, then with hundreds of others: more numbers of that engine,
  // more engines, another scene. Each says word for word what it said alone.
  std::vector<Record> references, obtained;
  for (int i = 0; i < 12; ++i) {
    const auto seed = static_cast<std::uint64_t>(2 * i + 100);
    references.push_back(sample_record(5.0, seed));
    obtained.push_back(sample_record(5.0 + 0.15 * i, seed + 1));
    references.back().axes = obtained.back().axes = fmt::format("number={:03}", i);
  }
  const auto alone = said(compare(suite_of(references), suite_of(obtained), {}, true));
  std::set<std::string> findings;
  for (const auto& [key, words] : alone) findings.insert(words.substr(0, words.find(' ')));
  EXPECT_TRUE(findings.contains("fine") && findings.contains("deviation") &&
              findings.contains("open"));
  Suite many_references = suite_of(references), many_obtained = suite_of(obtained);
  many_references.experiments.push_back({"another", {}});
  many_obtained.experiments.push_back({"another", {}});
  for (std::size_t i = 0; i < 300; ++i) {
    Record before = sample_record(5.0, 3 * i + 1000), after = sample_record(5.5, 3 * i + 1001);
    before.engine = after.engine = fmt::format("engine{:03}/v", i % 150);
    const std::size_t experiment = i / 150;
    many_references.experiments[experiment].records.push_back(before);
    many_obtained.experiments[experiment].records.push_back(after);
  }
  const auto among_many = said(compare(many_references, many_obtained, {}, true));
  EXPECT_EQ(among_many.size(), alone.size() + 300);
  for (const auto& [key, words] : alone) EXPECT_EQ(among_many.at(key), words) << key;
}

TEST(Gate, RangesThatDoNotOverlapAreRedFromEightStartsOn) {
  for (const std::size_t starts : {8UL, 9UL, 10UL, 24UL}) {
    Record before = sample_record(5.0, 1), after = sample_record(50.0, 2);
    for (Record* record : {&before, &after}) {
      record->seeds.resize(starts);
      record->values.resize(starts);
    }
    const Comparison c = only(before, after);
    EXPECT_EQ(c.finding, Finding::deviation) << starts << ": " << c.message;
    EXPECT_LE(c.p_value, c.bound);
  }
}

TEST(Gate, LooksShareTheLevelAndOnlyThoseThatHaveStarts) {
  const ComparePlan plan;
  EXPECT_EQ(look_plan(plan, 24).level_different, plan.alpha_different / 3.0);
  EXPECT_EQ(look_plan(plan, 16).level_different, plan.alpha_different / 2.0);
  EXPECT_EQ(look_plan(plan, 8).level_different, statistics::least_p(8, 8));
  EXPECT_EQ(look_plan(plan, 8).level_same, plan.alpha_same);
  const auto drawn = static_cast<double>(look_plan(plan, 24).permutation.permutations);
  EXPECT_LT(1.0 / (drawn + 1.0), look_plan(plan, 24).level_different);
}

TEST(Gate, OneMeasurementInTwoUnitsCountsOnce) {
  Record joules = bound_record(1.0, 0.5), share = bound_record(1.0, 0.5);
  share.metric = "energy_final_relative";
  Record lonely = share;
  lonely.engine = "another/variant";
  Record moved = joules, moved_share = share;
  moved.values = moved_share.values = {9.0, 9.0};
  const auto all =
      compare(suite_of({lonely, joules, share}), suite_of({lonely, moved, moved_share}), {}, true);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].obtained.metric, "energy_final_j");
  EXPECT_EQ(all[1].obtained.engine, "another/variant");
  // A blessing leaves no old share beside a new count.
  const BlessResult blessed =
      bless(suite_of({lonely, joules, share}), suite_of({lonely, moved, moved_share}), {}, {});
  EXPECT_EQ(blessed.suite.experiments.at(0).records.size(), 2u);
}

TEST(Gate, AnOutcomeThatChangedIsADeviation) {
  Record crashed = bound_record(1.0, 1.0);
  crashed.outcome = "crashed";
  crashed.values.clear();
  EXPECT_EQ(only(bound_record(1.0, 1.0), crashed).finding, Finding::deviation);
}

Record with_validity(Record record, std::optional<std::string> validity) {
  record.validity = std::move(validity);
  return record;
}

TEST(Gate, AFlaggedNumberIsNotComparedAndANewFlagIsADeviation) {
  const std::string flag = "unsolved in 1 of 9 steps from step 3";
  for (const Record& record :
       {bound_record(1.0, 0.5), hash_record("a", "1"), sample_record(5, 1)}) {
    EXPECT_EQ(only(record, with_validity(record, flag)).finding, Finding::deviation);
    EXPECT_EQ(only(with_validity(record, flag), record).finding, Finding::flagged);
    const Comparison both = only(with_validity(record, flag), with_validity(record, flag));
    EXPECT_EQ(both.finding, Finding::flagged);
    EXPECT_NE(both.message.find(flag), std::string::npos) << both.message;
    EXPECT_FALSE(is_compared(both) || is_red(both));
    // A reference of earlier times says nothing of its validity.
    EXPECT_EQ(only(with_validity(record, {}), record).finding, Finding::fine);
    EXPECT_EQ(only(with_validity(record, {}), with_validity(record, flag)).finding,
              Finding::flagged);
  }
}

TEST(Gate, NothingComparedIsNoSuccess) {
  Record crashed = bound_record(1.0, 1.0);
  crashed.outcome = "crashed";
  crashed.values.clear();
  const Record flagged =
      with_validity(bound_record(1.0, 1.0), "clamped in 1 of 9 steps from step 3");
  for (const Record& record : {crashed, flagged}) {
    CheckResult result;
    result.comparisons = compare(suite_of({record}), suite_of({record}), {}, true);
    EXPECT_FALSE(is_compared(result.comparisons.at(0)));
    EXPECT_EQ(exit_code(result), 3);
    EXPECT_TRUE(bless(suite_of({record}), suite_of({record}), {}, {}).changed.empty());
    Record sound = bound_record(1.0, 1.0);
    sound.metric = "another";
    result.comparisons = compare(suite_of({sound, record}), suite_of({sound, record}), {}, true);
    EXPECT_EQ(exit_code(result), 0);
  }
  EXPECT_EQ(exit_code(CheckResult{}), 3);
}

TEST(Gate, WhatIsMissingOrNewIsSaid) {
  const Suite one = suite_of({bound_record(1.0, 0.1)});
  EXPECT_EQ(compare(one, Suite{}, {}, true).at(0).finding, Finding::missing);
  EXPECT_EQ(compare(Suite{}, one, {}, true).at(0).finding, Finding::fresh);
}

TEST(Gate, TheWorstComesFirst) {
  Record a = bound_record(1.0, 0.1), b = bound_record(1.0, 0.1), c = bound_record(1.0, 0.1);
  a.metric = "a";
  b.metric = "b";
  c.metric = "c";
  const Suite reference = suite_of({a, b, c});
  b.values = {2.0, 2.0};
  c.values = {9.0, 9.0};
  const auto all = compare(reference, suite_of({a, b, c}), {}, true);
  EXPECT_EQ(all[0].obtained.metric, "c");
  EXPECT_EQ(all[1].obtained.metric, "b");
}

TEST(Gate, ABlessingRewritesOnlyWhatChanged) {
  Record same = bound_record(1.0, 0.5), moved = bound_record(1.0, 0.5);
  same.metric = "a_same";
  moved.metric = "b_moved";
  const Suite reference = suite_of({same, moved});
  same.values = {1.1, 1.1};  // within its bound
  moved.values = {5.0, 5.0};
  const BlessResult result =
      bless(reference, suite_of({same, moved}), {"a reason", "date", "rev", "cpu", "cc"}, {});
  ASSERT_EQ(result.changed.size(), 1u);
  const auto& records = result.suite.experiments.at(0).records;
  EXPECT_EQ(records[0].values[0], 1.0);
  EXPECT_EQ(records[0].blessed, Blessing{});
  EXPECT_EQ(records[1].values[0], 5.0);
  EXPECT_EQ(records[1].blessed.reason, "a reason");
}

class DamagedReference : public ::testing::Test {
 protected:
  DamagedReference() { std::filesystem::create_directories(folder_); }
  ~DamagedReference() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  // What reading says of a file with this text; empty if it finds nothing wrong.
  std::string complaint(const std::string& text) const {
    std::ofstream(folder_ / "drop.json") << text;
    const auto suite = read_suite(folder_);
    return suite ? "" : suite.error().reason;
  }

  // Two good records, one per line, with `wrong` in place of the first `right` of the second.
  static std::string damaged(const std::string& right, const std::string& wrong) {
    std::string text = to_text({"drop", {bound_record(1.0, 0.5), bound_record(2.0, 0.5)}});
    const std::size_t second = text.find('\n', 2) + 1;
    return text.replace(text.find(right, second), right.size(), wrong);
  }

  std::filesystem::path folder_ = std::filesystem::temp_directory_path() /
                                  ("brickbench_reference." + std::to_string(::getpid()));
};

TEST_F(DamagedReference, IsNamedByFileAndLine) {
  EXPECT_EQ(complaint(damaged("}", "}")), "");
  for (const auto& [right, wrong] : {std::pair{"\"kind\":", "\"kind\""},
                                     {"\"kind\":", "\"sort\":"},
                                     {"[2.0,2.0]", "[2.0]"},
                                     {"[2.0,2.0]", "[2.0,\"2\"]"}}) {
    const std::string said = complaint(damaged(right, wrong));
    EXPECT_NE(said.find("drop.json:3: "), std::string::npos) << wrong << ": " << said;
  }
}

TEST_F(DamagedReference, IsNamedByRecordInAnotherLayout) {
  std::string text = damaged("\"kind\":", "\"sort\":");
  std::ranges::replace(text, '\n', ' ');
  EXPECT_NE(complaint(text).find("drop.json, record 2: "), std::string::npos) << complaint(text);
  EXPECT_NE(complaint("{}").find("not a list"), std::string::npos);
}

TEST(Gate, JUnitNamesTheOffenderAndEscapesIt) {
  CheckResult result;
  result.command = "brickbench check smoke";
  Record odd = bound_record(1.0, 0.1);
  odd.metric = "a<b";
  Record far = odd;
  far.values = {3.0, 3.0};
  result.comparisons = compare(suite_of({odd}), suite_of({far}), {}, true);
  const std::string text = junit("smoke", result);
  EXPECT_NE(text.find("failures=\"1\""), std::string::npos);
  EXPECT_NE(text.find("a&lt;b"), std::string::npos);
  EXPECT_NE(text.find("brickbench check smoke --engine some/variant --only experiment"),
            std::string::npos);
  EXPECT_EQ(exit_code(result), 1);
}

TEST(Gate, SeedsSayTheKindAndBoundsFollowFromTheSpread) {
  EXPECT_EQ(kind_for(1), Kind::hash);
  EXPECT_EQ(kind_for(4), Kind::bound);
  EXPECT_EQ(kind_for(k_ensemble_seeds), Kind::distribution);
  std::vector<Row> rows(3);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].experiment = "experiment";
    rows[i].metric = "m";
    rows[i].outcome = "ok";
    rows[i].seed = i + 1;
    rows[i].value = 1.0 + 0.001 * static_cast<double>(i);
  }
  const Suite suite = observe(rows, {{"experiment", 3}}, {});
  const Record& record = suite.experiments.at(0).records.at(0);
  EXPECT_NEAR(record.residual, 0.002, 1e-15);
  EXPECT_NEAR(record.bound, 0.02, 1e-14);
}

}  // namespace
}  // namespace brickbench::gate
