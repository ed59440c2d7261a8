// Sweep: a folder that knows which cells it is made of.
//
//   sweep.json        what the sweep is: plan, overrides, provenance, headers of the tables
//   cells.<hash>.csv  its cells in the order of the plan
//   plan.toml         the plan, for people
//   cells/ab/*.cell   one result file per finished cell
//   logs/ab/*.log     what failed cells printed
//   trajectories/*.h5 the motion of the cells that the plan records
//   claims            empty; locks on its bytes say which cells are being run
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/record/planned_cell.hpp"
#include "experiments/record/provenance.hpp"
#include "experiments/run/cell.hpp"

namespace brickbench {

// What can be said of a sweep without its plan's catalogues: enough for status and merge.
struct Sweep {
  std::filesystem::path folder;
  std::string list;                // file name of the list of cells
  std::vector<PlannedCell> cells;  // in the order of the plan
  std::string rows_header;         // first line of the table of rows, without line end
  std::string timings_header;
  std::string series_header;
  std::string plan_text;
  Overrides overrides;
  Provenance provenance;
};

// The cells as the list of a sweep has them, with their ids.
std::vector<PlannedCell> planned_cells(const std::vector<Cell>& cells, const Catalogues& catalogues,
                                       const std::string& revision);

// Makes the folder of a new sweep, or finds that it is that of the same one: same cells, with the
// same program and engines. Any number of processes may do so at the same time. Fault::invalid
// with the difference if the folder belongs to another sweep, or holds anything else;
// Fault::crashed if the disk refuses.
Expected<Sweep> open_sweep(const std::filesystem::path& folder, const Plan& plan,
                           const Overrides& overrides, std::vector<PlannedCell> cells,
                           const Provenance& provenance);

// Fault::invalid if the folder is none of a sweep, or is damaged.
Expected<Sweep> read_sweep(const std::filesystem::path& folder);

}  // namespace brickbench
