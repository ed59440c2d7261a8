// Two bricks meet along x, far from everything.
#include <fmt/core.h>

#include <algorithm>

#include "experiments/scenarios/parts.hpp"

namespace brickbench {
namespace {

Expected<Scene> make(const ParameterValues& values) {
  const Eigen::Vector3d edges_a_m = size_m(values, "a");
  const Eigen::Vector3d edges_b_m = size_m(values, "b");
  const double closing_mps = number(values, "a_speed_mps") - number(values, "b_speed_mps");
  if (closing_mps < 0.0) {
    return fail(Fault::invalid,
                fmt::format("b_speed_mps exceeds a_speed_mps by {} m/s: the bricks would part",
                            -closing_mps));
  }
  const double between_m = 0.5 * (edges_a_m.x() + edges_b_m.x()) + number(values, "gap_m");
  State a;
  a.velocity_mps = {number(values, "a_speed_mps"), 0.0, 0.0};
  a.angular_velocity_radps = vector(values, "a_spin", "radps");
  State b = at({between_m, number(values, "offset_y_m"), number(values, "offset_z_m")});
  b.velocity_mps = {number(values, "b_speed_mps"), 0.0, 0.0};
  b.angular_velocity_radps = vector(values, "b_spin", "radps");
  Scene scene;
  scene.world.gravity_mps2.setZero();
  scene.world.law = contact_law(values);
  add_brick(scene, brick("brick_a", edges_a_m, number(values, "a_density_kgpm3"), a));
  add_brick(scene, brick("brick_b", edges_b_m, number(values, "b_density_kgpm3"), b));
  scene.length_scale_m = std::min(edges_a_m.minCoeff(), edges_b_m.minCoeff());
  return scene;
}

Parameter density(const std::string& prefix) {
  Parameter parameter = density_parameter();
  parameter.name = prefix + "_" + parameter.name;
  parameter.meaning = "density of brick " + prefix;
  return parameter;
}

Parameter speed(const std::string& prefix, double default_mps) {
  return number_parameter(prefix + "_speed_mps", "m/s", default_mps, -1000.0, 1000.0,
                          "velocity of brick " + prefix + " along x");
}

}  // namespace

Scenario two_bricks() {
  const Eigen::Vector3d edges_m(0.2, 0.1, 0.1);
  const Eigen::Vector3d still = Eigen::Vector3d::Zero();
  return {
      .name = "two_bricks",
      .meaning =
          "Brick a runs into brick b without gravity, centrally or off centre: momentum "
          "must be kept exactly, and the impulse is known in closed form.",
      .duration_s = 1.0,
      .parameters = joined(
          {size_parameters("a", edges_m),
           size_parameters("b", edges_m),
           {density("a"), density("b"), speed("a", 5.0), speed("b", 0.0),
            number_parameter("gap_m", "m", 0.3, 0.0, 100.0, "between the facing sides, along x"),
            number_parameter("offset_y_m", "m", 0.0, -10.0, 10.0, "of b's centre from a's path"),
            number_parameter("offset_z_m", "m", 0.0, -10.0, 10.0, "of b's centre from a's path")},
           vector_parameters("a_spin", "radps", "rad/s", still, 1000.0, "spin of brick a"),
           vector_parameters("b_spin", "radps", "rad/s", still, 1000.0, "spin of brick b"),
           contact_parameters(0.5, 0.0)}),
      .make = make};
}

}  // namespace brickbench
