// Energy and spin of one body from its recorded state.
#pragma once

#include "adapters/seam/world.hpp"

namespace brickbench {

// The angular velocity in the body frame (rad/s). The quaternion's length is divided out: how far
// an engine lets it drift is not a matter of energy.
inline Eigen::Vector3d body_angular_velocity_radps(const State& state) {
  return state.orientation.normalized().conjugate() * state.angular_velocity_radps;
}

// m v.v / 2 + w.I w / 2 (J).
inline double kinetic_energy_j(const Body& body, const State& state) {
  const Eigen::Vector3d spin_radps = body_angular_velocity_radps(state);
  return 0.5 * (body.mass_kg * state.velocity_mps.squaredNorm() +
                body.inertia_kgm2.dot(spin_radps.cwiseAbs2()));
}

// R I R^T w (kg m2/s), world frame.
inline Eigen::Vector3d spin_nms(const Body& body, const State& state) {
  const Eigen::Quaterniond to_world = state.orientation.normalized();
  return to_world *
         body.inertia_kgm2.cwiseProduct(to_world.conjugate() * state.angular_velocity_radps);
}

// Potential energy (J) in the uniform field; zero at the world's origin.
inline double potential_energy_j(const Body& body, const State& state,
                                 const Eigen::Vector3d& gravity_mps2) {
  return -body.mass_kg * gravity_mps2.dot(state.position_m);
}

// The work (J) of a wrench held during one step: that of an impulse is the impulse times the mean
// of the velocities before and after (Thomson and Tait, Treatise on Natural Philosophy, section
// 308). Exact for every scheme that adds force times step over mass to the velocity, and for a
// constant force in continuous time.
inline double work_of_step_j(const Wrench& wrench, const State& before, const State& after,
                             double step_s) {
  return 0.5 * step_s *
         (wrench.force_n.dot(before.velocity_mps + after.velocity_mps) +
          wrench.torque_nm.dot(before.angular_velocity_radps + after.angular_velocity_radps));
}

// Most wrenches of a run are, and a zero term changes no sum of finite numbers.
inline bool is_zero(const Wrench& wrench) {
  return (wrench.force_n.array() == 0.0).all() && (wrench.torque_nm.array() == 0.0).all();
}

}  // namespace brickbench
