// Where replays come from: the recorded trajectories of a results folder.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "experiments/record/row.hpp"
#include "reports/src/replay.hpp"

namespace brickbench {

// Of a trajectory at most this many frames are read, evenly chosen.
inline constexpr std::size_t k_most_frames = 2000;

struct RecordedReplays {
  std::vector<Replay> replays;
  std::size_t cells = 0;  // that have a trajectory
};

// The replays of the recorded cells, in the order of the rows: of each contender in each scene the
// cell of the lowest seed. Fault::invalid with the file if a trajectory is damaged or belongs to
// another cell than its name says.
Expected<RecordedReplays> read_replays(const std::filesystem::path& folder,
                                       std::span<const Row> rows);

// Labels of the scene and of the contender that a row belongs to, as in summaries.
std::string scene_of(const Row& row);
std::string contender_of(const Row& row);

}  // namespace brickbench
