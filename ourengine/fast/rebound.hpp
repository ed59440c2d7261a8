// Newton's law of restitution for all contacts of a step at once, and the energy that it may not
// exceed.
//
// Both work on velocities alone, where the sub-steps left them, in double precision.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

namespace ourengine {

// Of a body's centre of mass (m/s) and about it (rad/s), world axes.
struct Twist {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();
};

// A manifold that was pushed during the step. Every point gets an impulse along the normal, from a
// to b, so that its velocity of separation is at least the target.
struct ReboundRow {
  static constexpr std::size_t k_points = 4;
  int body_a = 0;
  int body_b = 0;
  std::size_t count = 0;        // of points
  double inverse_mass_a = 0.0;  // 0: fixed
  double inverse_mass_b = 0.0;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  std::array<Eigen::Vector3d, k_points> arm_a, arm_b;    // lever x normal
  std::array<Eigen::Vector3d, k_points> turn_a, turn_b;  // what an impulse of 1 N s adds to a spin
  std::array<double, k_points> target_mps{};
  std::array<double, k_points> least_ns{};  // <= 0: what the point can give back
  std::array<std::array<double, k_points>, k_points> response{};  // set by settle_rebound()
  std::array<double, k_points> impulse_ns{};                      // result
};

// Finds impulses r >= least and velocities u of separation with u >= target and
// (r - least)(u - target) = 0, by sweeps over the rows that each solve one row for itself (block
// Gauss-Seidel; the row by projected Gauss-Seidel on its points). Ends when no row changes a
// velocity by more than enough_mps, or after k_rebound_sweeps; returns the last change (m/s).
// velocity: (bodies); fixed bodies stay.
// Source: J. J. Moreau, Unilateral contact and dry friction in finite freedom dynamics, 1988
// (Newton's law as a complementarity problem of all contacts).
inline constexpr double k_rebound_share = 1e-5;  // of the fastest approach: enough
inline constexpr int k_rebound_sweeps = 32;
double settle_rebound(std::span<ReboundRow> rows, double enough_mps, std::span<Twist> velocity);

// A body of a group whose contacts join them, at the end of the step.
struct GroupMember {
  double mass_kg = 0.0;
  Eigen::Matrix3d inertia_kgm2 = Eigen::Matrix3d::Zero();  // world axes
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Twist velocity;
};

// Where the group has more kinetic energy than allowed_j, all motion of its members against each
// other shrinks by one factor. Momentum and angular momentum stay; velocities of separation keep
// their sign, so that no contact begins to close. `grounded`: something fixed is in the group, and
// all motion counts. Returns what it took, J. A group's rigid motion is never slowed.
double limit_energy(std::span<GroupMember> members, bool grounded, double allowed_j);

}  // namespace ourengine
