// The results folder: rows.csv, timings.csv, series.csv, provenance.json and the plan as it was.
#pragma once

#include <filesystem>

#include "experiments/run/run_plan.hpp"

namespace brickbench {

// A folder name that does not exist yet: results/<plan>-001, -002 ...
std::filesystem::path next_results_folder(const std::string& plan_name);

// Writes the five files into the existing, empty `folder`.
Expected<void> write_results(const std::filesystem::path& folder, const Plan& plan,
                             const RunResult& result, const Provenance& provenance);

}  // namespace brickbench
