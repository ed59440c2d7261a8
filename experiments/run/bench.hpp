// Bench: the engines of a plan against the clock, side by side in one process.
//
// Cells of the same scene (scenario, parameters, duration, seed) make a group. A round runs every
// cell of the group once, in the order of the plan; rounds follow each other, A B C A B C, so that
// a machine that slows down slows all of them. The cost of a cell in a round is the CPU time that
// its engine's thread spent stepping (building and measuring left out) per simulated second, which
// also compares different steps; its ratio is that over the cost of the group's base in the *same*
// round. What is told is the median over the rounds, with the smallest and the largest.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/run/run_plan.hpp"

namespace brickbench {

// Of a few repetitions.
struct Spread {
  double median = 0.0;
  double least = 0.0;
  double most = 0.0;
};

// values: at least one; of an even number the median is the mean of the two in the middle.
Spread spread_of(std::vector<double> values);

struct BenchEntry {
  Cell cell;
  std::string id;
  std::size_t group = 0;  // from 0, in the order of the plan
  bool is_base = false;
  std::string outcome;  // the first that is not ok, over the rounds
  std::string reason;
  std::string validity;        // as in Row, of the first flagged round; such a time is not compared
  std::size_t rounds = 0;      // that ran to their end
  std::optional<Spread> cost;  // CPU s per simulated s
  std::optional<Spread> step_cpu_s;  // of the median step of each round
  std::optional<Spread> ratio;       // to the base; none if either did not run or is flagged
  bool repeatable = true;            // every round gave the same states
  std::vector<Row> rows;             // accuracy, from the first round
};

struct BenchResult {
  Selector base;
  std::size_t rounds = 0;
  std::vector<BenchEntry> entries;  // in the order of the plan
  RunResult runs;                   // all rounds: cells and timings; rows of the first round
};

// The plan's cells, `rounds` >= 1 times. The base of a group is its first cell, in the order of the
// plan, that `base` selects; a group without one has costs but no ratios.
BenchResult bench_cells(const std::vector<Cell>& cells, const Selector& base, std::size_t rounds,
                        const Catalogues& catalogues, const Origin& origin,
                        const RunCallbacks& callbacks = {});

}  // namespace brickbench
