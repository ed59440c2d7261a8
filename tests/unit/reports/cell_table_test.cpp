// Tables for analysis: a column per axis, a line per number or per cell.
#include "reports/src/cell_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace brickbench::testing {
namespace {

ReportSource two_cells() {
  ReportSource source;
  source.name = "folder";
  const auto add = [&](const std::string& engine, const std::string& axes,
                       const std::string& metric, std::optional<double> value,
                       const std::string& outcome) {
    Row row;
    row.experiment = "wall";
    row.cell = engine + axes;
    row.engine = engine;
    row.variant = "v";
    row.step_s = 0.5;
    row.axes = axes;
    row.metric = metric;
    row.unit = "m";
    row.value = value;
    row.outcome = outcome;
    row.state_hash = outcome == "refused" ? "" : "00ff";
    source.rows.push_back(row);
  };
  add("ant", "friction=0.3;kind=a,b", "depth_m", 1.5, "ok");
  add("ant", "friction=0.3;kind=a,b", "fall_m", {}, "not_applicable");
  add("bee", "friction=0.5", "depth_m", {}, "refused");
  source.rows.back().validity = "";
  return source;
}

std::size_t column(const FlatTable& table, const std::string& name) {
  return static_cast<std::size_t>(std::ranges::find(table.header, name) - table.header.begin());
}

TEST(CellTable, EveryAxisIsAColumn) {
  const std::vector<ReportSource> sources = {two_cells()};
  const FlatTable flat = long_table(cell_table(sources));
  ASSERT_EQ(flat.rows.size(), 4u);  // two cells, two numbers
  EXPECT_EQ(flat.rows[0][column(flat, "friction")], "0.3");
  EXPECT_EQ(flat.rows[3][column(flat, "friction")], "0.5");
  EXPECT_EQ(flat.rows[3][column(flat, "kind")], "");
  EXPECT_TRUE(flat.is_number[column(flat, "friction")]);
  EXPECT_FALSE(flat.is_number[column(flat, "kind")]);
  EXPECT_EQ(flat.rows[0][column(flat, "value")], "1.5");
  EXPECT_EQ(flat.rows[1][column(flat, "value")], "");
}

TEST(CellTable, WideHasALinePerCellAndSaysHowItEnded) {
  const std::vector<ReportSource> sources = {two_cells()};
  const FlatTable wide = wide_table(cell_table(sources));
  ASSERT_EQ(wide.rows.size(), 2u);
  EXPECT_EQ(wide.rows[0][column(wide, "depth_m")], "1.5");
  EXPECT_EQ(wide.rows[0][column(wide, "fall_m")], "");
  EXPECT_EQ(wide.rows[0][column(wide, "outcome")], "ok")
      << "a number that the scene has not is no end";
  EXPECT_EQ(wide.rows[1][column(wide, "outcome")], "refused");
  for (const auto& row : wide.rows) EXPECT_EQ(row.size(), wide.header.size());
  EXPECT_EQ(wide.is_number.size(), wide.header.size());
}

TEST(CellTable, FieldsWithCommasAreQuoted) {
  const std::vector<ReportSource> sources = {two_cells()};
  const std::string csv = to_csv(wide_table(cell_table(sources)));
  EXPECT_NE(csv.find(",\"a,b\","), std::string::npos) << csv;
  EXPECT_EQ(std::ranges::count(csv, '\n'), 3);
}

}  // namespace
}  // namespace brickbench::testing
