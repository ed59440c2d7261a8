#include "experiments/exact/sketch/sketch_view.hpp"

#include <algorithm>
#include <cmath>

#include "adapters/seam/shape.hpp"

namespace brickbench::exact {

using Eigen::Vector3d;

namespace {

Wrench load_at(const ExactRun& run, std::size_t step, std::size_t body) {
  std::vector<Wrench> wrenches(run.world.bodies.size());
  if (run.load) run.load(step, static_cast<double>(step) * run.step_s, wrenches);
  return wrenches[body];
}

bool pulls(const Wrench& wrench) { return !wrench.force_n.isZero() || !wrench.torque_nm.isZero(); }

// How much happens along each axis.
Vector3d liveliness(const ExactRun& run) {
  Vector3d sum = 0.2 * run.world.gravity_mps2.cwiseAbs();
  if (!run.world.gravity_mps2.isZero()) sum.z() += 100.0;
  const Body* first = nullptr;
  for (std::size_t i = 0; i < run.world.bodies.size(); ++i) {
    const Body& body = run.world.bodies[i];
    if (body.fixed) continue;
    const State& s = body.initial;
    const Wrench load = shown_load(run, i).wrench;
    sum += s.velocity_mps.cwiseAbs() + load.force_n.cwiseAbs() / body.mass_kg;
    const Vector3d turn = (0.1 * s.angular_velocity_radps + load.torque_nm).cwiseAbs();
    sum += Vector3d(turn.y() + turn.z(), turn.x() + turn.z(), turn.x() + turn.y());
    if (first != nullptr) sum += (s.position_m - first->initial.position_m).cwiseAbs();
    if (first == nullptr) first = &body;
    if (!is_round(body.shape)) {
      const Vector3d tilt = 2.0 * s.orientation.vec().cwiseAbs();
      sum += Vector3d(tilt.y() + tilt.z(), tilt.x() + tilt.z(), tilt.x() + tilt.y());
    }
  }
  return sum;
}

}  // namespace

double size_of(const Shape& shape) { return is_half_space(shape) ? 0.0 : bounding_radius_m(shape); }

std::array<Vector3d, 8> corners(const BoxShape& box, const State& state) {
  std::array<Vector3d, 8> points;
  for (std::size_t i = 0; i < 8; ++i) {
    const Vector3d sign((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
    points[i] = state.position_m + state.orientation * box.half_extents_m.cwiseProduct(sign);
  }
  return points;
}

Vector3d nearest(const Body& body, const Vector3d& point) {
  const State& s = body.initial;
  const Vector3d seen = s.orientation.conjugate() * (point - s.position_m);
  const Vector3d local = by_shape(
      body.shape,
      [&](const BoxShape& box) -> Vector3d {
        return seen.cwiseMax(-box.half_extents_m).cwiseMin(box.half_extents_m);
      },
      [&](const SphereShape& ball) -> Vector3d {
        return std::min(1.0, ball.radius_m / seen.norm()) * seen;
      },
      [&](const PlaneShape&) -> Vector3d {
        return {seen.x(), seen.y(), 0.0};
      });
  return s.position_m + s.orientation * local;
}

ShownLoad shown_load(const ExactRun& run, std::size_t body) {
  const auto at = [&](std::size_t step) -> ShownLoad {
    return {load_at(run, step, body), static_cast<double>(step) * run.step_s};
  };
  if (!run.load || pulls(at(run.steps / 2).wrench)) return at(run.steps / 2);
  for (std::size_t step = 0; step < run.steps; ++step) {
    if (pulls(at(step).wrench)) return at(step);
  }
  return at(0);
}

SketchView choose_view(const ExactRun& run) {
  const Vector3d sum = liveliness(run);
  // Ties look along y.
  if (sum.z() < sum.x() && sum.z() < sum.y()) return {0, 1};
  if (sum.x() < sum.y()) return {1, 2};
  return {0, 2};
}

}  // namespace brickbench::exact
