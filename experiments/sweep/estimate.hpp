// Estimate: what a sweep will cost and which of its cells an engine will refuse, found by trying.
#pragma once

#include <string>
#include <vector>

#include "experiments/run/cell.hpp"
#include "experiments/run/run_cell.hpp"

namespace brickbench {

// A kind of cells, the same but for step and seed, whose trial did not end well.
struct TrialFailure {
  Cell cell;  // the one that was tried
  std::size_t cells = 0;
  std::string outcome;
  std::string reason;
};

struct Estimate {
  std::size_t cells = 0;  // that will be run
  std::size_t excluded = 0;
  std::size_t kinds = 0;
  std::size_t tried = 0;    // kinds; the others are taken to be as the mean of these
  double work_s = 0.0;      // of one worker
  double size_bytes = 0.0;  // of the result files
  // Of the trajectories before compression, without contact points; 0 if the plan records none.
  double motion_bytes = 0.0;
  std::vector<TrialFailure> failures;
};

struct TrialLimits {
  double stepping_s = 0.2;  // wall time for which a trial steps
  double hang_s = 20.0;     // wall time after which a trial is given up
  std::size_t most = 100;   // kinds that are tried, spread evenly over the plan
};

// Starts the first cell of each kind in a process of its own and steps it for a moment. The first
// steps of a scene are not its dearest: the time is right within a factor of about two.
// Fault::crashed if the system cannot start processes.
Expected<Estimate> estimate(const std::vector<Cell>& cells, const Catalogues& catalogues,
                            const Origin& origin, const TrialLimits& limits = {});

}  // namespace brickbench
