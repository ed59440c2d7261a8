// Writes the trajectory of a running cell. A disk that refuses ends the recording, not the cell.
#pragma once

#include <filesystem>
#include <optional>

#include "experiments/record/trajectory.hpp"
#include "experiments/run/cell.hpp"

namespace brickbench {

struct Row;

class TrajectoryRecorder {
 public:
  // Records nothing if `folder` is empty or the cell has no `recording`. `common`: what the rows of
  // the cell share.
  TrajectoryRecorder(const std::filesystem::path& folder, const Cell& cell, const Scene& scene,
                     const Row& common);

  // Keeps the frame if it is one of those wanted; the last step always is.
  void observe(const Sample& sample);
  // Ends the file; a run without a frame leaves none. Why there is none, or "" where all went well
  // or none was wanted.
  std::string finish(const std::string& outcome, const std::string& reason);

 private:
  void note(const Expected<void>& done);

  std::optional<TrajectoryWriter> writer_;
  std::uint64_t every_ = 1;
  std::uint64_t last_ = 0;
  bool empty_ = true;
  std::string trouble_;
};

}  // namespace brickbench
