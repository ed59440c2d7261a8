// Inventory: what the folder of a sweep holds, found by reading and checking every result file.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/sweep/result_file.hpp"
#include "experiments/sweep/shard.hpp"
#include "experiments/sweep/sweep.hpp"

namespace brickbench {

// The result of a cell; nullopt if there is none. Fault::invalid, with what is wrong, if the file
// is damaged.
Expected<std::optional<CellFile>> find_result(const Sweep& sweep, std::size_t cell);

struct CellState {
  std::string outcome;  // empty: not done, or damaged
  std::string damage;   // what is wrong with the result file; else empty

  bool is_done() const { return !outcome.empty(); }
};

// The states of all cells of the sweep that belong to the shard; the rest is as if not done.
std::vector<CellState> take_inventory(const Sweep& sweep, const Shard& shard = {});

// Whether the cell's outcome is a failure that the plan did not expect.
bool is_failure(const PlannedCell& cell, const std::string& outcome);

// "wall ode/quick step 0.001 s seed 3 friction=0.5"
std::string label(const PlannedCell& cell);

}  // namespace brickbench
