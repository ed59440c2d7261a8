// From where a case's start is best looked at, and what the drawing of it needs to know.
#pragma once

#include <array>

#include "experiments/exact/cases/exact_case.hpp"

namespace brickbench::exact {

// Which world axes are to the right and up; the third points at the viewer or away.
struct SketchView {
  Eigen::Index right = 0;
  Eigen::Index up = 2;

  Eigen::Index across() const { return 3 - right - up; }
  // +1: the third axis points at the viewer.
  double toward() const { return (right + 1) % 3 == up ? 1.0 : -1.0; }
  Eigen::Vector2d flat(const Eigen::Vector3d& v) const { return {v[right], v[up]}; }
};

// Along the axis in which least happens: gravity, motion, forces, distances between bodies count
// along themselves, spins, torques and tilts across. What falls is never seen from above.
SketchView choose_view(const ExactRun& run);

// Radius (m) of the sphere around a shape; 0 for a plane.
double size_of(const Shape& shape);

// Of a box, in the world: bit k of the index says on which side along its axis k.
std::array<Eigen::Vector3d, 8> corners(const BoxShape& box, const State& state);

// The point of a box or plane that is nearest to `point` (both m, world frame).
Eigen::Vector3d nearest(const Body& body, const Eigen::Vector3d& point);

// What is applied to a body half-way through the run, else at the first step that pulls at all.
struct ShownLoad {
  Wrench wrench;
  double time_s = 0.0;
};
ShownLoad shown_load(const ExactRun& run, std::size_t body);

}  // namespace brickbench::exact
