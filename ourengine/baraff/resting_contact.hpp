// The system a = A f + b of the resting contacts.
//
// Source: D. Baraff, Rigid Body Simulation II, section 9 "Resting Contact" and appendix D
// (compute_contact_forces, compute_a_matrix, compute_aij, compute_b_vector, compute_ndot); H.
// Darji, P. Alur, Explosion Simulator, "Resting Contact". Departures: A is sparse, since only
// contacts with a common body have an entry.

#pragma once

#include <span>
#include <vector>

#include "ourengine/baraff/collision.hpp"
#include "ourengine/baraff/qp_solve.hpp"

namespace ourengine::baraff {

// Relative normal velocity (m/s), negative where the bodies approach.
double relative_normal_velocity(std::span<const RigidBody> bodies, const Collision& contact);

// Rate of change (1/s) of the normal as obj2's face turns, as both edges turn, or as a sphere moves
// over an edge, a corner or another sphere.
Eigen::Vector3d compute_ndot(std::span<const RigidBody> bodies, const Collision& contact);

// Relative normal acceleration (m/s2) at contact i per newton at contact j.
double compute_aij(std::span<const RigidBody> bodies, const Collision& i, const Collision& j);

// (contacts, contacts), 1/kg, symmetric positive semidefinite.
SparseMatrix compute_a_matrix(std::span<const RigidBody> bodies,
                              std::span<const Collision> contacts);

// (contacts), m/s2: relative normal accelerations without contact forces, from force_n and
// torque_nm of the bodies and their motion (centripetal, gyroscopic and turning normal).
Eigen::VectorXd compute_b_vector(std::span<const RigidBody> bodies,
                                 std::span<const Collision> contacts);

// Size (m/s2) of the terms whose sum is b, and of the velocities of both bodies times `per_s`: the
// rounding of b is some 1e-16 of it, however much of them cancels.
double term_size(std::span<const RigidBody> bodies, std::span<const Collision> contacts,
                 double per_s);

}  // namespace ourengine::baraff
