// One screen for a whole run: who is fast, who broke a law, what was refused.
#include "reports/src/engine_digest.hpp"

#include <gtest/gtest.h>

namespace brickbench::testing {
namespace {

struct Made {
  std::vector<Row> rows;
  std::vector<Timing> timings;
  std::map<std::string, double> edges;

  // One cell: its numbers and what it cost.
  void add(const std::string& engine, std::uint64_t seed,
           const std::vector<std::pair<std::string, double>>& numbers, double cpu_s) {
    Row row;
    row.experiment = "wall";
    row.cell = engine + std::to_string(seed);
    row.engine = engine;
    row.variant = "v";
    row.outcome = "ok";
    row.state_hash = "00ff";
    for (const auto& [metric, value] : numbers) {
      row.metric = metric;
      row.unit = metric.ends_with("_j") ? "J" : metric.ends_with("_m") ? "m" : "1";
      row.value = value;
      rows.push_back(row);
    }
    Timing timing;
    timing.cell = row.cell;
    timing.engine = engine;
    timing.variant = "v";
    timing.steps = 100;
    timing.step_s = 0.01;
    timing.steps_total_cpu_s = cpu_s;
    timing.outcome = "ok";
    timings.push_back(timing);
    edges[row.cell] = 0.1;
  }
  void end(const std::string& engine, const std::string& outcome, const std::string& reason,
           std::uint64_t seed) {
    Row row;
    row.experiment = "wall";
    row.cell = engine + outcome + std::to_string(seed);
    row.engine = engine;
    row.variant = "v";
    row.metric = "energy_created_j";
    row.outcome = outcome;
    row.reason = reason;
    rows.push_back(row);
  }
  std::vector<EngineDigest> digests() const { return engine_digests(rows, timings, edges); }
};

std::vector<std::pair<std::string, double>> numbers(double energy_share, double overlap_m) {
  return {{"energy_created_j", 1000.0 * energy_share},
          {"energy_created_relative", energy_share},
          {"penetration_max_m", overlap_m}};
}

TEST(EngineDigest, TheFastestComeFirstAndLawsAreJudgedByTheirScale) {
  Made made;
  made.add("slow", 0, numbers(1e-11, 0.9e-4), 2.0);  // rounding, and a contact that gives way
  made.add("fast", 0, numbers(5e-4, 0.02), 0.5);
  made.add("fast", 1, numbers(2e-3, 1e-6), 0.7);
  const auto engines = made.digests();
  ASSERT_EQ(engines.size(), 2u);
  EXPECT_EQ(engines[0].label, "fast/v");
  EXPECT_DOUBLE_EQ(engines[0].cost().value(), 0.6);
  EXPECT_TRUE(engines[1].breaches.empty());
  const auto lines = breach_lines(engines);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0], "Energy out of nothing: fast/v 2 J (0.2 %, 2 of 2 cells).");
  EXPECT_EQ(lines[1], "Bodies inside each other: fast/v 20 mm (1 of 2 cells).");
  const std::string line = fastest_line(engines);
  EXPECT_NE(line.find("Fastest: fast/v (600 ms of CPU"), std::string::npos) << line;
  EXPECT_NE(line.find("Fastest that broke no law: slow/v"), std::string::npos) << line;
}

TEST(EngineDigest, ABodyThatPassedThroughAnotherBrokeALawAndIsNotTimed) {
  Made made;
  made.add("ghost", 0, numbers(0.0, 0.0), 1.0);
  for (Row& row : made.rows) row.validity = "tunnelled in 1 of 100 steps from step 7";
  made.timings.front().validity = made.rows.front().validity;
  const auto engines = made.digests();
  EXPECT_FALSE(engines[0].cost().has_value());
  EXPECT_EQ(fastest_line(engines), "");
  EXPECT_EQ(breach_lines(engines), std::vector<std::string>{"Bodies through each other: ghost/v."});
  EXPECT_EQ(engine_table(engines, 9).rows[0].back().text, "passage");
}

TEST(EngineDigest, NobodyBrokeALawIsSaidOnlyOfRuns) {
  Made made;
  made.end("ant", "refused", "no spheres", 0);
  EXPECT_TRUE(breach_lines(made.digests()).empty());
  made.add("bee", 0, numbers(0.0, 0.0), 1.0);
  EXPECT_EQ(breach_lines(made.digests()).size(), 1u);
}

TEST(EngineDigest, EndingsAreCountedFailuresFirstAndFolded) {
  Made made;
  for (std::uint64_t i = 0; i < 3; ++i) made.end("ant", "refused", "no spheres", i);
  made.end("bee", "diverged", "body 'x' is not finite", 0);
  made.end("cow", "refused", "no bounce", 0);
  const auto all = ending_lines(made.rows, 9);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0], "bee/v diverged in 1 cell, wall: body 'x' is not finite");
  EXPECT_EQ(all[1], "ant/v refused in 3 cells, the first wall: no spheres");
  const auto few = ending_lines(made.rows, 2);
  ASSERT_EQ(few.size(), 2u);
  EXPECT_TRUE(few.back().ends_with("... and 1 more kinds of ending")) << few.back();
}

}  // namespace
}  // namespace brickbench::testing
