// Rotation of a rigid body over one step, with the spatial angular momentum given and constant.
//
// Both store nothing but attitude and spatial angular momentum L: |L| and its direction are exact
// in either, and the spin follows from both, w = R I^-1 R^T L. Frames and units: q body to world; L
// world frame, kg m2/s; I principal, body axes, kg m2.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace ourengine {

enum class RotationScheme {
  k_semi_implicit,  // q+ = exp(h w(q, L)) q: first order
  k_moser_veselov,  // discrete Moser-Veselov, preprocessed: fourth order, keeps the energy
};

const char* rotation_name(RotationScheme scheme);

// Angular velocity (rad/s, world frame) of attitude q with angular momentum L.
Eigen::Vector3d angular_velocity_radps(const Eigen::Quaterniond& q,
                                       const Eigen::Vector3d& inertia_kgm2,
                                       const Eigen::Vector3d& momentum_kgm2ps);

// Largest turn (rad) of one discrete Moser-Veselov step: well inside the convergence of Newton's
// method, and small enough that order four means an error near 1e-9 rad per turn.
inline constexpr double k_largest_turn_rad = 0.02;

// q * exp: turned by the rotation vector (rad, world frame).
Eigen::Quaterniond turned(const Eigen::Quaterniond& q, const Eigen::Vector3d& rotation_rad);

// One step with w(q, L) of the start.
Eigen::Quaterniond rotate_semi_implicit(const Eigen::Quaterniond& q,
                                        const Eigen::Vector3d& inertia_kgm2,
                                        const Eigen::Vector3d& momentum_kgm2ps, double step_s);

// Discrete Moser-Veselov: the body turns by the unit quaternion (e0, e) with
//   e0 I e + e x I e = h/2 m,   m = R^T L,
// which keeps energy and momentum to rounding. I is replaced by moments that depend on the two
// constants of the motion, so that the phase is of order four as well. The equation is solved by
// Newton's method; a step that turns by more than k_largest_turn_rad is split, one by more than
// 2000 rad (or by no number) is semi-implicit. Sources: J. Moser, A. Veselov, Discrete versions of
// some classical integrable systems, Comm. Math. Phys. 139 (1991); E. Hairer, G. Vilmart,
// Preprocessed discrete Moser-Veselov algorithm for the full dynamics of a rigid body, J. Phys. A
// 39 (2006), order four.
Eigen::Quaterniond rotate_moser_veselov(const Eigen::Quaterniond& q,
                                        const Eigen::Vector3d& inertia_kgm2,
                                        const Eigen::Vector3d& momentum_kgm2ps, double step_s);

Eigen::Quaterniond rotate(RotationScheme scheme, const Eigen::Quaterniond& q,
                          const Eigen::Vector3d& inertia_kgm2,
                          const Eigen::Vector3d& momentum_kgm2ps, double step_s);

}  // namespace ourengine
