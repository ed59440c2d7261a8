// Runs the cells of a sweep, each in a process of its own, several at a time.
#pragma once

#include <functional>
#include <string>

#include "experiments/process/isolate.hpp"
#include "experiments/run/run_plan.hpp"
#include "experiments/sweep/shard.hpp"
#include "experiments/sweep/sweep.hpp"

namespace brickbench {

struct SweepOptions {
  unsigned jobs = 1;
  Shard shard = {};
  bool retry_failed = false;
  Limits limits = {};
  int attempts = 3;  // at a cell whose process is killed from outside
};

struct SweepCallbacks {
  // Once, after the folder has been looked through: cells of the shard, and how many of them have
  // a result already.
  std::function<void(std::size_t cells, std::size_t found)> begins;
  // A result file was damaged and its cell is run again; the text names file and damage.
  std::function<void(const std::string&)> damaged;
  // A cell has its result, by this process or another.
  std::function<void(const CellOutcome&, bool by_another)> cell_ends;
  // At least ten times a second.
  std::function<void(std::size_t running)> tick;
};

struct SweepSummary {
  std::size_t cells = 0;    // of the shard
  std::size_t found = 0;    // had a result at the start, and kept it
  std::size_t damaged = 0;  // had a result file that was none
  std::size_t ran = 0;      // by this process
  std::size_t shared = 0;   // by another process at the same time
  std::size_t failed = 0;   // of the results of the shard, unexpectedly
  bool stopped = false;     // by SIGINT, SIGTERM or SIGHUP

  std::size_t missing() const { return cells - found - ran - shared; }
};

// Runs what is missing of the shard. `cells` are those of the sweep, in the same order. Any number
// of processes may work on the same folder: a cell that another one runs is left to it, and
// taken over if that one dies. A cell whose process is killed from outside is started again, up to
// options.attempts times in all. Whatever else happens to it is its result.
//
// Stops at SIGINT, SIGTERM and SIGHUP: running cells are killed and have no result.
// Fault::crashed if the disk or the system refuses; what is done so far stays.
Expected<SweepSummary> run_sweep(const Sweep& sweep, const std::vector<Cell>& cells,
                                 const Catalogues& catalogues, const Origin& origin,
                                 const SweepOptions& options, const SweepCallbacks& callbacks = {});

}  // namespace brickbench
