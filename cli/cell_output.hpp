// Cells of `validate` as lines, as JSON and as commands.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiments/exact/validation/scan.hpp"

namespace brickbench {

// A cell with what it was asked for.
struct JudgedCell {
  exact::CellResult cell;
  ParameterValues given;                          // of the case; the rest are its defaults
  const exact::OpenQuestion* question = nullptr;  // that this cell belongs to
  exact::Verdict verdict = exact::Verdict::open;
  std::string reproduce;  // the command that shows this cell alone
};

// `brickbench validate` for one cell; `knobs` as typed.
std::string reproduce_cell(const exact::CellResult& cell, const ParameterValues& given,
                           const std::vector<std::string>& knobs);

nlohmann::ordered_json cell_json(const JudgedCell& judged);

void print_cell_header();
// The worst observable of a cell: error, explained and unexplained part, and how to see it again.
void print_cell(const JudgedCell& judged);

}  // namespace brickbench
