// The plan's table `trajectory`: which cells record their motion, and how.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "experiments/input/input.hpp"
#include "experiments/record/trajectory.hpp"
#include "experiments/run/condition.hpp"
#include "experiments/run/selector.hpp"

namespace brickbench {

struct Cell;

struct TrajectoryChoice {
  std::vector<Selector> engines;  // none: all
  Condition cells;                // on the quantities of rules, and `experiment`
  std::uint64_t every = 1;        // steps from frame to frame
  double every_s = 0.0;           // instead of `every`, unless 0
  TrajectoryPrecision precision = TrajectoryPrecision::f64;
  bool contacts = false;
  SourcePosition at;
  SourcePosition every_at;
};

// What a cell is to record.
struct Recording {
  std::uint64_t every = 1;
  TrajectoryPrecision precision = TrajectoryPrecision::f64;
  bool contacts = false;
};

// Reads the table; `names` are the quantities that its condition may use. Throws InputError.
TrajectoryChoice trajectory_choice(const InputValue& table, std::vector<std::string> names,
                                   const Catalogues& catalogues);

// Sets `recording` of the cells that the choice means. Throws InputError where `every_s` is not a
// whole number of a cell's steps.
void choose_recordings(const TrajectoryChoice& choice, const Catalogues& catalogues,
                       std::vector<Cell>& cells);

// Fault::unsupported if a cell is to be recorded and this build cannot.
Expected<void> check_recordable(std::span<const Cell> cells);

}  // namespace brickbench
