// World: the facts of a scene, in SI units, before any engine has seen them.
//
// Frames and units, stated once for the whole project:
//  * The world frame is right-handed, z up. Metres, kilograms, seconds, radians.
//  * A body's frame sits in its centre of mass along the principal axes of inertia, which for our
//    shapes are the axes of the shape.
//  * Orientations are unit quaternions (w, x, y, z), body to world.
//  * Velocities are those of the centre of mass; linear and angular both in the world frame.
//  * Friction and restitution belong to contact *pairs*: how an engine combines per-body numbers is
//    its adapter's business.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "adapters/seam/failure.hpp"

namespace brickbench {

struct BoxShape {
  Eigen::Vector3d half_extents_m;  // along the body axes, each > 0
};
struct SphereShape {
  double radius_m;  // > 0
};
// The half space z <= 0 of the body frame is solid; only a fixed body may have it.
struct PlaneShape {};

using Shape = std::variant<BoxShape, SphereShape, PlaneShape>;

// State of one body. A state is compared and hashed field by field, never as raw memory.
struct State {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_velocity_radps = Eigen::Vector3d::Zero();
};

// Dry contact between two surfaces.
struct ContactLaw {
  double friction = 0.0;     // Coulomb coefficient, isotropic, >= 0
  double restitution = 0.0;  // Newton's coefficient of normal velocity, 0 .. 1
};

struct Body {
  std::string name;
  Shape shape = BoxShape{Eigen::Vector3d::Constant(0.5)};
  bool fixed = false;    // never moves; mass and inertia are unused
  double mass_kg = 1.0;  // > 0
  Eigen::Vector3d inertia_kgm2 = {1.0 / 6, 1.0 / 6, 1.0 / 6};  // principal, body axes, each > 0
  int surface = 0;                                             // index for the pair laws below
  State initial;                                               // a fixed body has zero velocities
};

// The law of contacts between two kinds of surface, where it differs from World::law.
struct PairLaw {
  int surface_a = 0;
  int surface_b = 0;
  ContactLaw law;
};

struct World {
  Eigen::Vector3d gravity_mps2 = {0.0, 0.0, -9.81};
  std::vector<Body> bodies;
  ContactLaw law;                   // of every pair of surfaces not listed in `exceptions`
  std::vector<PairLaw> exceptions;  // unordered pairs, each at most once
};

// A force at the centre of mass and a torque about it, both in the world frame.
struct Wrench {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_nm = Eigen::Vector3d::Zero();
};

// Law of the contact between bodies a and b (indices into World::bodies).
ContactLaw contact_law(const World& world, std::size_t a, std::size_t b);

// Mass (kg) of a solid of uniform density (kg/m3); a plane has none and must not be asked.
double solid_mass_kg(const Shape& shape, double density_kgpm3);
// Principal moments of inertia (kg m2, body axes) of a uniform solid of the given mass (kg):
// box m/3 (b^2 + c^2) with half extents a, b, c; sphere 2/5 m r^2.
Eigen::Vector3d solid_inertia_kgm2(const Shape& shape, double mass_kg);

// A uniform solid body; density in kg/m3.
Body solid_body(std::string name, Shape shape, double density_kgpm3, State initial = {});
// A body that never moves.
Body fixed_body(std::string name, Shape shape, State initial = {});
// The fixed half space below z = height_m.
Body ground_plane(double height_m = 0.0);

// Refuses what no engine could simulate: sizes, masses or inertias that are not positive and
// finite, inertias against the triangle inequality, unnormalised quaternions (1e-9), moving planes,
// fixed bodies with velocity, restitution outside 0..1, negative friction, a pair of surfaces
// listed twice.
Expected<void> validate(const World& world);

bool is_finite(const State& state);

// Hash of the states (bodies), in order, over the bit patterns of their 13 doubles each: equal
// states hash equally on every platform with IEEE doubles; -0.0 and 0.0 differ.
std::uint64_t hash_states(std::span<const State> states, std::uint64_t seed = 0);

}  // namespace brickbench
