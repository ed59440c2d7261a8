#include "reports/src/replay_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <system_error>

#include "adapters/seam/shape.hpp"
#include "experiments/record/trajectory.hpp"
#include "reports/src/flags.hpp"
#include "reports/src/summary.hpp"

namespace brickbench {
namespace {

namespace fs = std::filesystem;

ReplayBody body_of(const TrajectoryBody& body) {
  ReplayBody out;
  out.name = body.name;
  out.role = body.role == BodyRole::fixed        ? ReplayRole::fixed
             : body.role == BodyRole::projectile ? ReplayRole::projectile
                                                 : ReplayRole::brick;
  out.shape = by_shape(
      body.shape, [](const BoxShape&) { return ReplayShape::box; },
      [](const SphereShape&) { return ReplayShape::sphere; },
      [](const PlaneShape&) { return ReplayShape::plane; });
  if (!is_half_space(body.shape)) {
    const Eigen::Vector3d half_m = half_extents_m(body.shape);
    out.half_extents_m = {half_m.x(), half_m.y(), half_m.z()};
  }
  return out;
}

void append(const TrajectoryFrame& frame, bool contacts, Replay& replay) {
  replay.times_s.push_back(frame.time_s);
  for (const State& state : frame.states) {
    const auto& p = state.position_m;
    const auto& q = state.orientation;
    replay.positions_m.insert(replay.positions_m.end(), {p.x(), p.y(), p.z()});
    replay.orientations.insert(replay.orientations.end(), {q.w(), q.x(), q.y(), q.z()});
  }
  if (!contacts) return;
  for (const Contact& contact : frame.contacts) {
    const auto& p = contact.position_m;
    replay.contact_points_m.insert(replay.contact_points_m.end(), {p.x(), p.y(), p.z()});
  }
  replay.contact_offsets.push_back(replay.contact_points_m.size() / 3);
}

// Evenly chosen places out of `all`, the first and the last among them.
std::vector<std::size_t> even_places(std::size_t all, std::size_t most) {
  std::vector<std::size_t> places;
  const std::size_t count = std::min(all, most);
  for (std::size_t i = 0; i < count; ++i) {
    places.push_back(count < 2 ? 0 : (i * (all - 1) + (count - 1) / 2) / (count - 1));
  }
  return places;
}

Expected<Replay> read_replay(const fs::path& file, const Row& row) {
  const auto trajectory = Trajectory::open(file);
  if (!trajectory) return tl::unexpected(trajectory.error());
  const TrajectoryHeader& header = trajectory->header();
  if (header.cell != row.cell) {
    return fail(Fault::invalid,
                fmt::format("{}: the trajectory of another cell, {}", file.string(), header.cell));
  }
  Replay replay;
  replay.scene = scene_of(row);
  replay.engine = contender_of(row);
  replay.cell = row.cell;
  replay.recorded_frames = trajectory->times_s().size();
  if (trajectory->end().outcome != "ok") {
    replay.note = fmt::format("{}: {}", trajectory->end().outcome, trajectory->end().reason);
  }
  if (!row.validity.empty()) {
    replay.note = "! " + row.validity;
    replay.flagged_from_s = static_cast<double>(first_flagged_step(row.validity)) * row.step_s;
  }
  for (const TrajectoryBody& body : header.bodies) replay.bodies.push_back(body_of(body));
  if (header.contacts) replay.contact_offsets = {0};
  for (const std::size_t place : even_places(replay.recorded_frames, k_most_frames)) {
    const auto frame = trajectory->read(place);
    if (!frame) return tl::unexpected(frame.error());
    append(*frame, header.contacts, replay);
  }
  if (auto ok = check(replay); !ok) {
    return fail(Fault::invalid, fmt::format("{}: {}", file.string(), ok.error().reason));
  }
  return replay;
}

}  // namespace

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

Expected<RecordedReplays> read_replays(const fs::path& folder, std::span<const Row> rows) {
  RecordedReplays recorded;
  std::error_code error;
  if (!fs::is_directory(folder / "trajectories", error)) return recorded;
  std::vector<const Row*> chosen;  // a row of each cell to show
  std::set<std::string> seen;
  for (const Row& row : rows) {
    if (!seen.insert(row.cell).second) continue;
    if (!fs::exists(trajectory_path(folder, row.cell), error)) continue;
    ++recorded.cells;
    const auto same = std::ranges::find_if(chosen, [&](const Row* other) {
      return scene_of(*other) == scene_of(row) && contender_of(*other) == contender_of(row);
    });
    if (same == chosen.end()) {
      chosen.push_back(&row);
    } else if (row.seed < (*same)->seed) {
      *same = &row;
    }
  }
  for (const Row* row : chosen) {
    auto replay = read_replay(trajectory_path(folder, row->cell), *row);
    if (!replay) return tl::unexpected(replay.error());
    recorded.replays.push_back(std::move(*replay));
  }
  return recorded;
}

}  // namespace brickbench
