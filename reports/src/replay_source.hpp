// Where replays come from: the recorded trajectories of a results folder.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "experiments/record/row.hpp"
#include "reports/src/replay.hpp"

namespace brickbench {

// The replays of all recorded cells, in the order of the rows. Always empty: experiments/record has
// no format of trajectories yet, and a results folder holds none.
Expected<std::vector<Replay>> read_replays(const std::filesystem::path& folder,
                                           std::span<const Row> rows);

// Labels of the scene and of the contender that a row belongs to, as in summaries.
std::string scene_of(const Row& row);
std::string contender_of(const Row& row);

}  // namespace brickbench
