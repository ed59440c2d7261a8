// Figures for papers: what is averaged, what is refused, how axes are named and what is drawn.
#include "reports/src/paper_figure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace brickbench::testing {
namespace {

// Engines at steps and frictions, `starts` runs each, value 0.01 m per start beyond 0.02 m.
CellTable many_cells(std::size_t starts = 8) {
  CellTable table;
  table.axes = {"friction"};
  table.numbers = {{"penetration_max_m", "m", ""}, {"energy_final_j", "J", ""}};
  for (const char* engine : {"ant/v", "bee/v"}) {
    for (const double step_s : {0.004, 0.002}) {
      for (const char* friction : {"0.3", "0.5"}) {
        for (std::uint64_t seed = 1; seed <= starts; ++seed) {
          CellLine line;
          line.experiment = "wall";
          line.engine = engine;
          line.step_s = step_s;
          line.seed = seed;
          line.axes["friction"] = friction;
          line.outcome = "ok";
          line.numbers["penetration_max_m"] = 0.02 + 0.01 * static_cast<double>(seed) / 10.0;
          line.numbers["energy_final_j"] = 100.0;
          table.lines.push_back(line);
        }
      }
    }
  }
  return table;
}

FigureAsk ask() { return {.y = "penetration_max_m", .facet = "friction"}; }

TEST(PaperFigure, PointsAreMeansOfTheRunsWithIntervals) {
  const auto figure = paper_figure(many_cells(), ask());
  ASSERT_TRUE(figure.has_value()) << figure.error().reason;
  ASSERT_EQ(figure->panels.size(), 2u);
  EXPECT_EQ(figure->panels[0].facet, "0.3");
  ASSERT_EQ(figure->panels[0].curves.size(), 2u);
  const PaperCurve& curve = figure->panels[0].curves[0];
  ASSERT_EQ(curve.points.size(), 2u);
  EXPECT_EQ(curve.points[0].x, 0.002) << "in the order of x";
  EXPECT_NEAR(curve.points[0].mean, 0.0245, 1e-15);
  EXPECT_EQ(curve.points[0].runs.size(), 8u);
  EXPECT_LT(curve.points[0].low, curve.points[0].mean);
  EXPECT_GT(curve.points[0].low, 0.021);
  EXPECT_NE(figure->caption.find("means of 8 runs. Bars: 95 % bootstrap"), std::string::npos)
      << figure->caption;
}

TEST(PaperFigure, FewRunsHaveTheirRangeAndSingleOnesNoBar) {
  const auto few = paper_figure(many_cells(3), ask());
  EXPECT_DOUBLE_EQ(few->panels[0].curves[0].points[0].low, 0.021);
  EXPECT_NE(few->caption.find("of fewer than 8 runs their range"), std::string::npos);
  const auto single = paper_figure(many_cells(1), ask());
  EXPECT_EQ(single->panels[0].curves[0].points[0].low, single->panels[0].curves[0].points[0].high);
  EXPECT_EQ(single->caption, "Points: single runs.");
}

TEST(PaperFigure, WhatWouldBeAveragedTogetherIsRefused) {
  FigureAsk without = ask();
  without.facet.clear();
  const auto mixed = paper_figure(many_cells(), without);
  ASSERT_FALSE(mixed.has_value());
  EXPECT_EQ(mixed.error().fault, Fault::invalid);
  EXPECT_NE(mixed.error().reason.find("differ in friction (0.3, 0.5)"), std::string::npos)
      << mixed.error().reason;
  without.where = {{"friction", "0.5"}};
  EXPECT_TRUE(paper_figure(many_cells(), without).has_value());
  FigureAsk of_friction = ask();
  of_friction.group = "friction";
  of_friction.facet.clear();
  EXPECT_FALSE(paper_figure(many_cells(), of_friction).has_value()) << "two engines in one curve";
}

TEST(PaperFigure, FlaggedAndMissingRunsAreLeftOutAndCounted) {
  CellTable table = many_cells(9);
  table.lines[0].validity = "unsolved in 1 of 9 steps from step 3";
  table.lines[9].numbers["penetration_max_m"] = std::numeric_limits<double>::infinity();
  table.lines[10].numbers.clear();
  const auto figure = paper_figure(table, ask());
  EXPECT_NE(figure->caption.find("1 flagged runs, 2 without a finite number"), std::string::npos)
      << figure->caption;
  EXPECT_EQ(figure->panels[0].curves[0].points[1].runs.size(), 8u);
}

TEST(PaperFigure, MoreCurvesThanCanBeToldApartAreRefused) {
  CellTable table = many_cells(1);
  for (int i = 0; i < 9; ++i) {
    CellLine line = table.lines.front();
    line.engine = "engine" + std::to_string(i) + "/v";
    table.lines.push_back(line);
  }
  const auto figure = paper_figure(table, ask());
  ASSERT_FALSE(figure.has_value());
  EXPECT_NE(figure.error().reason.find("11 curves"), std::string::npos) << figure.error().reason;
}

TEST(PaperFigure, LogarithmicAxesRefuseWhatTheyCannotShow) {
  FigureAsk logarithmic = ask();
  logarithmic.log_y = true;
  CellTable table = many_cells();
  EXPECT_TRUE(paper_figure(table, logarithmic).has_value());
  for (CellLine& line : table.lines) line.numbers["penetration_max_m"] = 0.0;
  EXPECT_FALSE(paper_figure(table, logarithmic).has_value());
}

TEST(PaperFigure, AxesAreNamedForPeopleWithAUnitThatFits) {
  const auto label = [](const char* name, const char* unit, double largest) {
    return paper_axis(name, unit, largest).label;
  };
  EXPECT_EQ(label("penetration_max_m", "m", 0.02), "Largest penetration / mm");
  EXPECT_EQ(label("penetration_max_m", "m", 2e-5), "Largest penetration / um");
  EXPECT_EQ(label("rubble_height_m", "m", 0.6), "Rubble height / m");
  EXPECT_EQ(label("energy_final_j", "J", 300.0), "Energy at the end / J");
  EXPECT_EQ(label("energy_created_relative", "1", 1e-3), "Energy created, relative");
  EXPECT_EQ(label("step_s", "s", 0.004), "Step / ms");
  EXPECT_EQ(label("friction", "1", 0.5), "Friction");
  EXPECT_EQ(paper_axis("step_s", "s", 0.004).factor, 1e3);
}

TEST(PaperFigure, ACurveLooksTheSameInEveryPanelAndStandsOnceInTheKey) {
  CellTable table = many_cells();
  std::erase_if(table.lines, [](const CellLine& line) {
    return line.engine == "ant/v" && line.axes.at("friction") == "0.3";
  });
  const auto figure = paper_figure(table, ask());
  EXPECT_EQ(figure->panels[0].curves[0].style, figure->panels[1].curves[1].style);
  const std::string script = to_gnuplot(*figure, PaperFormat::pdf, "out", 8.6);
  EXPECT_EQ(script, to_gnuplot(*figure, PaperFormat::pdf, "out", 8.6));
  std::size_t titles = 0;
  for (std::size_t at = script.find("NaN with"); at != std::string::npos;
       at = script.find("NaN with", at + 1))
    ++titles;
  EXPECT_EQ(titles, 2u);
  EXPECT_NE(script.find("'Largest penetration / mm'"), std::string::npos);
  EXPECT_NE(script.find("'Friction: 0.3'"), std::string::npos);
  const std::string csv = to_csv(*figure);
  EXPECT_EQ(std::ranges::count(csv, '\n'), 7);
  EXPECT_NE(csv.find("\n0.5,ant/v,0.002,"), std::string::npos) << csv;
}

TEST(PaperFigure, AnAxisOfWordsHasATickForEach) {
  FigureAsk of_engines = ask();
  of_engines.x = "engine";
  of_engines.group = "friction";
  of_engines.facet = "step_s";
  const auto figure = paper_figure(many_cells(), of_engines);
  ASSERT_TRUE(figure.has_value()) << figure.error().reason;
  EXPECT_EQ(figure->categories, (std::vector<std::string>{"ant/v", "bee/v"}));
  EXPECT_NE(to_gnuplot(*figure, PaperFormat::svg, "out", 8.6).find("('ant/v' 1, 'bee/v' 2)"),
            std::string::npos);
}

}  // namespace
}  // namespace brickbench::testing
