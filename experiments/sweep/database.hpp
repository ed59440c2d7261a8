// The merged results as an SQLite database.
#pragma once

#include <filesystem>
#include <string_view>

#include "experiments/sweep/merge.hpp"

namespace brickbench {

// Whether this build can write databases.
bool has_databases();
// "this build has no SQLite ..." with the name of the package; for messages.
std::string_view no_databases_reason();

// Writes the new file `file` with two tables in the order of the plan: `rows`, with the columns of
// rows.csv, and `cells`, with those of the sweep's list of cells, and outcome and reason. Numbers
// are the same doubles; where the CSV has an empty number there is NULL. Writes nothing unless
// every cell has its result. Fault::invalid if the file exists, or if the sweep is of a program
// with other columns; Fault::crashed if the disk refuses; Fault::unsupported without SQLite.
Expected<MergeSummary> merge_to_database(const Sweep& sweep, const std::filesystem::path& file);

}  // namespace brickbench
