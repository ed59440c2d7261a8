// Running-bond walls for tests of the velocity-level engines.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "ourengine/collision/collide.hpp"
#include "ourengine/model/body_model.hpp"

namespace ourengine::testing {

struct Wall {
  std::vector<BodyModel> bodies;
  std::vector<Motion> motions;
};

inline void add_brick(Wall& wall, const Eigen::Vector3d& half_m, const Eigen::Vector3d& at_m,
                      const Eigen::Vector3d& velocity_mps = Eigen::Vector3d::Zero(),
                      double density_kgpm3 = 2000.0) {
  BodyModel body;
  body.geometry = BoxGeometry{half_m};
  body.mass_kg = density_kgpm3 * 8.0 * half_m.prod();
  const Eigen::Vector3d squares = half_m.cwiseAbs2();
  body.inertia_kgm2 = body.mass_kg / 3.0 * (Eigen::Vector3d::Constant(squares.sum()) - squares);
  wall.bodies.push_back(body);
  Motion motion;
  motion.position_m = at_m;
  motion.velocity_mps = velocity_mps;
  wall.motions.push_back(motion);
}

// Ground, then courses of 0.2 x 0.1 x 0.1 m bricks along x, half bricks at the ends of odd courses;
// joint_m apart within a course.
inline Wall running_bond(int columns, int courses, double joint_m = 0.0) {
  Wall wall;
  BodyModel ground;
  ground.geometry = PlaneGeometry{};
  ground.fixed = true;
  wall.bodies.push_back(ground);
  wall.motions.push_back({});
  const Eigen::Vector3d whole(0.1, 0.05, 0.05);
  const Eigen::Vector3d half(0.05, 0.05, 0.05);
  const double module_m = 0.2 + joint_m;
  const double end_m = columns * module_m - joint_m;
  for (int k = 0; k < courses; ++k) {
    const double z = 0.05 + 0.1 * k;
    if (k % 2 == 0) {
      for (int i = 0; i < columns; ++i) add_brick(wall, whole, {module_m * i + 0.1, 0.0, z});
      continue;
    }
    add_brick(wall, half, {0.05 - 0.5 * joint_m, 0.0, z});
    for (int i = 1; i < columns; ++i) {
      add_brick(wall, whole, {module_m * i - 0.5 * joint_m, 0.0, z});
    }
    add_brick(wall, half, {end_m - 0.05 + 0.5 * joint_m, 0.0, z});
  }
  return wall;
}

// Deepest overlap of any two bodies where they are, m >= 0.
inline double deepest_overlap_m(std::span<const BodyModel> bodies,
                                std::span<const Motion> motions) {
  double deepest_m = 0.0;
  for (std::size_t a = 0; a < bodies.size(); ++a) {
    const Aabb box = bounds(bodies[a].geometry, motions[a], 0.0);
    for (std::size_t b = a + 1; b < bodies.size(); ++b) {
      if (!box.overlaps(bounds(bodies[b].geometry, motions[b], 0.0))) continue;
      const Manifold manifold = collide(bodies[a], motions[a], bodies[b], motions[b], 0.0);
      for (int p = 0; p < manifold.count; ++p) {
        deepest_m = std::max(deepest_m, -manifold.points[static_cast<std::size_t>(p)].gap_m);
      }
    }
  }
  return deepest_m;
}

}  // namespace ourengine::testing
