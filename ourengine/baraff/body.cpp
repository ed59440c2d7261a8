#include "ourengine/baraff/body.hpp"

namespace ourengine::baraff {

RigidBody make_body(const Solid& solid, double mass_kg, const Eigen::Vector3d& inertia_kgm2) {
  RigidBody body;
  body.solid = solid;
  body.mass_kg = mass_kg;
  body.mass_inv = 1.0 / mass_kg;
  body.inertia_body = inertia_kgm2.asDiagonal();
  body.inertia_body_inv = inertia_kgm2.cwiseInverse().asDiagonal();
  compute_derived(body);
  return body;
}

RigidBody make_fixed_body(const Solid& solid) {
  RigidBody body;
  body.solid = solid;
  return body;
}

void set_velocity(RigidBody& body, const Eigen::Vector3d& velocity_mps,
                  const Eigen::Vector3d& angular_velocity_radps) {
  const Eigen::Matrix3d rotation = body.orientation.toRotationMatrix();
  body.linear_momentum_ns = body.mass_kg * velocity_mps;
  body.angular_momentum_nms =
      rotation * (body.inertia_body * (rotation.transpose() * angular_velocity_radps));
  compute_derived(body);
}

void compute_derived(RigidBody& body) {
  body.rotation = body.orientation.toRotationMatrix();
  body.inertia_inv = body.rotation * body.inertia_body_inv * body.rotation.transpose();
  body.velocity_mps = body.mass_inv * body.linear_momentum_ns;
  body.angular_velocity_radps = body.inertia_inv * body.angular_momentum_nms;
}

Eigen::Vector3d velocity_of_point_on_body(const RigidBody& body, const Eigen::Vector3d& point_m) {
  return body.velocity_mps + body.angular_velocity_radps.cross(point_m - body.position_m);
}

void apply_impulse(RigidBody& body, const Eigen::Vector3d& point_m,
                   const Eigen::Vector3d& impulse_ns) {
  if (body.is_fixed()) return;
  body.linear_momentum_ns += impulse_ns;
  body.angular_momentum_nms += (point_m - body.position_m).cross(impulse_ns);
  body.velocity_mps = body.mass_inv * body.linear_momentum_ns;
  body.angular_velocity_radps = body.inertia_inv * body.angular_momentum_nms;
}

}  // namespace ourengine::baraff
