// The discrete maps: what one step of a documented scheme does to free bodies and to bodies at one
// contact, in closed form. No collision detection, no solver: the case supplies the geometry.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adapters/seam/scheme.hpp"
#include "adapters/seam/world.hpp"
#include "experiments/exact/cases/exact_case.hpp"

namespace brickbench::exact {

// Angular velocity (rad/s, body axes) after one step h (s) under the torque (N m, body axes), for
// principal inertia (kg m2).
// newton_body: E. Catto, "Numerical Methods", GDC 2015 (one Newton iteration on implicit Euler).
// frozen_momentum: C. Lacoursiere, "Stabilizing gyroscopic forces in rigid multibody simulations",
// 2006.
Eigen::Vector3d next_spin_radps(GyroscopicRule rule, const Eigen::Vector3d& inertia_kgm2,
                                const Eigen::Vector3d& spin_radps, const Eigen::Vector3d& torque_nm,
                                double step_s);

// The turn by a rotation vector (rad).
Eigen::Quaterniond rotation_of(const Eigen::Vector3d& angle_rad);

// q + (0, turn) q / 2, scaled to length 1: a body-to-world orientation turned by a rotation vector
// (rad, world frame) to first order.
Eigen::Quaterniond turned_to_first_order(const Eigen::Quaterniond& orientation,
                                         const Eigen::Vector3d& turn_rad);

// q+ of a body-to-world orientation under a world angular velocity held for h, by a rule of
// attitude other than Moser-Veselov's.
Eigen::Quaterniond next_attitude(const Scheme& scheme, const Eigen::Quaterniond& orientation,
                                 const Eigen::Vector3d& angular_velocity_radps, double step_s);

// For GyroscopicRule::spatial_momentum: changes the spin so that the angular momentum about the
// centre changes by change_nms (world frame) at the present attitude.
void push_momentum(const Eigen::Vector3d& inertia_kgm2, const Eigen::Vector3d& change_nms,
                   State& state);

// ... and turns the body by one step h (s), momentum held; old_spin_radps (world frame) is that of
// the step's start, for the rule that turns with it.
void turn_with_momentum(const Scheme& scheme, const Eigen::Vector3d& inertia_kgm2,
                        const Eigen::Vector3d& old_spin_radps, double step_s, State& state);

// Moves state.position_m by one step h (s), after state.velocity_mps has been brought up to date.
void advance_position(PositionRule rule, const Eigen::Vector3d& old_velocity_mps, double step_s,
                      State& state);

// One step of a free body under the wrench and gravity.
State next_free_state(const Scheme& scheme, const Body& body, const State& state,
                      const Wrench& wrench, const Eigen::Vector3d& gravity_mps2, double step_s);

// Acceleration (m/s2) of a compliant contact of `points` equal points, each of which sees
// diagonal 1/mass = inverse mass of the whole: a = ((1-d) a_free + n d a_ref) / (1 - d + n d) where
// that pushes, else a_free. Todorov, "Convex and analytically-invertible dynamics with contacts and
// constraints", ICRA 2014; MuJoCo manual, "Computation: parameters of the constraint".
double compliant_acceleration_mps2(const CompliantContact& contact, double gap_m,
                                   double velocity_mps, double free_acceleration_mps2, int points,
                                   double step_s);

// Advances all states (bodies) by one step; false, with a reason, where the scheme leaves it open.
bool advance(const Scheme& scheme, const ExactRun& run, std::span<const Wrench> wrenches,
             std::span<State> states, std::string& why);

// What an engine that follows the scheme must measure, in exact arithmetic; nullopt where the
// scheme does not determine it (turning implicitly on a compliant contact, several contacts, none
// stated). `why` receives the reason for a nullopt if given.
std::optional<std::vector<double>> discrete_truth(const ExactCase& exact_case, const ExactRun& run,
                                                  const Scheme& scheme, std::string* why = nullptr);

}  // namespace brickbench::exact
