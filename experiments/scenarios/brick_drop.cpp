// One brick falls on the ground, flat or tilted.
#include "experiments/scenarios/parts.hpp"

namespace brickbench {
namespace {

Expected<Scene> make(const ParameterValues& values) {
  const Eigen::Vector3d edges_m = size_m(values, "brick");
  const Eigen::Quaterniond tilt =
      Eigen::AngleAxisd(number(values, "tilt_y_rad"), Eigen::Vector3d::UnitY()) *
      Eigen::AngleAxisd(number(values, "tilt_x_rad"), Eigen::Vector3d::UnitX());
  // Lowest corner below the centre: the support of a box along -z.
  const double reach_m = (0.5 * edges_m).dot(tilt.toRotationMatrix().row(2).transpose().cwiseAbs());
  State initial = at({0.0, 0.0, number(values, "drop_height_m") + reach_m});
  initial.orientation = tilt;
  initial.velocity_mps = {0.0, 0.0, -number(values, "downward_speed_mps")};
  initial.angular_velocity_radps = vector(values, "spin", "radps");
  Scene scene;
  scene.world.law = contact_law(values);
  scene.world.bodies.push_back(ground_plane());
  add_brick(scene, brick("brick", edges_m, number(values, "density_kgpm3"), initial));
  scene.length_scale_m = edges_m.minCoeff();
  return scene;
}

}  // namespace

Scenario brick_drop() {
  constexpr double k_turn_rad = 6.283185307179586;
  return {.name = "brick_drop",
          .meaning =
              "A brick dropped on the ground: flat, four corners strike at once and nothing "
              "may turn or slide; tilted, one edge or corner strikes.",
          .duration_s = 2.0,
          .parameters = joined(
              {size_parameters("brick", {0.2, 0.1, 0.1}),
               {density_parameter(),
                number_parameter("drop_height_m", "m", 1.0, 0.0, 1000.0,
                                 "height of the lowest corner above the ground"),
                number_parameter("tilt_x_rad", "rad", 0.0, -k_turn_rad, k_turn_rad,
                                 "turn about x, before tilt_y_rad"),
                number_parameter("tilt_y_rad", "rad", 0.0, -k_turn_rad, k_turn_rad,
                                 "turn about the world y axis"),
                number_parameter("downward_speed_mps", "m/s", 0.0, 0.0, 1000.0, "initial speed")},
               vector_parameters("spin", "radps", "rad/s", Eigen::Vector3d::Zero(), 1000.0,
                                 "initial angular velocity"),
               contact_parameters(0.5, 0.0)}),
          .make = make};
}

}  // namespace brickbench
