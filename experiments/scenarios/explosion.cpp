// A block of bricks is driven apart by radial blows of prescribed total work.
#include <fmt/core.h>

#include <cmath>

#include "experiments/scenarios/parts.hpp"

namespace brickbench {
namespace {

// Bricks of equal size on a grid about `centre_m`, x fastest, then y, then z.
void add_grid(Scene& scene, const ParameterValues& values, const Eigen::Vector3d& centre_m) {
  const Eigen::Vector3d edges_m = size_m(values, "brick");
  const Eigen::Vector3d pitch_m = edges_m.array() + number(values, "gap_m");
  const Eigen::Vector3i counts(count(values, "count_x"), count(values, "count_y"),
                               count(values, "count_z"));
  for (int k = 0; k < counts.z(); ++k) {
    for (int j = 0; j < counts.y(); ++j) {
      for (int i = 0; i < counts.x(); ++i) {
        const Eigen::Vector3d steps =
            Eigen::Vector3d(i, j, k) - 0.5 * (counts.cast<double>() - Eigen::Vector3d::Ones());
        add_brick(scene, brick(fmt::format("brick_{}_{}_{}", i, j, k), edges_m,
                               number(values, "density_kgpm3"),
                               at(centre_m + pitch_m.cwiseProduct(steps))));
      }
    }
  }
}

// Radial velocities before scaling: along the way from the centre ("homologous", bricks that touch
// part without meeting), or of equal size ("equal_speed"). The brick in the very centre stays.
Eigen::Vector3d pattern(const std::string& profile, const Eigen::Vector3d& from_centre_m,
                        double smallest_m) {
  if (profile == "homologous") return from_centre_m;
  const double distance_m = from_centre_m.norm();
  if (distance_m < 1e-6 * smallest_m) return Eigen::Vector3d::Zero();
  return from_centre_m / distance_m;
}

// Blows m s u with the pattern u and s = sqrt(2 W / sum m u^2): on bricks that rest or move
// together they do the work W. Opposite bricks get opposite blows, so the sums of impulse and of
// angular impulse about the centre vanish.
void add_blows(Scene& scene, const ParameterValues& values, const Eigen::Vector3d& centre_m) {
  const double time_s = number(values, "blow_time_s");
  double twice_energy = 0.0;
  for (const std::size_t index : scene.bricks) {
    const Body& body = scene.world.bodies[index];
    const Eigen::Vector3d u =
        pattern(word(values, "profile"), body.initial.position_m - centre_m, scene.length_scale_m);
    scene.blows.push_back({.body = index,
                           .time_s = time_s,
                           .impulse_ns = body.mass_kg * u,
                           .angular_impulse_nms = Eigen::Vector3d::Zero()});
    twice_energy += body.mass_kg * u.squaredNorm();
  }
  const double scale = std::sqrt(2.0 * number(values, "work_j") / twice_energy);
  for (Blow& blow : scene.blows) blow.impulse_ns *= scale;
}

Expected<Scene> make(const ParameterValues& values) {
  const int bricks = count(values, "count_x") * count(values, "count_y") * count(values, "count_z");
  if (bricks < 2) return fail(Fault::invalid, "one brick cannot be driven apart: give at least 2");
  if (bricks > 20000) {
    return fail(Fault::invalid, fmt::format("{} bricks: at most 20000 make a scene", bricks));
  }
  const double edge_z_m = number(values, "brick_height_m");
  const double height_m = count(values, "count_z") * edge_z_m +
                          (count(values, "count_z") - 1) * number(values, "gap_m");
  const Eigen::Vector3d centre_m(0.0, 0.0, number(values, "clearance_m") + 0.5 * height_m);
  Scene scene;
  scene.world.gravity_mps2 = {0.0, 0.0, -number(values, "gravity_mps2")};
  scene.world.law = contact_law(values);
  if (flag(values, "ground")) scene.world.bodies.push_back(ground_plane());
  scene.length_scale_m = size_m(values, "brick").minCoeff();
  add_grid(scene, values, centre_m);
  add_blows(scene, values, centre_m);
  return scene;
}

}  // namespace

Scenario explosion() {
  return {
      .name = "explosion",
      .meaning =
          "A block of bricks driven apart by radial blows: in flight momentum and "
          "angular momentum stay as they were, and the energy grows by the work given.",
      .duration_s = 1.0,
      .parameters = joined(
          {{count_parameter("count_x", 3, 1, 100, "bricks along x"),
            count_parameter("count_y", 3, 1, 100, "bricks along y"),
            count_parameter("count_z", 3, 1, 100, "bricks along z"),
            choice_parameter("profile", {"homologous", "equal_speed"},
                             "homologous: speed grows with the distance from the centre"),
            number_parameter("work_j", "J", 500.0, 0.0, 1e7, "kinetic energy that the blows add"),
            number_parameter("blow_time_s", "s", 0.0, 0.0, 100.0, "when the blows fall"),
            number_parameter("gap_m", "m", 0.0, 0.0, 10.0, "between neighbours at the start"),
            number_parameter("clearance_m", "m", 1.0, 0.0, 1000.0,
                             "of the lowest bricks above z = 0"),
            flag_parameter("ground", true, "a fixed plane at z = 0"),
            number_parameter("gravity_mps2", "m/s2", k_standard_gravity_mps2, 0.0, 100.0,
                             "downward acceleration")},
           size_parameters("brick", {0.2, 0.1, 0.1}),
           {density_parameter()},
           contact_parameters(0.5, 0.0)}),
      .make = make};
}

}  // namespace brickbench
