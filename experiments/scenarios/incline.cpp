// One brick on a fixed slope that falls towards +x.
#include <cmath>

#include "experiments/scenarios/parts.hpp"

namespace brickbench {
namespace {

// The slope passes through the origin. As a box it is 1 m thick and 200 m wide and long.
Body slope(const ParameterValues& values, const Eigen::Quaterniond& turn) {
  State pose;
  pose.orientation = turn;
  if (word(values, "slope") == "plane") return fixed_body("ground", PlaneShape{}, pose);
  const Eigen::Vector3d half_m(100.0, 100.0, 0.5);
  pose.position_m = turn * Eigen::Vector3d(0.0, 0.0, -half_m.z());
  return fixed_body("ground", BoxShape{half_m}, pose);
}

Expected<Scene> make(const ParameterValues& values) {
  const Eigen::Vector3d edges_m = size_m(values, "brick");
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(number(values, "angle_rad"), Eigen::Vector3d::UnitY()));
  const double heading_rad = number(values, "heading_rad");
  const double speed_mps = number(values, "speed_mps");
  State initial = at(turn * Eigen::Vector3d(0.0, 0.0, 0.5 * edges_m.z()));
  initial.orientation = turn;
  initial.velocity_mps = turn * Eigen::Vector3d(speed_mps * std::cos(heading_rad),
                                                speed_mps * std::sin(heading_rad), 0.0);
  Scene scene;
  scene.world.law = contact_law(values);
  scene.world.bodies.push_back(slope(values, turn));
  add_brick(scene, brick("brick", edges_m, number(values, "density_kgpm3"), initial));
  scene.length_scale_m = edges_m.minCoeff();
  return scene;
}

}  // namespace

Scenario incline() {
  constexpr double k_half_turn_rad = 3.141592653589793;
  constexpr double k_steepest_rad = 1.5;
  return {
      .name = "incline",
      .meaning =
          "A brick on a slope: it rests if friction >= tan(angle), else it slides with "
          "g (sin - friction cos); started with a speed, it stops after a known way.",
      .duration_s = 2.0,
      .parameters = joined(
          {{number_parameter("angle_rad", "rad", 0.4, 0.0, k_steepest_rad,
                             "of the slope against the horizontal; it falls towards +x"),
            choice_parameter("slope", {"plane", "box"}, "the fixed body that is the slope")},
           size_parameters("brick", {0.2, 0.2, 0.1}),
           {density_parameter(),
            number_parameter("speed_mps", "m/s", 0.0, 0.0, 1000.0, "initial speed in the slope"),
            number_parameter("heading_rad", "rad", 0.0, -k_half_turn_rad, k_half_turn_rad,
                             "direction of that speed, from downhill towards +y")},
           contact_parameters(0.5, 0.0)}),
      .make = make};
}

}  // namespace brickbench
