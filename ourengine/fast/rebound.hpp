// The laws of impact for all contacts of a step at once, and the energy that it may not exceed.
//
// All work on what the step applied in sum, where the sub-steps left it, in double precision.
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

// A manifold that was pushed during the step, and what it got: every point an impulse along the
// normal, from a to b, so that its velocity of separation is at least the target; all of them
// together one along the tangents in the middle of the points, and a twist about the normal.
struct ReboundRow {
  static constexpr std::size_t k_points = 4;
  // A direction at a place: lever x direction, and what an impulse of 1 N s adds to the spins.
  struct Arm {
    Eigen::Vector3d on_a = Eigen::Vector3d::Zero(), on_b = Eigen::Vector3d::Zero();
    Eigen::Vector3d turn_a = Eigen::Vector3d::Zero(), turn_b = Eigen::Vector3d::Zero();
  };
  int body_a = 0;
  int body_b = 0;
  std::size_t count = 0;        // of points
  double inverse_mass_a = 0.0;  // 0: fixed
  double inverse_mass_b = 0.0;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  std::array<Eigen::Vector3d, 2> tangent;
  std::array<Arm, k_points> point;
  std::array<Arm, 2> slide;  // of the tangents
  Arm twist;                 // of the normal, without a lever
  std::array<double, k_points> target_mps{};
  double friction = 0.0;
  double twist_arm_m = 0.0;  // friction holds a twist at this distance from the middle
  // Of the whole step; the velocities contain them. Changed by settle_rebound().
  std::array<double, k_points> impulse_ns{};  // >= 0
  std::array<double, 2> friction_ns{};
  double twist_nms = 0.0;
  // Set by settle_rebound().
  std::array<std::array<double, k_points>, k_points> response{};
  Eigen::Matrix2d slide_response = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d slide_mass = Eigen::Matrix2d::Zero();
  double least_slide_mass = 0.0;  // of any direction
};

// Finds impulses r >= 0 and velocities u of separation with u >= target and r (u - target) = 0, and
// friction within Coulomb's cone that stops what slides, or is as large as it may be, by sweeps
// over the rows that each solve one row for itself (block Gauss-Seidel; the normals of a row by
// projected Gauss-Seidel on its points, then its friction). Begins with the impulses of the rows.
// Sweeps that do not come to an end soon are extrapolated. Changes count as shares of the largest
// of the first sweep or of fastest_mps, whichever is more. velocity: (bodies); fixed bodies stay.
// Without restitution the contacts give nothing to the velocities that they end with (Carnot), so
// that the bodies have no more kinetic energy than if none had touched.
// Sources: J. J. Moreau, Unilateral contact and dry friction in finite freedom dynamics, 1988
// (Newton's and Coulomb's law at the end of the step as one problem of all contacts). Y. Nesterov,
// A method for solving the convex programming problem with convergence rate O(1/k^2), 1983, with
// the restarts of B. O'Donoghue and E. Candes, Foundations of Computational Mathematics 15 (2015).
struct Settling {
  double left_mps = 0.0;  // the last sweep changed a velocity by this much; 0: it was enough
  bool unsolved = false;  // ... which is more than k_rebound_tolerated
};
Settling settle_rebound(std::span<ReboundRow> rows, double fastest_mps, std::span<Twist> velocity);

inline constexpr double k_rebound_share = 1e-5;      // a change of a velocity that is enough
inline constexpr int k_plain_sweeps = 16;            // after which sweeps are extrapolated, ...
inline constexpr double k_restart_growth = 1.2;      // ... anew where changes grow by this factor
inline constexpr int k_rebound_sweeps = 64;          // after which ...
inline constexpr double k_rebound_tolerated = 1e-2;  // ... this is enough too
inline constexpr int k_most_rebound_sweeps = 1024;   // after which the laws are unsolved
// A row's normals by themselves: rounds at most, and the change that is enough, of what is enough
// between rows or of what the first round changed.
inline constexpr int k_row_rounds = 16;
inline constexpr double k_row_share = 0.1;
inline constexpr double k_round_share = 0.1;

// A body of a group whose contacts join them, at the end of the step.
struct GroupMember {
  double mass_kg = 0.0;
  Eigen::Matrix3d inertia_kgm2 = Eigen::Matrix3d::Zero();  // world axes
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Twist velocity;
};

// Where the group has more kinetic energy than allowed_j, all motion of its members against each
// other shrinks by one factor. Momentum and angular momentum stay; velocities of separation keep
// their sign, so that no contact begins to close. Returns what it took, J. A group's rigid motion
// is never slowed.
double limit_energy(std::span<GroupMember> members, double allowed_j);

}  // namespace ourengine
