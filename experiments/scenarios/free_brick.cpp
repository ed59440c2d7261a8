// One brick in free flight.
#include "experiments/scenarios/parts.hpp"

namespace brickbench {
namespace {

Expected<Scene> make(const ParameterValues& values) {
  const Eigen::Vector3d edges_m = size_m(values, "brick");
  State initial;
  initial.velocity_mps = vector(values, "velocity", "mps");
  initial.angular_velocity_radps = vector(values, "spin", "radps");
  Scene scene;
  scene.world.gravity_mps2 = {0.0, 0.0, -number(values, "gravity_mps2")};
  add_brick(scene, brick("brick", edges_m, number(values, "density_kgpm3"), initial));
  scene.length_scale_m = edges_m.minCoeff();
  return scene;
}

}  // namespace

Scenario free_brick() {
  return {.name = "free_brick",
          .meaning =
              "Torque-free tumbling about the middle axis of inertia: the brick must flip, "
              "and keep its energy and angular momentum while it does.",
          .duration_s = 10.0,
          .parameters = joined(
              {size_parameters("brick", {0.2, 0.1, 0.05}),
               {density_parameter(),
                number_parameter("gravity_mps2", "m/s2", 0.0, 0.0, 100.0, "downward acceleration")},
               vector_parameters("velocity", "mps", "m/s", Eigen::Vector3d::Zero(), 1000.0,
                                 "initial velocity of the centre of mass"),
               // Off the separatrix, where the flip time is infinite and no answer can be compared.
               vector_parameters("spin", "radps", "rad/s", {0.1, 10.0, 0.0}, 1000.0,
                                 "initial angular velocity")}),
          .make = make};
}

}  // namespace brickbench
