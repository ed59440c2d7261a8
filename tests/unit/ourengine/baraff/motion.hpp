// Random bodies, and the motion of bodies under constant force and torque without contact.
#pragma once

#include <random>
#include <vector>

#include "ourengine/baraff/forward_euler.hpp"
#include "tests/support/tolerance.hpp"

namespace ourengine::baraff::testing {

constexpr brickbench::testing::Tolerance k_second_difference{
    "second_difference", 1e-6, 1e-7, "h^2 w^4 / 12 with h = 1e-4 s plus rounding 1e-16 / h^2"};

class Random {
 public:
  double number() { return normal_(engine_); }
  Eigen::Vector3d vector() { return {number(), number(), number()}; }
  RigidBody body(const Eigen::Vector3d& position_m) {
    RigidBody made =
        make_body(Box{{0.1, 0.05, 0.05}}, 2.0 + std::abs(number()), {0.03, 0.04, 0.05});
    made.position_m = position_m;
    made.orientation = Eigen::Quaterniond(number(), number(), number(), number()).normalized();
    set_velocity(made, vector(), vector());
    return made;
  }

 private:
  std::mt19937_64 engine_{7};
  std::normal_distribution<double> normal_;
};

// The bodies after time_s (also negative): fine steps of a midpoint rule follow the true motion.
inline std::vector<RigidBody> moved(std::vector<RigidBody> bodies, double time_s) {
  const int parts = 40;
  const double dt = time_s / parts;
  for (RigidBody& body : bodies) {
    for (int k = 0; k < parts; ++k) {
      RigidBody middle = body;
      forward_euler(middle, 0.5 * dt);
      const Eigen::Vector3d w = middle.angular_velocity_radps;
      body.position_m += dt * middle.velocity_mps;
      if (w.norm() > 0.0) {
        const double angle = w.norm() * dt;
        body.orientation =
            Eigen::Quaterniond(Eigen::AngleAxisd(angle, w.normalized())) * body.orientation;
      }
      body.linear_momentum_ns += dt * body.force_n;
      body.angular_momentum_nms += dt * body.torque_nm;
      compute_derived(body);
    }
  }
  return bodies;
}

}  // namespace ourengine::baraff::testing
