// The rigid body of the paper: constants, state, derived quantities, force and torque.
//
// Source: H. Darji, P. Alur, Explosion Simulator, "Rigid body Physics"; D. Baraff, Physically Based
// Modeling, Rigid Body Simulation I, section 2.11 "Rigid Body Equations of Motion".
// Departures: gravity and loads reach `force` and `torque` from the simulator; the quaternion is
// renormalised after each step.
//
// World frame, SI; `orientation` turns body to world.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <variant>

namespace ourengine::baraff {

struct Box {
  Eigen::Vector3d half_m;
};
struct Sphere {
  double radius_m;
};
// The half space z <= 0 of the body frame; only for fixed bodies.
struct Plane {};
using Solid = std::variant<Box, Sphere, Plane>;

struct RigidBody {
  // Constants. A fixed body has inverse mass and inverse inertia 0.
  Solid solid = Box{Eigen::Vector3d::Constant(0.5)};
  double mass_kg = 0.0;
  double mass_inv = 0.0;
  Eigen::Matrix3d inertia_body = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d inertia_body_inv = Eigen::Matrix3d::Zero();
  int surface = 0;  // row and column of the table of restitutions

  // State.
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d linear_momentum_ns = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_momentum_nms = Eigen::Vector3d::Zero();

  // Derived from the state by compute_derived().
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d inertia_inv = Eigen::Matrix3d::Zero();  // I(t)^-1
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_velocity_radps = Eigen::Vector3d::Zero();

  // Accumulated for the next step.
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_nm = Eigen::Vector3d::Zero();

  bool is_fixed() const { return mass_inv == 0.0; }
};

// A body at rest in the origin; mass (kg) and principal moments (kg m2, body axes) positive.
RigidBody make_body(const Solid& solid, double mass_kg, const Eigen::Vector3d& inertia_kgm2);
RigidBody make_fixed_body(const Solid& solid);

// Sets both momenta from velocities: P = M v, L = R Ibody R^T w; then derives. Orientation is set.
void set_velocity(RigidBody& body, const Eigen::Vector3d& velocity_mps,
                  const Eigen::Vector3d& angular_velocity_radps);

// R, I(t)^-1 = R Ibody^-1 R^T, v = P / M, w = I(t)^-1 L.
void compute_derived(RigidBody& body);

// v + w x (p - x): velocity of the point of the body at p (world, m). Baraff, Rigid Body
// Simulation II, pt_velocity().
Eigen::Vector3d velocity_of_point_on_body(const RigidBody& body, const Eigen::Vector3d& point_m);

// P += j, L += (p - x) x j, and v, w follow; nothing happens to a fixed body.
void apply_impulse(RigidBody& body, const Eigen::Vector3d& point_m,
                   const Eigen::Vector3d& impulse_ns);

}  // namespace ourengine::baraff
