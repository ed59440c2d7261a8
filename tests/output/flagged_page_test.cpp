// A run that is not to be trusted is seen to be so wherever a report shows it.
#include <gtest/gtest.h>

#include <algorithm>

#include "reports/src/figures.hpp"
#include "reports/src/flags.hpp"
#include "reports/src/html_report.hpp"
#include "reports/src/palette.hpp"
#include "reports/src/replay_source.hpp"

namespace brickbench::testing {
namespace {

constexpr const char* k_two_flags =
    "unsolved in 31 of 100 steps from step 60; tunnelled in 1 of 100 steps from step 40 ('a' "
    "through 'b')";

Row plain_row(const std::string& engine, double step_s) {
  Row row;
  row.experiment = "wall";
  row.cell = engine + shortest(step_s);
  row.scenario = "brick_wall";
  row.engine = engine;
  row.variant = "v";
  row.step_s = step_s;
  row.duration_s = 1.0;
  row.group = "penetration";
  row.metric = "penetration_max_m";
  row.unit = "m";
  row.better = "lower";
  row.value = 0.001;
  row.outcome = "ok";
  row.state_hash = "00ff";
  return row;
}

void add_curve(ReportSource& source, const Row& row) {
  for (const double time_s : {0.0, 0.2, 0.39, 0.4, 1.0}) {
    SeriesPoint point;
    point.experiment = row.experiment;
    point.cell = row.cell;
    point.engine = row.engine;
    point.variant = row.variant;
    point.step_s = row.step_s;
    point.curve = "total_energy_j";
    point.unit = "J";
    point.time_s = time_s;
    point.value = 3.0 - time_s;
    source.series.push_back(point);
  }
}

// One sound engine, one with flags, one that blew up; two steps each.
ReportSource mixed_source() {
  ReportSource source;
  source.provenance.title = "mixed";
  source.provenance.plan = "plan.toml";
  for (const std::string engine : {"sound", "flagged", "gone"}) {
    for (const double step_s : {0.01, 0.005}) {
      Row row = plain_row(engine, step_s);
      if (engine == "flagged") row.validity = k_two_flags;
      if (engine == "gone") {
        row.value.reset();
        row.state_hash.clear();
        row.outcome = "blown_up";
        row.reason = "after step 7";
      } else {
        add_curve(source, row);
      }
      source.rows.push_back(row);
      Timing timing;
      timing.experiment = row.experiment;
      timing.cell = row.cell;
      timing.engine = engine;
      timing.variant = "v";
      timing.step_s = step_s;
      timing.steps = 100;
      timing.steps_total_cpu_s = 0.1;
      timing.outcome = row.outcome;
      timing.validity = row.validity;
      source.timings.push_back(timing);
    }
  }
  return source;
}

std::string file_named(const std::vector<OutputFile>& files, const std::string& name) {
  const auto found = std::ranges::find(files, name, &OutputFile::name);
  return found == files.end() ? "" : found->content;
}

TEST(Flags, AreReadFromTheWordsOfTheRows) {
  EXPECT_EQ(flag_words(k_two_flags), (std::vector<std::string>{"unsolved", "tunnelled"}));
  EXPECT_EQ(first_flagged_step(k_two_flags), 40U);
  EXPECT_TRUE(flag_words("").empty());
  EXPECT_EQ(first_flagged_step(""), 0U);
}

TEST(FlaggedPage, CurvesOverTimeAreMarkedInLegendFigureAndData) {
  Palette palette;
  const std::vector<Figure> figures = figures_over_time(mixed_source(), palette);
  ASSERT_EQ(figures.size(), 2U);
  const Figure& figure = figures.front();
  ASSERT_EQ(figure.curves.size(), 2U);
  EXPECT_FALSE(figure.curves[0].flagged_from.has_value());
  EXPECT_EQ(figure.curves[0].legend(), "sound/v");
  EXPECT_DOUBLE_EQ(figure.curves[1].flagged_from.value_or(-1.0), 0.4);
  const std::string svg = to_svg(figure, true);
  EXPECT_NE(svg.find("flagged/v !"), std::string::npos);
  std::size_t crosses = 0;
  for (std::size_t at = svg.find("class=\"flag\""); at != std::string::npos;
       at = svg.find("class=\"flag\"", at + 1)) {
    ++crosses;
  }
  EXPECT_EQ(crosses, 1U);
  const std::string csv = to_csv(figure);
  EXPECT_NE(csv.find("\"flagged/v\",0.39,2.61,,,0\n\"flagged/v\",0.4,2.6,,,1\n"), std::string::npos)
      << csv;
  EXPECT_NE(csv.find("\"sound/v\",1,2,,,0\n"), std::string::npos) << csv;
  EXPECT_NE(to_gnuplot(figure, "d.csv", "d.pdf").find("'#90"), std::string::npos);
  EXPECT_EQ(to_json(figure)["curves"][1].value("flagged_from", 0.0), 0.4);
  EXPECT_FALSE(to_json(figure)["curves"][0].contains("flagged_from"));
  EXPECT_EQ(figure.caption,
            std::string("Faint, with a cross at the first step: not to be trusted. flagged/v ") +
                k_two_flags + ". No curve of gone/v (blown_up). ");
}

TEST(FlaggedPage, FiguresOfErrorsSayWhoIsNotDrawn) {
  Palette palette;
  const ReportSource source = mixed_source();
  for (const auto& figures :
       {figures_against_step(source, palette), figures_against_cost(source, palette)}) {
    ASSERT_EQ(figures.size(), 1U);
    ASSERT_EQ(figures.front().curves.size(), 1U);
    EXPECT_EQ(figures.front().curves.front().label, "sound/v");
    EXPECT_TRUE(figures.front().caption.starts_with(
        "Not drawn: flagged/v at 0.01 s (unsolved, tunnelled !), gone/v at 0.01 s (blown_up), "
        "flagged/v at 0.005 s (unsolved, tunnelled !), gone/v at 0.005 s (blown_up). "))
        << figures.front().caption;
  }
}

TEST(FlaggedPage, PageAndTextListTheCellsWithTheCommandThatRepeatsThem) {
  const std::vector<ReportSource> sources = {mixed_source()};
  const auto files = report_files(sources, {});
  const std::string page = file_named(files, "index.html");
  const std::string text = file_named(files, "report.md");
  EXPECT_NE(page.find("<section id=\"flagged\"><h2>Cells whose numbers do not count</h2>"),
            std::string::npos);
  EXPECT_NE(page.find("! unsolved in 31 of 100 steps from step 60"), std::string::npos);
  EXPECT_NE(page.find("blown_up: after step 7"), std::string::npos);
  EXPECT_NE(page.find("2 of 2, 2 !"), std::string::npos) << "who was run";
  EXPECT_NE(text.find("## Cells whose numbers do not count"), std::string::npos);
  EXPECT_NE(text.find("--engine flagged/v"), std::string::npos) << text;
}

TEST(FlaggedPage, AReplayKeepsItsFlagWhenThinned) {
  Replay replay;
  replay.scene = "s";
  replay.engine = "flagged/v";
  replay.bodies = {{"b", ReplayShape::box, ReplayRole::brick, {0.1, 0.1, 0.1}}};
  for (int f = 0; f < 9; ++f) {
    replay.times_s.push_back(0.1 * f);
    replay.positions_m.insert(replay.positions_m.end(), {0.0, 0.0, 1.0});
    replay.orientations.insert(replay.orientations.end(), {1.0, 0.0, 0.0, 0.0});
  }
  EXPECT_FALSE(to_json(replay).contains("flagged_from"));
  replay.note = std::string("! ") + k_two_flags;
  replay.flagged_from_s = 0.4;
  const auto json = to_json(thinned(replay, 3));
  EXPECT_EQ(json.value("flagged_from", 0.0), 0.4);
  EXPECT_EQ(json.value("note", ""), replay.note);
}

}  // namespace
}  // namespace brickbench::testing
