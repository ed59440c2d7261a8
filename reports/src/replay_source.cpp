#include "reports/src/replay_source.hpp"

#include "reports/src/summary.hpp"

namespace brickbench {

std::string scene_of(const Row& row) {
  Block block;
  block.experiment = row.experiment;
  block.axes = split_axes(row.axes).scene;
  block.step_s = row.step_s;
  block.duration_s = row.duration_s;
  return scene_label(block);
}

std::string contender_of(const Row& row) {
  return Contender{row.engine, row.variant, split_axes(row.axes).knobs}.label();
}

Expected<std::vector<Replay>> read_replays(const std::filesystem::path& folder,
                                           std::span<const Row> rows) {
  (void)folder;
  (void)rows;
  return std::vector<Replay>{};
}

}  // namespace brickbench
