// Runs all cells of a plan, one after the other, in this process.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/record/provenance.hpp"
#include "experiments/run/run_cell.hpp"

namespace brickbench {

// One line per cell: what became of it.
struct CellOutcome {
  Cell cell;
  std::string id;
  std::string outcome;
  std::string reason;
  double wall_s = 0.0;
  std::string unrecorded = {};  // as in CellResult
  std::string validity = {};    // as in CellResult
};

struct RunResult {
  std::vector<CellOutcome> cells;
  std::vector<Row> rows;
  std::vector<SeriesPoint> series;
  std::vector<Timing> timings;
  std::vector<MethodRecord> methods;  // each once, in the order of the cells
};

// Adds the method of a cell unless it is empty or there already.
void note_method(RunResult& result, MethodRecord method);

// What the watcher of a run is told. Either may be empty.
struct RunCallbacks {
  // Before each cell: which, and how many there are.
  std::function<void(const Cell&, std::size_t count)> cell_begins;
  // After each step; false stops the cell.
  StepCallback after_step;
  std::function<void(const CellOutcome&, std::size_t count)> cell_ends;
};

// `folder` as for run_cell().
RunResult run_cells(const std::vector<Cell>& cells, const Catalogues& catalogues,
                    const Origin& origin, const RunCallbacks& callbacks = {},
                    const std::filesystem::path& folder = {});

// Whether the outcome is a failure that the plan did not expect: diverged, crashed, timed out, out
// of memory, invalid, or another outcome than the expected one. A refusal is an answer, and an
// excluded cell was left out on purpose.
bool is_failure(const CellOutcome& cell);

// 0: no cell failed; 1 otherwise.
int exit_code(const RunResult& result);

// The engines and metrics of the catalogues as provenance keeps them; command, date and plan are
// the caller's.
Provenance provenance_of(const Plan& plan, const Catalogues& catalogues);

}  // namespace brickbench
