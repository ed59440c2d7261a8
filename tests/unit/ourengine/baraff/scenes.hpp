// Bricks of 2000 kg/m3 on the plane z = 0: a tower, and a running-bond wall in the xz plane.
#pragma once

#include <vector>

#include "ourengine/baraff/body.hpp"

namespace ourengine::baraff::testing {

inline RigidBody brick(const Eigen::Vector3d& half_m, const Eigen::Vector3d& position_m) {
  const double mass_kg = 2000.0 * 8.0 * half_m.prod();
  const Eigen::Vector3d q = half_m.cwiseAbs2();
  RigidBody body =
      make_body(Box{half_m}, mass_kg,
                mass_kg / 3.0 * Eigen::Vector3d(q.y() + q.z(), q.x() + q.z(), q.x() + q.y()));
  body.position_m = position_m;
  compute_derived(body);
  return body;
}

inline std::vector<RigidBody> tower(int bricks) {
  std::vector<RigidBody> bodies = {make_fixed_body(Plane{})};
  for (int i = 0; i < bricks; ++i) {
    bodies.push_back(brick({0.1, 0.05, 0.05}, {0, 0, 0.05 + 0.1 * i}));
  }
  return bodies;
}

inline std::vector<RigidBody> wall(int size) {
  std::vector<RigidBody> bodies = {make_fixed_body(Plane{})};
  for (int row = 0; row < size; ++row) {
    const double z = 0.05 + 0.1 * row;
    if (row % 2 == 1) bodies.push_back(brick({0.05, 0.05, 0.05}, {0.05, 0, z}));
    for (int k = 0; k < size - row % 2; ++k) {
      bodies.push_back(brick({0.1, 0.05, 0.05}, {0.1 + 0.2 * k + 0.1 * (row % 2), 0, z}));
    }
    if (row % 2 == 1) bodies.push_back(brick({0.05, 0.05, 0.05}, {0.2 * size - 0.05, 0, z}));
  }
  return bodies;
}

// A 5x5 wall and a brick that flies at it with 20 m/s.
inline std::vector<RigidBody> thrown_brick() {
  std::vector<RigidBody> bodies = wall(5);
  bodies.push_back(brick({0.1, 0.05, 0.05}, {0.53, -0.5, 0.27}));
  set_velocity(bodies.back(), {0, 20, 0}, {0, 0, 0});
  return bodies;
}

}  // namespace ourengine::baraff::testing
