// What the verbs of sweeps have in common: a plan and its cells, and complaints.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "adapters/seam/failure.hpp"
#include "experiments/record/provenance.hpp"
#include "experiments/run/cell.hpp"

namespace brickbench {

struct PlanChoice {
  std::string plan;
  Overrides overrides;
};

// The argument PLAN and the options --set, --engine and --only.
void add_plan_choice(CLI::App& verb, PlanChoice& choice);

struct PlannedWork {
  Catalogues catalogues;
  Plan plan;
  std::vector<Cell> cells;
  Provenance provenance;  // of a run that starts now
};

// Reads the plan; nullopt after a complaint on standard error, which is always bad input.
std::optional<PlannedWork> planned_work(const PlanChoice& choice,
                                        const std::vector<std::string>& arguments);

// Prints the message on standard error; returns `code`.
int complain(const std::string& message, int code);
// The exit code that the failure asks for.
int complain(const Failure& failure);

}  // namespace brickbench
