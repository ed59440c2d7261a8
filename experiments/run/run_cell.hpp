// Runs one cell in this process. Whatever the engine does short of ending the process, the cell
// yields a row for every number that was asked for, with an outcome and a reason.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/record/provenance.hpp"
#include "experiments/record/row.hpp"
#include "experiments/record/series.hpp"
#include "experiments/record/timing.hpp"
#include "experiments/run/cell.hpp"

namespace brickbench {

// Where the rows come from; stands in each of them.
struct Origin {
  std::string revision;
  std::string machine;
};

struct CellResult {
  std::vector<Row> rows;
  std::vector<SeriesPoint> series;
  Timing timing;
  std::string outcome;  // "ok", "excluded" or a word of to_outcome()
  std::string reason;
  std::string validity = {};    // as in Row
  MethodRecord method = {};     // empty where nothing was built
  std::string unrecorded = {};  // why the trajectory that was asked for is missing; else empty
};

// The largest number of points of a curve of one cell.
inline constexpr std::size_t k_series_points = 200;

// Called after every step with the share of the cell that is done, 0..1; false stops the cell as
// timed out.
using StepCallback = std::function<bool(double)>;

// The word of the column `better`.
std::string_view better_word(Better better);

// `folder`: the results folder, where the trajectory goes if the cell has a `recording`; empty:
// nothing is recorded. That a recording fails is no failure of the cell.
CellResult run_cell(const Cell& cell, const Catalogues& catalogues, const Origin& origin,
                    const StepCallback& after_step = {}, const std::filesystem::path& folder = {});

// The rows of a cell that could not be run to its end: one for every number that was asked for,
// without value. Also for parents of isolated cells whose process ended.
CellResult failed_cell(const Cell& cell, const Catalogues& catalogues, const Origin& origin,
                       const std::string& outcome, const std::string& reason);

}  // namespace brickbench
