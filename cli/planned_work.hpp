// What the verbs that run cells have in common: a plan, its cells, a new folder, progress.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/terminal.hpp"
#include "experiments/record/provenance.hpp"
#include "experiments/run/cell.hpp"
#include "experiments/run/run_plan.hpp"

namespace brickbench {

struct PlanChoice {
  std::string plan;
  Overrides overrides;
  std::vector<std::string> engine_files;
};

// --set, --step, --duration, --engine and --only, which mean the same for every verb that has a
// plan.
void add_overrides(CLI::App& verb, Overrides& overrides);
// The required plan, by CLI11's names for it, add_overrides() and --engine-file.
void add_plan_choice(CLI::App& verb, PlanChoice& choice, const std::string& names = "plan");

struct PlannedWork {
  Catalogues catalogues;
  Plan plan;
  std::vector<Cell> cells;
  Provenance provenance;  // of a run that starts now
};

// Reads the plan; nullopt after a complaint on standard error, which is always bad input.
std::optional<PlannedWork> planned_work(const PlanChoice& choice,
                                        const std::vector<std::string>& arguments);

// Makes the folder `out`, or results/<plan>-<number> if `out` is empty; an existing one is refused.
// A plan from a pipe cannot be read again: from here on the provenance names the folder's copy.
Expected<std::filesystem::path> new_results_folder(const std::string& out, PlannedWork& work);

// What shows a run's cells on `progress`, which must outlive the callbacks.
RunCallbacks callbacks_for(Progress& progress, std::function<std::string(const Cell&)> label);

}  // namespace brickbench
