// The pieces that many exact cases share: bodies, grounds, contact geometries, measurements.
#pragma once

#include <string>
#include <vector>

#include "experiments/exact/cases/exact_case.hpp"

namespace brickbench::exact {

constexpr double k_gravity_mps2 = 9.81;

// Steps that cover the case's duration_s at its step_s, rounded to the nearest whole number.
std::size_t step_count(const ParameterValues& values);
// The own time of cases that begin and end so many steps before and after one event.
double one_step_s(const ParameterValues& values);
// Why an impact is none: where a step at the speed covers more than `most_m` the bodies are deep in
// each other, at other points than stated, before any step ends within their touch. Else empty.
std::string outruns(const ParameterValues& values, double speed_mps, double most_m);
// Half a floor slab's edge less the half-length of the bricks that slide on it: the way they have.
inline constexpr double k_way_on_floor_m = 9.0;
std::string leaves_floor(double way_m);
// A run with step, steps and gravity (0, 0, -9.81) set, or none.
ExactRun start_run(const ParameterValues& values, bool gravity = true);

State at(const Eigen::Vector3d& position_m,
         const Eigen::Vector3d& velocity_mps = Eigen::Vector3d::Zero(),
         const Eigen::Vector3d& angular_velocity_radps = Eigen::Vector3d::Zero());

// Uniform bodies of a given mass.
Body box(std::string name, const Eigen::Vector3d& half_extents_m, double mass_kg, State initial);
Body ball(std::string name, double radius_m, double mass_kg, State initial);
// A fixed box 20 m x 20 m x 1 m whose upper face is z = 0.
Body floor_slab();

// Gravity of the world seen from an incline of angle_rad that falls towards +x: the plane stays z =
// 0.
Eigen::Vector3d tilted_gravity_mps2(double angle_rad);

// Body `body` lies flat with its lower face half_height_m below its centre on z = 0 (body `ground`)
// and does not turn: four corners as one central contact.
ContactGeometry flat_contact(std::size_t ground, std::size_t body, double half_height_m);
// A sphere over z = 0; without friction the contact has no lever.
ContactGeometry sphere_contact(std::size_t ground, std::size_t body, double radius_m,
                               bool frictionless);
// Spheres of equal radius in a row: each body with the next one.
ContactGeometry sphere_row_contact(std::vector<std::size_t> bodies, double radius_m);
// All contacts of two geometries.
ContactGeometry both(ContactGeometry first, ContactGeometry second);

// The law of an impact at several points at once: "simultaneous" where every observable is that of
// the symmetric solution within k_law_band of its scale, else "neither": the points were served one
// after the other, or the contact has no coefficient of restitution.
inline constexpr double k_law_band = 0.01;
std::string symmetric_impact_law(std::span<const double> values, const ExactRun& run);

// A measure that keeps no memory: `look` overwrites the values at every sample.
Measure latest(std::function<void(const Sample&, std::span<double>)> look);

// Kinetic energy (J) of the moving bodies, and their momenta (N s; N m s about the origin).
double kinetic_energy_j(const World& world, std::span<const State> states);
Eigen::Vector3d momentum_ns(const World& world, std::span<const State> states);
Eigen::Vector3d angular_momentum_nms(const World& world, std::span<const State> states);
// I w of one body about its own centre, world frame.
Eigen::Vector3d spin_momentum_nms(const Body& body, const State& state);
// Rotation angle (rad) between two orientations, 0 .. pi.
double angle_between_rad(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b);
// The angle (rad) by which a body's z axis leans from the world's.
double lean_rad(const State& state);
// The impulse (N s) of all contacts between a and b of the last step, acting on b; NaN without
// contacts.
Eigen::Vector3d pair_impulse_ns(const Sample& sample, std::size_t a, std::size_t b);

}  // namespace brickbench::exact
