// Reports: what the rows say, aligned, ranked, with denominators and our own losses first.
#include <gtest/gtest.h>

#include <sstream>

#include "reports/src/losses.hpp"
#include "reports/src/markdown_report.hpp"
#include "reports/src/summary.hpp"

namespace brickbench::testing {
namespace {

Row row(const std::string& engine, const std::string& metric, const std::string& better,
        std::optional<double> value, std::uint64_t seed = 0) {
  Row row;
  row.experiment = "wall";
  row.cell = engine + std::to_string(seed);
  row.engine = engine;
  row.variant = "v";
  row.step_s = 0.001;
  row.duration_s = 1.0;
  row.seed = seed;
  row.axes = "friction=0.5;kind=a b";
  row.group = "energy";
  row.metric = metric;
  row.unit = "J";
  row.better = better;
  row.value = value;
  row.outcome = value ? "ok" : "diverged";
  row.reason = value ? "" : "body 'x' | is not finite";
  row.state_hash = value ? "00ff" : "";
  return row;
}

std::vector<Row> rows() {
  return {row("ours", "created_j", "lower", 3.0),  row("a", "created_j", "lower", 1.0),
          row("b", "created_j", "lower", 2.0),     row("c", "created_j", "lower", {}),
          row("ours", "reached_m", "higher", 9.0), row("a", "reached_m", "higher", 1.0),
          row("b", "reached_m", "higher", 2.0),    row("c", "reached_m", "higher", {}),
          row("ours", "final_j", "neither", 1.0),  row("a", "final_j", "neither", 5.0),
          row("b", "final_j", "neither", 5.0),     row("c", "final_j", "neither", {})};
}

Provenance provenance() {
  Provenance p;
  p.command = "brickbench run wall";
  p.plan = "plans/wall.toml";
  p.title = "Title";
  p.engines = {{"ours", "1", "f64", true}, {"a", "2", "f32", false}};
  p.metrics = {{"created_j", "J", "energy", "lower", "energy from nowhere", "0"}};
  return p;
}

TEST(Summary, RanksByDirectionAndKeepsFailures) {
  const auto blocks = summarize(rows());
  ASSERT_EQ(blocks.size(), 1U);
  const Block& block = blocks.front();
  ASSERT_EQ(block.contenders.size(), 4U);
  EXPECT_EQ(block.numbers[0].best, 1U);
  EXPECT_EQ(block.numbers[0].worst, 0U);
  EXPECT_EQ(block.numbers[1].best, 0U);
  EXPECT_EQ(block.numbers[1].worst, 1U);
  EXPECT_FALSE(block.numbers[2].best.has_value());
  EXPECT_EQ(score_text(block.scores[3][0]), "diverged");
}

TEST(Summary, SeedsBecomeMeansWithTheirDenominator) {
  std::vector<Row> seeded;
  for (const double value : {4.0, 1.0, 2.0}) {
    seeded.push_back(row("a", "created_j", "lower", value, seeded.size() + 1));
  }
  seeded.push_back(row("a", "created_j", "lower", {}, 4));
  const auto blocks = summarize(seeded);
  EXPECT_EQ(score_text(blocks.front().scores[0][0]), "mean 2.333, range 1 .. 4 (3 of 4)");
}

TEST(Summary, ManySeedsHaveAnIntervalAndAMeanThatIsNamed) {
  std::vector<Row> seeded;
  for (std::uint64_t seed = 1; seed <= 9; ++seed) {
    seeded.push_back(row("a", "created_j", "lower", static_cast<double>(seed), seed));
  }
  const Score score = summarize(seeded).front().scores[0][0];
  ASSERT_TRUE(score.interval.has_value());
  EXPECT_EQ(*score.mean, 5.0);
  // Student's interval is 2.9 .. 7.1; the values are as far apart as can be, the bootstrap agrees
  // to a tenth.
  EXPECT_NEAR(score.interval->low, 2.9, 0.2);
  EXPECT_NEAR(score.interval->high, 7.1, 0.2);
  EXPECT_TRUE(score_text(score).starts_with("mean 5, 95 % ")) << score_text(score);
  EXPECT_TRUE(score_text(score).ends_with(" (9 of 9)")) << score_text(score);
}

constexpr const char* k_flag = "unsolved in 31 of 240 steps from step 12";

std::vector<Row> with_flag(std::vector<Row> all, const std::string& engine) {
  for (Row& r : all) {
    if (r.engine == engine) r.validity = k_flag;
  }
  return all;
}

TEST(Validity, AFlaggedNumberIsShownWithItsFlagAndNeverRanked) {
  for (const std::string flagged : {"ours", "a", "b"}) {
    const auto blocks = summarize(with_flag(rows(), flagged));
    const Block& block = blocks.front();
    const Table table = to_table(block);
    for (std::size_t c = 0; c < block.contenders.size(); ++c) {
      const bool is_flagged = block.contenders[c].engine == flagged;
      for (std::size_t n = 0; n < block.numbers.size(); ++n) {
        if (!is_flagged) continue;
        EXPECT_FALSE(is_best(block, c, n) || is_worst(block, c, n)) << flagged;
        EXPECT_EQ(table.rows[c][n + 1].mark, Mark::flagged);
        EXPECT_TRUE(table.rows[c][n + 1].text.ends_with(" !")) << table.rows[c][n + 1].text;
      }
    }
    EXPECT_EQ(flag_lines(blocks), std::vector<std::string>{"! " + flagged + "/v: " + k_flag});
  }
  // The best and the worst of the valid ones.
  const Block block = summarize(with_flag(rows(), "a")).front();
  EXPECT_EQ(block.numbers[0].best, 2U);
  EXPECT_EQ(block.numbers[0].worst, 0U);
}

TEST(Validity, AFlaggedSeedIsLeftOutOfTheMeanAndCounted) {
  std::vector<Row> seeded;
  for (const double value : {4.0, 1.0, 2.0, -9.0}) {
    seeded.push_back(row("a", "created_j", "lower", value, seeded.size() + 1));
  }
  seeded.back().validity = k_flag;
  EXPECT_EQ(score_text(summarize(seeded).front().scores[0][0]),
            "mean 2.333, range 1 .. 4 (3 of 4, 1 !)");
  for (Row& r : seeded) r.validity = k_flag;
  EXPECT_EQ(score_text(summarize(seeded).front().scores[0][0]),
            "mean -0.5 !, range -9 .. 4 (0 of 4, 4 !)");
  EXPECT_FALSE(summarize(seeded).front().scores[0][0].is_valid());
}

TEST(Validity, NoComparisonIsMadeWithFlaggedNumbers) {
  const std::vector<std::string> own = {"ours"};
  LossTable table = losses(summarize(with_flag(rows(), "a")), own);
  EXPECT_EQ(table.compared, 2U);
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_EQ(table.rows[0].best, "b/v") << "beaten by a flagged number";
  table = losses(summarize(with_flag(rows(), "ours")), own);
  EXPECT_EQ(table.compared, 0U);
  EXPECT_EQ(table.flagged, 2U);
  EXPECT_TRUE(table.rows.empty());
}

TEST(Validity, TheReportCountsNamesAndExplainsTheFlags) {
  std::vector<Row> all = with_flag(rows(), "a");
  const Provenance p = provenance();
  Timing timing;
  timing.engine = "a";
  timing.variant = "v";
  timing.steps = 240;
  timing.outcome = "ok";
  timing.validity = k_flag;
  const std::string report = markdown_report({all, {&timing, 1}, &p});
  std::string missing;
  for (const std::string& part :
       {std::string("3 of 4 cells ran to their end; 1 of them are flagged (!)"),
        std::string("| 1 ! |"), std::string("- ! a/v: ") + k_flag,
        std::string("| no: ") + k_flag + " |"}) {
    if (report.find(part) == std::string::npos) missing += part + '\n';
  }
  EXPECT_EQ(missing, "") << report;
  EXPECT_EQ(report.find("**1"), std::string::npos) << "a flagged number is best";
}

TEST(Losses, ComeOnlyWhereAnotherIsBetter) {
  const std::vector<std::string> own = {"ours"};
  const LossTable table = losses(summarize(rows()), own);
  EXPECT_EQ(table.compared, 2U);
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_EQ(table.rows[0].number, "created_j");
  EXPECT_EQ(table.rows[0].best, "a/v");
  EXPECT_EQ(table.rows[0].ratio, 3.0);
}

TEST(Report, SaysLossesFailuresWorstAndHowToRepeat) {
  const std::vector<Row> all = rows();
  const Provenance p = provenance();
  const std::string report = markdown_report({all, {}, &p});
  EXPECT_EQ(report, markdown_report({all, {}, &p}));
  std::string missing;
  for (const char* part :
       {"3 of 4 cells ran to their end", "brickbench run wall", "| ours (ours) | 1 | f64 |",
        "1 of 2 comparisons are lost",
        "| created_j | wall: friction=0.5, kind=a b, step 0.001 s, 1 s |",
        "body 'x' \\| is not finite", "**1**", "_3_", "- worst created_j: ours/v with 3 J",
        "`brickbench run plans/wall.toml --only wall --engine c/v --set wall.step_s=0.001 --set "
        "wall.duration_s=1 --set wall.friction=0.5 --set 'wall.kind=a b'`",
        "energy from nowhere"}) {
    if (report.find(part) == std::string::npos) missing += std::string(part) + '\n';
  }
  EXPECT_EQ(missing, "") << report;
  EXPECT_LT(report.find("comparisons are lost"), report.find("### energy"));
}

TEST(Table, NeverWiderThanTheTerminalAndColouredOnlyOnDemand) {
  const Block block = summarize(rows()).front();
  const Table table = to_table(block);
  for (const std::size_t width : {200U, 40U, 24U}) {
    std::istringstream lines(to_terminal(table, {.width = width, .colour = false}));
    std::size_t longest = 0;
    for (std::string line; std::getline(lines, line);) longest = std::max(longest, line.size());
    EXPECT_LE(longest, width);
    EXPECT_GT(longest, 10U);
  }
  EXPECT_EQ(to_terminal(table, {.width = 80, .colour = false}).find('\033'), std::string::npos);
  EXPECT_NE(to_terminal(table, {.width = 80, .colour = true}).find("\033[31mdiverged"),
            std::string::npos);
}

TEST(Table, NumbersStandUnderEachOther) {
  const std::string text =
      to_terminal(to_table(summarize(rows()).front()), {.width = 80, .colour = false});
  EXPECT_EQ(text,
            "engine  created_j  reached_m   final_j\n"
            "ours/v          3          9         1\n"
            "a/v             1          1         5\n"
            "b/v             2          2         5\n"
            "c/v      diverged   diverged  diverged\n");
}

TEST(Table, LeavesOutWhatDoesNotApplyAnywhere) {
  std::vector<Row> all = {row("a", "speed_mps", "neither", {}),
                          row("b", "speed_mps", "neither", {})};
  for (Row& r : all) r.outcome = "not_applicable";
  EXPECT_TRUE(to_table(summarize(all).front()).rows.empty());
}

}  // namespace
}  // namespace brickbench::testing
