#include "ourengine/baraff/constant_force.hpp"

#include "ourengine/integration/rotation.hpp"

namespace ourengine::baraff {

void push(RigidBody& body, double step_s) {
  if (body.is_fixed()) return;
  body.linear_momentum_ns += step_s * body.force_n;
  body.angular_momentum_nms += step_s * body.torque_nm;
  body.velocity_mps = body.mass_inv * body.linear_momentum_ns;
  body.angular_velocity_radps = body.inertia_inv * body.angular_momentum_nms;
}

void constant_force(RigidBody& body, double step_s) {
  if (body.is_fixed()) return;
  push(body, 0.5 * step_s);
  body.position_m += step_s * body.velocity_mps;
  body.orientation = rotate_moser_veselov(body.orientation, body.inertia_body.diagonal(),
                                          body.angular_momentum_nms, step_s);
  compute_derived(body);
  push(body, 0.5 * step_s);
}

}  // namespace ourengine::baraff
