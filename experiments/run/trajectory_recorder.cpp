#include "experiments/run/trajectory_recorder.hpp"

#include <algorithm>

#include "experiments/record/row.hpp"

namespace brickbench {
namespace {

bool contains(const std::vector<std::size_t>& list, std::size_t index) {
  return std::ranges::find(list, index) != list.end();
}

BodyRole role_of(const Scene& scene, std::size_t index) {
  if (scene.world.bodies[index].fixed) return BodyRole::fixed;
  if (contains(scene.projectiles, index)) return BodyRole::projectile;
  if (contains(scene.bricks, index)) return BodyRole::brick;
  return BodyRole::other;
}

TrajectoryHeader header_of(const Cell& cell, const Scene& scene, const Row& common) {
  TrajectoryHeader header;
  header.cell = common.cell;
  header.experiment = common.experiment;
  header.scenario = common.scenario;
  header.axes = common.axes;
  header.engine = common.engine;
  header.variant = common.variant;
  header.engine_version = common.engine_version;
  header.revision = common.revision;
  header.step_s = common.step_s;
  header.duration_s = common.duration_s;
  header.seed = common.seed;
  header.every = cell.recording->every;
  header.precision = cell.recording->precision;
  header.contacts = cell.recording->contacts;
  for (std::size_t i = 0; i < scene.world.bodies.size(); ++i) {
    const Body& body = scene.world.bodies[i];
    header.bodies.push_back(
        {body.name, body.shape, role_of(scene, i), body.fixed ? 0.0 : body.mass_kg});
  }
  return header;
}

}  // namespace

TrajectoryRecorder::TrajectoryRecorder(const std::filesystem::path& folder, const Cell& cell,
                                       const Scene& scene, const Row& common)
    : last_(step_count(cell)) {
  if (folder.empty() || !cell.recording) return;
  every_ = cell.recording->every;
  auto writer = TrajectoryWriter::create(trajectory_path(folder, common.cell),
                                         header_of(cell, scene, common));
  if (writer)
    writer_.emplace(std::move(*writer));
  else
    trouble_ = writer.error().reason;
}

void TrajectoryRecorder::note(const Expected<void>& done) {
  if (done) return;
  trouble_ = done.error().reason;
  writer_.reset();
}

void TrajectoryRecorder::observe(const Sample& sample) {
  if (!writer_ || (sample.step % every_ != 0 && sample.step != last_)) return;
  empty_ = false;
  note(writer_->append(sample.step, sample.time_s, sample.states, sample.contacts));
}

std::string TrajectoryRecorder::finish(const std::string& outcome, const std::string& reason) {
  if (writer_ && !empty_) note(writer_->commit({outcome, reason}));
  writer_.reset();
  return trouble_;
}

}  // namespace brickbench
