// Results as tables for analysis: every axis of the plan is a column of its own.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "reports/src/report_source.hpp"

namespace brickbench {

// One cell with all that was set and all that came out.
struct CellLine {
  std::string folder;  // the name of the results folder
  std::string experiment;
  std::string cell;
  std::string scenario;
  std::string engine;  // engine/variant
  double step_s = 0.0;
  double duration_s = 0.0;
  std::uint64_t seed = 0;
  std::map<std::string, std::string> axes;
  std::map<std::string, double> numbers;  // those that have a value, infinite ones too
  std::string outcome;                    // ok, or why the cell did not end
  std::string reason;
  std::string validity;
  std::optional<double> cpu_s;  // of the engine, over all steps
};

struct NumberName {
  std::string name;
  std::string unit;
  std::string meaning;  // empty where the folder does not say
};

// Cells in the order of the rows; names of axes sorted, names of numbers as they come.
struct CellTable {
  std::vector<std::string> axes;
  std::vector<NumberName> numbers;
  std::vector<CellLine> lines;

  const NumberName* find(const std::string& number) const;
};

CellTable cell_table(std::span<const ReportSource> sources);

// A table of text with a header; a column of numbers has nothing else but empty fields.
struct FlatTable {
  std::vector<std::string> header;
  std::vector<bool> is_number;
  std::vector<std::vector<std::string>> rows;
};

// One line per number of each cell: what was set, then number, unit and value; empty where the cell
// has no value.
FlatTable long_table(const CellTable& table);
// One line per cell: what was set, what became of it, then every number as a column.
FlatTable wide_table(const CellTable& table);

// As rows.csv is written.
std::string to_csv(const FlatTable& table);

}  // namespace brickbench
