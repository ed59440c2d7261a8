// A rotation of order four by another way than the engine's, as an oracle for it.
#pragma once

#include "ourengine/integration/rotation.hpp"

namespace brickbench::testing {

// Attitude after a step with constant spatial angular momentum. Good for turns well below 1 rad.
// q body to world; momentum world frame, kg m2/s; inertia principal, body axes, kg m2.
// Source: E. Celledoni, A. Marthinsen, B. Owren, Commutator-free Lie group methods, Future
// Generation Computer Systems 19 (2003), the method of order four with two exponentials.
inline Eigen::Quaterniond rotate_cf4(const Eigen::Quaterniond& q,
                                     const Eigen::Vector3d& inertia_kgm2,
                                     const Eigen::Vector3d& momentum_kgm2ps, double step_s) {
  const auto spin = [&](const Eigen::Quaterniond& at) {
    return Eigen::Vector3d(step_s *
                           ourengine::angular_velocity_radps(at, inertia_kgm2, momentum_kgm2ps));
  };
  const Eigen::Vector3d k1 = spin(q);
  const Eigen::Quaterniond half = ourengine::turned(q, 0.5 * k1);
  const Eigen::Vector3d k2 = spin(half);
  const Eigen::Vector3d k3 = spin(ourengine::turned(q, 0.5 * k2));
  const Eigen::Vector3d k4 = spin(ourengine::turned(half, k3 - 0.5 * k1));
  const Eigen::Quaterniond middle = ourengine::turned(q, (3.0 * k1 + 2.0 * (k2 + k3) - k4) / 12.0);
  return ourengine::turned(middle, (-k1 + 2.0 * (k2 + k3) + 3.0 * k4) / 12.0);
}

}  // namespace brickbench::testing
