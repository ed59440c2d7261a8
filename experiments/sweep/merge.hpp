// From result files to tables.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/sweep/sweep.hpp"

namespace brickbench {

struct MergeSummary {
  std::size_t cells = 0;
  std::vector<std::size_t> missing;  // numbers of cells without a result
  std::vector<std::string> damage;   // result files that are none; their cells are missing
  std::size_t failed = 0;            // unexpectedly
  std::uint64_t bytes = 0;           // of the table of rows
};

// Writes the rows of all cells in the order of the plan to the new file `rows`, and the timings to
// the new file `timings`. The rows are the same bytes whoever ran the cells, in whatever order, and
// however often that was interrupted, on machines of one kind. Writes nothing unless every cell
// has its result. Fault::invalid if a file exists with other content, Fault::crashed if the disk
// refuses. A table of rows that exists with the same content is left as it is, and then the timings
// are too.
Expected<MergeSummary> merge(const Sweep& sweep, const std::filesystem::path& rows,
                             const std::filesystem::path& timings);

// Writes a results folder as of one run, for reports: rows, timings, an empty table of curves, the
// plan and the provenance.
Expected<MergeSummary> merge_to_folder(const Sweep& sweep, const std::filesystem::path& folder);

}  // namespace brickbench
