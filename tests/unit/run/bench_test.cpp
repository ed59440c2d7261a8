// Bench: whose time is compared with whose, in which order, and what is told of it.
#include "experiments/run/bench.hpp"

#include <gtest/gtest.h>

#include "tests/support/dubious_engine.hpp"

namespace brickbench::testing {
namespace {

constexpr const char* k_two_scenes = R"(
title = "t"
[bench]
base = "good"
repeat = 2
[[experiment]]
name = "one"
scenario = "fall"
engines = ["failer", "good", "good/fancy", "nan"]
step_s = 0.01
[[experiment]]
name = "two"
scenario = "fall"
engines = ["good/fancy"]
step_s = 0.01
parameters = { balls = 2 }
)";

struct Benched {
  BenchResult result;
  std::vector<std::string> order;  // engines as they were run
};

Benched bench_text(const std::string& text, const Catalogues& catalogues = fake_catalogues()) {
  const auto plan = parse_plan(text, "p.toml", catalogues);
  EXPECT_TRUE(plan.has_value()) << plan.error().text();
  const auto cells = expand(*plan, catalogues);
  EXPECT_TRUE(cells.has_value()) << cells.error().text();
  Benched benched;
  RunCallbacks callbacks;
  callbacks.cell_begins = [&](const Cell& cell, std::size_t) {
    benched.order.push_back(cell.experiment + ':' + cell.engine.label());
  };
  benched.result = bench_cells(*cells, plan->bench->base, plan->bench->repeat, catalogues,
                               {"rev", "machine"}, callbacks);
  return benched;
}

TEST(Bench, RoundsAlternateTheEnginesOfAScene) {
  const std::vector<std::string> round = {"one:failer/plain", "one:good/plain", "one:good/fancy",
                                          "one:nan/plain"};
  std::vector<std::string> expected = round;
  expected.insert(expected.end(), round.begin(), round.end());
  expected.insert(expected.end(), {"two:good/fancy", "two:good/fancy"});
  EXPECT_EQ(bench_text(k_two_scenes).order, expected);
}

TEST(Bench, OnlyWhatRanBesideTheBaseHasARatio) {
  const BenchResult result = bench_text(k_two_scenes).result;
  std::vector<std::string> told;
  for (const BenchEntry& entry : result.entries) {
    told.push_back(entry.cell.experiment + ' ' + entry.cell.engine.label() + ' ' + entry.outcome +
                   (entry.is_base ? " base" : "") + (entry.cost ? " cost" : "") +
                   (entry.ratio ? " ratio" : "") + (entry.repeatable ? "" : " unrepeatable"));
  }
  const std::vector<std::string> expected = {
      "one failer/plain crashed", "one good/plain ok base cost ratio",
      "one good/fancy ok cost ratio", "one nan/plain diverged", "two good/fancy ok cost"};
  EXPECT_EQ(told, expected);
}

TEST(Bench, TheTimeOfAFlaggedRunIsToldAndNotCompared) {
  const std::string plan = R"(
title = "t"
[bench]
base = "BASE"
repeat = 2
[[experiment]]
scenario = "fall"
engines = ["good", "good/fancy", "unsolved", "clamped"]
step_s = 0.01
)";
  for (const std::string base : {"good", "unsolved"}) {
    std::string text = plan;
    const BenchResult result =
        bench_text(text.replace(text.find("BASE"), 4, base), dubious_catalogues()).result;
    for (const BenchEntry& entry : result.entries) {
      const std::string& engine = entry.cell.engine.engine;
      EXPECT_TRUE(entry.cost.has_value());
      EXPECT_EQ(entry.ratio.has_value(), engine == "good" && base == "good") << engine;
      EXPECT_EQ(entry.validity, engine == "good" ? "" : engine + " in 3 of 10 steps from step 4");
    }
  }
}

TEST(Bench, TheBaseIsExactlyItselfAndRowsComeOnce) {
  const BenchResult result = bench_text(k_two_scenes).result;
  const Spread ratio = result.entries[1].ratio.value_or(Spread{});
  EXPECT_EQ((std::vector<double>{ratio.least, ratio.median, ratio.most}),
            (std::vector<double>{1.0, 1.0, 1.0}));
  // Four numbers of the metric for each of five cells, ten runs timed.
  EXPECT_EQ(result.runs.rows.size(), 20U);
  EXPECT_EQ(result.runs.timings.size(), 10U);
}

TEST(Bench, SpreadIsMedianLeastAndMost) {
  const Spread odd = spread_of({5.0, 1.0, 2.0});
  const Spread even = spread_of({4.0, 1.0, 2.0, 10.0});
  EXPECT_EQ((std::vector<double>{odd.median, odd.least, odd.most}),
            (std::vector<double>{2.0, 1.0, 5.0}));
  EXPECT_EQ((std::vector<double>{even.median, even.least, even.most}),
            (std::vector<double>{3.0, 1.0, 10.0}));
}

TEST(Bench, APlanSaysWhatItWantsOrIsRejectedWithItsPlace) {
  const Catalogues catalogues = fake_catalogues();
  const std::string tail =
      "[[experiment]]\nscenario = \"fall\"\nengines = \"good\"\nstep_s = 0.01\n";
  std::vector<std::string> complaints;
  for (const char* bench :
       {"[bench]\nrepeat = 2\n", "[bench]\nbase = \"goood\"\n",
        "[bench]\nbase = \"good\"\nrepeat = 0\n", "[bench]\nbase = \"good\"\nrounds = 2\n"}) {
    const auto plan = parse_plan("title = \"t\"\n" + (bench + tail), "p.toml", catalogues);
    complaints.push_back(plan ? "accepted" : plan.error().text().substr(0, 9));
  }
  const std::vector<std::string> expected = {"p.toml:2:", "p.toml:3:", "p.toml:4:", "p.toml:4:"};
  EXPECT_EQ(complaints, expected);
}

}  // namespace
}  // namespace brickbench::testing
