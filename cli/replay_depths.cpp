#include "cli/replay_depths.hpp"

#include "experiments/metrics/body_depths.hpp"

namespace brickbench {
namespace {

Shape shape_of(const ReplayBody& body) {
  const auto& half_m = body.half_extents_m;
  switch (body.shape) {
    case ReplayShape::box:
      return BoxShape{{half_m[0], half_m[1], half_m[2]}};
    case ReplayShape::sphere:
      return SphereShape{half_m[0]};
    case ReplayShape::plane:
      break;
  }
  return PlaneShape{};
}

void add_depths(Replay& replay) {
  const std::size_t n = replay.bodies.size();
  std::vector<Shape> shapes;
  std::vector<bool> fixed;
  for (const ReplayBody& body : replay.bodies) {
    shapes.push_back(shape_of(body));
    fixed.push_back(body.role == ReplayRole::fixed);
  }
  std::vector<State> states(n);
  for (std::size_t f = 0; f < replay.times_s.size(); ++f) {
    for (std::size_t b = 0; b < n; ++b) {
      const double* p = &replay.positions_m[3 * (f * n + b)];
      const double* q = &replay.orientations[4 * (f * n + b)];
      states[b].position_m = {p[0], p[1], p[2]};
      states[b].orientation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
    }
    const std::vector<double> depths_m = body_depths_m(shapes, fixed, states);
    replay.penetrations_m.insert(replay.penetrations_m.end(), depths_m.begin(), depths_m.end());
  }
}

}  // namespace

void add_replay_depths(std::vector<ReportSource>& sources, std::size_t frames) {
  std::size_t bodies = 0;
  for (const ReportSource& source : sources) {
    for (const Replay& replay : source.replays) bodies += replay.bodies.size();
  }
  for (ReportSource& source : sources) {
    for (Replay& replay : source.replays) {
      replay = thinned(replay, frames_within_page(bodies, frames));
      if (replay.penetrations_m.empty()) add_depths(replay);
    }
  }
}

}  // namespace brickbench
