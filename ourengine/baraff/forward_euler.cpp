#include "ourengine/baraff/forward_euler.hpp"

namespace ourengine::baraff {

void forward_euler(RigidBody& body, double step_s) {
  if (body.is_fixed()) return;
  Eigen::Quaterniond spin;
  spin.w() = 0.0;
  spin.vec() = body.angular_velocity_radps;
  const Eigen::Quaterniond turned = spin * body.orientation;
  body.position_m += step_s * body.velocity_mps;
  body.orientation.coeffs() += 0.5 * step_s * turned.coeffs();
  body.orientation.normalize();
  body.linear_momentum_ns += step_s * body.force_n;
  body.angular_momentum_nms += step_s * body.torque_nm;
  compute_derived(body);
}

}  // namespace ourengine::baraff
