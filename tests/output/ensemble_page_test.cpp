// Ensembles in reports: who is compared with whom, what figures and files hold, golden bytes and
// escaping. The samples are made by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include "experiments/record/file.hpp"
#include "reports/src/ensemble_report.hpp"
#include "reports/src/ensemble_words.hpp"
#include "reports/src/html_report.hpp"

namespace brickbench::testing {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_hostile_page = "<script>alert('x')</script>&\"|";
constexpr std::size_t k_starts = 21;

void add_run(ReportSource& source, const std::string& engine, const std::string& axes,
             std::uint64_t start, double value) {
  Row row;
  row.experiment = "wall";
  row.cell = engine + axes + std::to_string(start);
  row.scenario = "brick_wall";
  row.engine = engine;
  row.variant = "v";
  row.step_s = 0.001;
  row.duration_s = 1.0;
  row.seed = start;
  row.axes = axes;
  row.group = "outcomes";
  row.metric = "rubble_height_m";
  row.unit = "m";
  row.better = "neither";
  row.value = value;
  row.outcome = "ok";
  row.state_hash = "00ff";
  source.rows.push_back(row);
  SeriesPoint point;
  point.experiment = "wall";
  point.cell = row.cell;
  point.engine = engine;
  point.variant = "v";
  point.step_s = 0.001;
  point.curve = "kinetic_energy_j";
  point.unit = "J";
  for (const double time_s : {0.0, 0.5, 1.0}) {
    point.time_s = time_s;
    point.value = value * (1.0 - time_s / 2.0);
    source.series.push_back(point);
  }
}

// The values of start n are `at` + n; the starts come in descending order.
ReportSource source(const std::vector<std::pair<std::string, double>>& engines,
                    const std::string& axes, std::size_t starts = k_starts) {
  ReportSource source;
  source.name = "folder";
  for (const auto& [engine, at] : engines) {
    for (std::size_t n = starts; n > 0; --n) {
      add_run(source, engine, axes, n, at + static_cast<double>(n));
    }
  }
  return source;
}

// Verdicts as a judge would set them.
void pretend(Ensembles& ensembles) {
  for (EnsemblePair& pair : ensembles.pairs) {
    EnsembleVerdict& v = pair.verdict;
    v.difference = pair.judged.values.front() - pair.reference.values.front();
    v.low = v.difference - 0.5;
    v.high = v.difference + 0.5;
    v.margin = 0.25;
    v.p_value = v.difference > 5.0 ? 0.0001 : 0.4;
    v.word = v.difference > 5.0 ? EnsembleWord::different : EnsembleWord::not_enough_runs;
    v.more_for_difference = v.difference > 5.0 ? 0 : 30;
    v.more_for_same = v.difference > 5.0 ? 0 : 12345;
  }
}

TEST(Ensembles, QuantilesInterpolateBetweenOrderStatistics) {
  EXPECT_EQ(quantile({1.0, 2.0, 3.0, 4.0}, 0.25), 1.75);
  EXPECT_EQ(quantile({1.0, 2.0, 3.0, 4.0}, 1.0), 4.0);
  EXPECT_EQ(quantile({7.0}, 0.05), 7.0);
}

TEST(Ensembles, EnginesOfOneFolderAreComparedWithTheFirstOrTheOneAskedFor) {
  const auto folder = source({{"ant", 0.0}, {"bee", 1.0}, {"cow", 2.0}}, "friction=0.5");
  const Ensembles first = ensembles_within(folder, "");
  ASSERT_EQ(first.pairs.size(), 2u);
  EXPECT_EQ(first.pairs[0].reference.label, "ant/v");
  EXPECT_EQ(first.pairs[1].judged.label, "cow/v");
  EXPECT_EQ(first.pairs[0].judged.values.front(), 2.0);  // start 1 although it came last
  const Ensembles asked = ensembles_within(folder, "bee/v");
  ASSERT_EQ(asked.pairs.size(), 2u);
  EXPECT_EQ(asked.pairs[0].reference.label, "bee/v");
  EXPECT_EQ(asked.pairs[0].judged.label, "ant/v");
}

TEST(Ensembles, FewStartsAreNoEnsembleAndLostOnesAreCounted) {
  EXPECT_TRUE(ensembles_within(source({{"ant", 0.0}, {"bee", 1.0}}, "a=1", k_least_starts - 1), "")
                  .pairs.empty());
  auto folder = source({{"ant", 0.0}, {"bee", 1.0}}, "a=1");
  folder.rows.back().value.reset();
  folder.rows[folder.rows.size() - 2].value = std::numeric_limits<double>::infinity();
  const Ensembles ensembles = ensembles_within(folder, "");
  ASSERT_EQ(ensembles.pairs.size(), 1u);
  EXPECT_EQ(ensembles.pairs[0].judged.values.size(), k_starts - 2);
  EXPECT_EQ(ensembles.pairs[0].judged.without_value, 2u);
  const auto lines = ensemble_headline(ensembles);
  EXPECT_NE(lines.back().find("2 values are missing"), std::string::npos) << lines.back();
}

TEST(Ensembles, FoldersPairEnginesAlsoWhereAnAxisWasSetDifferently) {
  const auto before = source({{"ant", 0.0}, {"bee", 1.0}}, "friction=0.5");
  const auto after = source({{"ant", 3.0}}, "friction=0.475");
  const Ensembles ensembles = ensembles_between(before, after, "old", "new");
  ASSERT_EQ(ensembles.pairs.size(), 1u);
  EXPECT_EQ(ensembles.pairs[0].subject, "ant/v");
  EXPECT_EQ(ensembles.pairs[0].reference.label, "old");
  EXPECT_EQ(ensembles.pairs[0].reference.values.front(), 1.0);
  EXPECT_EQ(ensembles.pairs[0].judged.values.front(), 4.0);
  ASSERT_EQ(ensembles.fans.size(), 1u);
  EXPECT_EQ(ensembles.fans[0].fans.size(), 2u);
}

TEST(Ensembles, FansHoldTheQuantilesAtEachTime) {
  const Ensembles ensembles =
      ensembles_within(source({{"ant", -1.0}, {"bee", 1.0}}, "friction=0.5"), "");
  ASSERT_EQ(ensembles.fans.size(), 1u);
  const Fan& fan = ensembles.fans[0].fans[0];  // 0, 1 ... 20, halved at the end
  EXPECT_EQ(fan.runs, k_starts);
  EXPECT_EQ(fan.time_s, (std::vector<double>{0.0, 0.5, 1.0}));
  EXPECT_EQ(fan.q05, (std::vector<double>{1.0, 0.75, 0.5}));
  EXPECT_EQ(fan.q25, (std::vector<double>{5.0, 3.75, 2.5}));
  EXPECT_EQ(fan.median, (std::vector<double>{10.0, 7.5, 5.0}));
  EXPECT_EQ(fan.q95, (std::vector<double>{19.0, 14.25, 9.5}));
}

TEST(Ensembles, DistributionsAreStaircasesFromZeroToOne) {
  Ensembles ensembles = ensembles_within(source({{"ant", 0.0}, {"bee", 1.0}}, "a=1"), "");
  pretend(ensembles);
  Palette palette;
  const auto figures = distribution_figures(ensembles, palette, "");
  ASSERT_EQ(figures.size(), 1u);
  for (const Curve& curve : figures[0].curves) {
    EXPECT_EQ(curve.y.front(), 0.0);
    EXPECT_EQ(curve.y.back(), 1.0);
    EXPECT_TRUE(std::ranges::is_sorted(curve.x));
    EXPECT_TRUE(std::ranges::is_sorted(curve.y));
  }
}

TEST(Ensembles, OneMeasurementInTwoUnitsIsOnePair) {
  auto folder = source({{"ant", 0.0}, {"bee", 1.0}}, "a=1");
  const std::size_t count = folder.rows.size();
  for (std::size_t i = 0; i < count; ++i) {
    folder.rows.push_back(folder.rows[i]);
    folder.rows.back().metric = "rubble_height_relative";
  }
  const Ensembles ensembles = ensembles_within(folder, "");
  ASSERT_EQ(ensembles.pairs.size(), 1u);
  EXPECT_EQ(ensembles.pairs[0].number, "rubble_height_m");
}

TEST(Ensembles, VerdictsNameWhoDiffersFromWhom) {
  Ensembles ensembles =
      ensembles_within(source({{"ant", 0.0}, {"bee", 1.0}, {"cow", 9.0}}, "a=1"), "");
  pretend(ensembles);
  EXPECT_EQ(
      verdict_sentence(ensembles.pairs[0]),
      "open: a difference of this size would be shown by 30 more runs of each, 'same within 5 "
      "%' by over 10000");
  EXPECT_EQ(verdict_sentence(ensembles.pairs[1]), "different: cow/v has more than ant/v");
  EnsemblePair pair = ensembles.pairs[1];
  pair.better = "lower";
  EXPECT_EQ(verdict_sentence(pair), "different: cow/v has more than ant/v (worse)");
  pair.subject = "cow/v";
  pair.reference.label = "before";
  pair.judged.label = "after";
  pair.verdict.difference = -1.0;
  EXPECT_EQ(verdict_sentence(pair),
            "different: cow/v in after has less than cow/v in before (better)");
  const auto header = ensemble_table(ensembles).header;
  EXPECT_EQ(std::ranges::count(header, "was") + std::ranges::count(header, "is"), 0);
}

TEST(Ensembles, IdenticalOnesNeedNoRowAndNoFigure) {
  Ensembles ensembles = ensembles_within(source({{"ant", 0.0}, {"bee", 0.0}}, "a=1"), "");
  ASSERT_EQ(ensembles.pairs.size(), 1u);
  ensembles.pairs[0].verdict.word = EnsembleWord::identical;
  Palette palette;
  EXPECT_TRUE(ensemble_table(ensembles).rows.empty());
  EXPECT_TRUE(distribution_figures(ensembles, palette, "").empty());
  EXPECT_TRUE(fan_figures(ensembles, palette, "").empty());
  EXPECT_NE(ensemble_headline(ensembles).front().find("1 identical"), std::string::npos);
}

// After a wanted change: BRICKBENCH_BLESS=1 ctest -R output_page
TEST(Ensembles, GoldenBytes) {
  Ensembles ensembles =
      ensembles_within(source({{"ant", 0.0}, {"bee", 1.0}, {"cow", 9.0}}, "friction=0.5"), "");
  pretend(ensembles);
  Palette palette;
  auto files = ensemble_files(ensembles, palette, "");
  files.push_back({"ensembles.md", markdown_ensembles(ensembles, palette, "")});
  files.push_back({"ensembles.html", html_ensembles(ensembles, palette, "")});
  EXPECT_EQ(files.size(), 8u);  // two tables, a distribution and a fan twice each, two documents
  const fs::path golden = "tests/output/golden/ensembles";
  const bool bless = std::getenv("BRICKBENCH_BLESS") != nullptr;
  std::string wrong;
  for (const OutputFile& file : files) {
    const fs::path name = golden / fs::path(file.name).filename();
    if (bless) {
      fs::create_directories(golden);
      std::ofstream(name, std::ios::binary) << file.content;
    }
    const auto expected = read_file(name);
    if (!expected || *expected != file.content) wrong += file.name + ' ';
  }
  EXPECT_EQ(wrong, "");
}

TEST(Ensembles, EveryDrawnFigureCanBecomeAPdf) {
  const std::vector<ReportSource> sources = {source({{"ant", 0.0}, {"bee", 1.0}}, "friction=0.5")};
  ReportOptions options;
  options.ensembles.push_back(ensembles_within(sources.front(), ""));
  pretend(options.ensembles.front());
  std::vector<std::string> drawn, figures;
  for (const OutputFile& file : report_files(sources, PageAssets{}, options)) {
    const fs::path name = file.name;
    if (name.extension() == ".svg") drawn.push_back(name.stem());
  }
  std::size_t bands = 0;
  for (const Figure& figure : report_figures(sources, options)) {
    figures.push_back(figure.id);
    const std::string script = to_gnuplot(figure, "data.csv", "out.pdf");
    for (std::size_t at = 0; (at = script.find("with filledcurves", at)) != std::string::npos; ++at)
      ++bands;
  }
  std::ranges::sort(drawn);
  std::ranges::sort(figures);
  EXPECT_EQ(drawn, figures);
  EXPECT_EQ(bands, 4u);  // of the fan: two engines, each 5 to 95 % and the middle half
}

TEST(Ensembles, InputIsEscaped) {
  auto folder =
      source({{"ant", 0.0}, {k_hostile_page, 1.0}}, std::string("wall=") + k_hostile_page);
  for (Row& row : folder.rows) {
    row.metric = k_hostile_page;
    row.unit = k_hostile_page;
    row.experiment = k_hostile_page;
  }
  for (SeriesPoint& point : folder.series) point.curve = point.unit = k_hostile_page;
  Ensembles ensembles = ensembles_within(folder, "");
  pretend(ensembles);
  ASSERT_EQ(ensembles.pairs.size(), 1u);
  ASSERT_EQ(ensembles.fans.size(), 1u);
  Palette palette;
  std::string all = html_ensembles(ensembles, palette, "");
  for (const OutputFile& file : ensemble_files(ensembles, palette, "")) {
    EXPECT_EQ(file.name.find_first_of("<>&\"'|"), std::string::npos) << file.name;
    if (file.name.ends_with(".svg")) all += file.content;
  }
  EXPECT_NE(all.find("&lt;script&gt;"), std::string::npos);
  EXPECT_EQ(all.find("<script"), std::string::npos);
  const std::string markdown = markdown_ensembles(ensembles, palette, "");
  EXPECT_EQ(markdown.find("\"|"), std::string::npos) << "a cell ends early";
}

}  // namespace
}  // namespace brickbench::testing
