// Rebounds that make no energy.
//
// Newton's law of restitution, stated for several contacts at once or together with friction, can
// ask for more energy than there was (T. R. Kane, D. A. Levinson, Dynamics: Theory and
// Applications, 1985, section 5.8; Ch. Glocker, Energetic consistency conditions for standard
// impacts, Multibody Syst. Dyn. 29 (2013)). An island that would gain gets the impulses
//
//   p = p_0 + s (p_e - p_0),
//
// p_e by Newton's law, p_0 without restitution and without undoing overlaps, and s in 0 .. 1 the
// largest with which its energy grows by no more than the work of gravity and loads. Both are in
// Coulomb's cones and let no gap close, and these sets are convex, so p is and does, too. p_0 never
// gains: the sum of p_0 . w is not positive. A single contact without friction has s = 1.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "ourengine/contact/islands.hpp"
#include "ourengine/contact/solvers.hpp"

namespace ourengine {

// What one step makes of a body that feels contacts, beside its new velocity v+:
// x+ = x + span_s v+ + lag_m.
struct BodyStep {
  Velocity6 before = Velocity6::Zero();
  Eigen::Vector3d acceleration_mps2 = Eigen::Vector3d::Zero();  // of gravity and load
  Eigen::Vector3d torque_nm = Eigen::Vector3d::Zero();
  Eigen::Vector3d lag_m = Eigen::Vector3d::Zero();
  double span_s = 0.0;
};

// Changes impulses and velocities of the islands that were struck (some contact approaches faster
// than resting_mps, or bounces) and gained energy. steps: (bodies). islands: all of the problem.
// Returns the smallest share s that was needed, 1 where none gained.
double keep_energy(const ContactProblem& problem, std::span<const Island> islands,
                   std::span<const BodyStep> steps, double resting_mps, Solver solver,
                   const SolveOptions& options, SolverMemory& memory, ContactSolution& solution);

}  // namespace ourengine
