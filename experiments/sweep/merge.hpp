// From result files to tables.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "experiments/sweep/result_file.hpp"
#include "experiments/sweep/sweep.hpp"

namespace brickbench {

struct MergeSummary {
  std::size_t cells = 0;
  std::vector<std::size_t> missing;  // numbers of cells without a result
  std::vector<std::string> damage;   // result files that are none; their cells are missing
  std::size_t failed = 0;            // unexpectedly
  std::uint64_t bytes = 0;           // of the table of rows
  std::size_t recorded = 0;          // trajectories in the results folder
};

// The new files of a merge.
struct MergeFiles {
  std::filesystem::path rows;
  std::filesystem::path timings;
  std::filesystem::path series = {};  // empty: not wanted
};

using ResultVisitor = std::function<Expected<void>(const PlannedCell&, const CellFile&)>;

// Reads and checks the results of all cells in the order of the plan; visits them up to the first
// that is missing or damaged. Fails where a visit does.
Expected<MergeSummary> for_each_result(const Sweep& sweep, const ResultVisitor& visit);

// Writes the rows, timings and curves of all cells, in the order of the plan. Rows and curves are
// the same bytes whoever ran the cells, in whatever order, and however often that was interrupted,
// on machines of one kind; curves are those of the cells that the plan records. Writes nothing
// unless every cell has its result. Fault::invalid if a file exists with other content,
// Fault::crashed if the disk refuses. A table of rows that exists with the same content is left as
// it is, and then the timings are too.
Expected<MergeSummary> merge(const Sweep& sweep, const MergeFiles& files);

// Writes a results folder as of one run, for reports: rows, timings, curves, the plan, the
// provenance, and the trajectories as links, or as copies where the file system has no links.
// Fault::invalid, besides the above, if a trajectory is damaged or of another cell; then the folder
// is not made.
Expected<MergeSummary> merge_to_folder(const Sweep& sweep, const std::filesystem::path& folder);

}  // namespace brickbench
