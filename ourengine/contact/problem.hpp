// One contact problem at velocity level, as a value: everything that a solver needs, and no more.
//
// Unknown are the velocities v at the end of the step and the impulses f at the contacts:
//
//   M (v - v_free) = J^T f                  (momentum)
//   w = J v + b                             (relative velocity at the contacts, with bias)
//   (w + mu |w_t| e_n)  in K*,   f in K,   f . (w + mu |w_t| e_n) = 0
//
// with Coulomb's cone K = { |f_t| <= mu f_n }, its dual K*, and the shift mu |w_t| of de Saxce and
// Feng (The bipotential method, 1998), which makes the cone condition Coulomb's exact law: a
// contact that slips does so against its sliding direction and without lifting. With mu = 0 the law
// is the linear complementarity problem  0 <= f_n  _|_  w_n >= 0.
//
// Frames and units: world frame, SI. Velocities are of the centre of mass, [linear; angular]. The
// normal points from body a to body b; f acts on b at its arm and -f on a. Components of w and f
// are in the order (normal, tangent_1, tangent_2).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace ourengine {

// Linear velocity (m/s), then angular velocity (rad/s).
using Velocity6 = Eigen::Matrix<double, 6, 1>;

struct ProblemBody {
  double mass_kg = 1.0;
  Eigen::Matrix3d inertia_kgm2 = Eigen::Matrix3d::Identity();  // about the centre, world axes
  bool fixed = false;  // keeps its free velocity; mass and inertia are unused
};

struct ProblemContact {
  int body_a = 0;
  int body_b = 0;
  Eigen::Vector3d arm_a_m = Eigen::Vector3d::Zero();  // centre of a to the contact point
  Eigen::Vector3d arm_b_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // right-handed orthonormal frame
  Eigen::Vector3d tangent_1 = Eigen::Vector3d::UnitX();
  Eigen::Vector3d tangent_2 = Eigen::Vector3d::UnitY();
  double gap_m = 0.0;         // < 0: overlap
  double friction = 0.0;      // mu >= 0
  double restitution = 0.0;   // Newton's e, 0 .. 1
  double approach_mps = 0.0;  // normal velocity before the step (< 0: approaching), for restitution
  std::uint64_t id = 0;       // the caller's name of the contact, kept from step to step
};

struct ContactProblem {
  double step_s = 1.0 / 240.0;
  // Overlaps are pushed apart within one step, but not faster than this.
  double recovery_mps = 1.0;
  // What a step gives to a free body, gravity times step: the least speed against which residuals
  // are measured (ContactSystem::scale_mps). 0 where the caller knows of none.
  double least_speed_mps = 0.0;
  std::vector<ProblemBody> bodies;
  std::vector<Velocity6> free_velocity;  // per body: end of step under gravity and loads alone
  std::vector<ProblemContact> contacts;
};

enum class SolveStatus {
  kSolved,         // the residual is within the tolerance
  kMaxIterations,  // the budget of iterations was spent; `residual` says what was reached
  kStalled,        // no further progress was possible
  kUnsuitable,     // the method does not cover this problem (frictionless method, mu > 0)
};

struct ContactSolution {
  std::vector<Velocity6> velocity;          // per body
  std::vector<Eigen::Vector3d> impulse_ns;  // per contact (normal, tangent_1, tangent_2)
  int iterations = 0;                       // of the method: Newton steps, sweeps, pivots
  int factorisations = 0;                   // of the sparse matrix
  double residual = 0.0;                    // relative, of the law the method was asked for
  SolveStatus status = SolveStatus::kSolved;
  std::string method;  // the solver that gave the result
};

// The bias b_n (m/s) of a contact's normal row: w_n = J_n v + b_n >= 0.
//
// Open (gap > 0): gap / step, so that the bodies may close the gap but not more (speculative
// contact). Overlap: max(gap / step, -recovery_mps). A contact that would touch within the step at
// its approach speed also bounces: the smaller of that and e * approach_mps (Newton's law).
double normal_bias_mps(const ProblemContact& contact, double step_s, double recovery_mps);

// An empty text if the problem is well formed (finite, indices in range, frames orthonormal to
// 1e-6, positive masses, symmetric positive inertia, no contact of a body with itself); otherwise
// what is wrong with which entry.
std::string problem_error(const ContactProblem& problem);

}  // namespace ourengine
