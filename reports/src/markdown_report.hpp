// The Markdown report of a results folder: from rows, timings and provenance alone.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "experiments/record/provenance.hpp"
#include "experiments/record/row.hpp"
#include "experiments/record/timing.hpp"

namespace brickbench {

struct ReportInput {
  std::span<const Row> rows;
  std::span<const Timing> timings;
  const Provenance* provenance = nullptr;  // never null
};

// The same bytes for the same input: what made it, where our own engine loses, what failed and how
// to repeat it, then a table per scene and metric group with the worst named.
std::string markdown_report(const ReportInput& input);

// The shell command that repeats the cell of this row alone: what was set beside the plan, then
// what tells the cell from the others.
std::string reproduce_command(const Row& row, const Provenance& provenance);

}  // namespace brickbench
