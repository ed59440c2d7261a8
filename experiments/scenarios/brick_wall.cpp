// A projectile flies along +y into a wall that stands in the x-z plane.
#include <fmt/core.h>

#include <cmath>

#include "experiments/scenarios/parts.hpp"
#include "experiments/scenarios/wall.hpp"

namespace brickbench {
namespace {

// The projectile's edges (m) along the world axes: it starts unrotated.
Eigen::Vector3d projectile_edges_m(const ParameterValues& values) {
  const Eigen::Vector3d edges_m = size_m(values, "projectile");
  if (word(values, "projectile_shape") == "box") return edges_m;
  return Eigen::Vector3d::Constant(edges_m.x());
}

Body projectile(const ParameterValues& values, const WallPlan& plan) {
  const Eigen::Vector3d half_m = 0.5 * projectile_edges_m(values);
  Body body;
  body.name = "projectile";
  body.shape = word(values, "projectile_shape") == "box" ? Shape(BoxShape{half_m})
                                                         : Shape(SphereShape{half_m.x()});
  body.mass_kg = number(values, "projectile_mass_kg");
  body.inertia_kgm2 = solid_inertia_kgm2(body.shape, body.mass_kg);
  body.initial.position_m = {
      number(values, "projectile_offset_m"), -number(values, "projectile_distance_m"),
      0.5 * wall_height_m(plan) + number(values, "projectile_above_middle_m")};
  body.initial.velocity_mps = {0.0, number(values, "projectile_speed_mps"), 0.0};
  body.initial.angular_velocity_radps = vector(values, "projectile_spin", "radps");
  return body;
}

Expected<void> check_start(const Body& projectile, const Eigen::Vector3d& half_m,
                           const WallPlan& plan) {
  const Eigen::Vector3d& at_m = projectile.initial.position_m;
  if (at_m.z() - half_m.z() < 0.0) {
    return fail(Fault::invalid, fmt::format("the projectile starts {} m inside the ground; raise "
                                            "projectile_above_middle_m",
                                            half_m.z() - at_m.z()));
  }
  const double overlap_m = 0.5 * plan.brick_m.y() + half_m.y() - std::abs(at_m.y());
  const bool beside = std::abs(at_m.x()) - half_m.x() >= wall_half_length_m(plan);
  const bool above = at_m.z() - half_m.z() >= wall_height_m(plan);
  if (overlap_m > 0.0 && !beside && !above) {
    return fail(Fault::invalid,
                fmt::format("the projectile starts {} m inside the wall; projectile_distance_m "
                            "must be at least {} m",
                            overlap_m, 0.5 * plan.brick_m.y() + half_m.y()));
  }
  return {};
}

Expected<Scene> make(const ParameterValues& values) {
  const WallPlan plan = wall_plan(values);
  auto bricks = wall_bricks(plan);
  if (!bricks) return tl::unexpected(bricks.error());
  Body thrown = projectile(values, plan);
  const auto possible = check_start(thrown, 0.5 * projectile_edges_m(values), plan);
  if (!possible) return tl::unexpected(possible.error());

  Scene scene;
  scene.world.law = contact_law(values);
  scene.world.bodies.push_back(ground_plane());
  for (Body& body : *bricks) add_brick(scene, std::move(body));
  scene.projectiles.push_back(scene.world.bodies.size());
  scene.world.bodies.push_back(std::move(thrown));
  scene.length_scale_m = plan.brick_m.minCoeff();
  return scene;
}

std::vector<Parameter> projectile_parameters() {
  return joined(
      {{choice_parameter("projectile_shape", {"box", "sphere"},
                         "sphere: projectile_length_m is its diameter, the other edges are unused"),
        number_parameter("projectile_mass_kg", "kg", 20.0, 1e-3, 1e5, "mass of the projectile")},
       size_parameters("projectile", {0.2, 0.1, 0.1}),
       {number_parameter("projectile_speed_mps", "m/s", 20.0, 0.0, 1000.0, "speed along +y"),
        number_parameter("projectile_distance_m", "m", 1.0, 0.0, 100.0,
                         "from the projectile's centre to the wall's middle plane, along y"),
        number_parameter("projectile_above_middle_m", "m", 0.02, -100.0, 100.0,
                         "height of the projectile's centre above half the wall's height"),
        number_parameter("projectile_offset_m", "m", 0.03, -100.0, 100.0,
                         "x of the projectile's centre; 0 is the middle of the wall")},
       vector_parameters("projectile_spin", "radps", "rad/s", Eigen::Vector3d::Zero(), 1000.0,
                         "angular velocity of the projectile")});
}

}  // namespace

Scenario brick_wall() {
  return {.name = "brick_wall",
          .meaning =
              "A brick thrown into a dry wall: many simultaneous impacts, then sliding and "
              "stacking contacts. Who conserves what, and how far do bricks fly?",
          .duration_s = 2.0,
          .parameters = joined(
              {wall_parameters(10, 10), contact_parameters(0.5, 0.0), projectile_parameters()}),
          .make = make};
}

}  // namespace brickbench
