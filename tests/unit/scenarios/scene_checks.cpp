#include "tests/unit/scenarios/scene_checks.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "adapters/seam/shape.hpp"

namespace brickbench::testing {
namespace {

// Half the width of the body along a unit direction.
double reach_m(const Body& body, const Eigen::Vector3d& direction) {
  return brickbench::reach_m(body.shape, body.initial.orientation.conjugate() * direction);
}

double plane_overlap_m(const Body& plane, const Body& body) {
  const Eigen::Vector3d normal = plane.initial.orientation * Eigen::Vector3d::UnitZ();
  const double height_m = normal.dot(body.initial.position_m - plane.initial.position_m);
  return reach_m(body, normal) - height_m;
}

double box_overlap_m(const Body& a, const Body& b) {
  const Eigen::Matrix3d axes_a = a.initial.orientation.toRotationMatrix();
  const Eigen::Matrix3d axes_b = b.initial.orientation.toRotationMatrix();
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < 3; ++i) {
    directions.emplace_back(axes_a.col(i));
    directions.emplace_back(axes_b.col(i));
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector3d edge = axes_a.col(i).cross(axes_b.col(j));
      if (edge.norm() > 1e-6) directions.emplace_back(edge.normalized());
    }
  }
  double overlap_m = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& direction : directions) {
    const double distance_m = std::abs(direction.dot(b.initial.position_m - a.initial.position_m));
    overlap_m = std::min(overlap_m, reach_m(a, direction) + reach_m(b, direction) - distance_m);
  }
  return overlap_m;
}

bool is_plane(const Body& body) { return is_half_space(body.shape); }

std::string image(const Eigen::Vector3d& v) { return fmt::format("({},{},{})", v[0], v[1], v[2]); }

}  // namespace

double deepest_overlap_m(const World& world, std::string& where) {
  double deepest_m = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < world.bodies.size(); ++j) {
      const Body& a = world.bodies[i];
      const Body& b = world.bodies[j];
      if (a.fixed && b.fixed) continue;
      const double overlap_m = is_plane(a)   ? plane_overlap_m(a, b)
                               : is_plane(b) ? plane_overlap_m(b, a)
                                             : box_overlap_m(a, b);
      if (overlap_m > deepest_m) {
        deepest_m = overlap_m;
        where = a.name + " and " + b.name;
      }
    }
  }
  return deepest_m;
}

std::string image(const Scene& scene) {
  std::string text =
      fmt::format("g {} law {} {} scale {}\n", image(scene.world.gravity_mps2),
                  scene.world.law.friction, scene.world.law.restitution, scene.length_scale_m);
  for (const Body& body : scene.world.bodies) {
    const Eigen::Vector4d q = body.initial.orientation.coeffs();
    text += fmt::format(
        "{} surface {} shape {} {} fixed {} m {} I {} x {} q {} {} {} {} v {} w {}\n", body.name,
        body.surface, body.shape.index(), is_plane(body) ? "" : image(half_extents_m(body.shape)),
        body.fixed, body.mass_kg, image(body.inertia_kgm2), image(body.initial.position_m), q[0],
        q[1], q[2], q[3], image(body.initial.velocity_mps),
        image(body.initial.angular_velocity_radps));
  }
  for (const Blow& blow : scene.blows) {
    text += fmt::format("blow {} {} {} {}\n", blow.body, blow.time_s, image(blow.impulse_ns),
                        image(blow.angular_impulse_nms));
  }
  for (const Push& push : scene.pushes) {
    text += fmt::format("push {} {} {} {} {} {}\n", push.body, image(push.force_n),
                        image(push.torque_nm), image(push.point_m), fmt::join(push.times_s, ","),
                        fmt::join(push.shares, ","));
  }
  for (const PairLaw& pair : scene.world.exceptions) {
    text += fmt::format("pair {} {} {} {}\n", pair.surface_a, pair.surface_b, pair.law.friction,
                        pair.law.restitution);
  }
  return text + fmt::format("bricks {} projectiles {}\n", fmt::join(scene.bricks, ","),
                            fmt::join(scene.projectiles, ","));
}

Scenario scenario_named(const std::string& name) {
  for (Scenario& scenario : scenarios()) {
    if (scenario.name == name) return scenario;
  }
  ADD_FAILURE() << "no scenario " << name;
  return {};
}

Scene built(const std::string& scenario, const ParameterValues& values) {
  auto scene = build(scenario_named(scenario), values);
  if (scene) return *std::move(scene);
  ADD_FAILURE() << scenario << ": " << scene.error().reason;
  return {};
}

std::string refusal(const std::string& scenario, const ParameterValues& values) {
  const auto scene = build(scenario_named(scenario), values);
  if (!scene) {
    EXPECT_EQ(scene.error().fault, Fault::invalid);
    return scene.error().reason;
  }
  ADD_FAILURE() << scenario << " was built";
  return {};
}

double kinetic_energy_j(const World& world) {
  double energy_j = 0.0;
  for (const Body& body : world.bodies) {
    if (body.fixed) continue;
    const Eigen::Vector3d spin =
        body.initial.orientation.conjugate() * body.initial.angular_velocity_radps;
    energy_j += 0.5 * body.mass_kg * body.initial.velocity_mps.squaredNorm() +
                0.5 * body.inertia_kgm2.dot(spin.cwiseAbs2());
  }
  return energy_j;
}

double potential_energy_j(const World& world) {
  double energy_j = 0.0;
  for (const Body& body : world.bodies) {
    if (!body.fixed) energy_j -= body.mass_kg * world.gravity_mps2.dot(body.initial.position_m);
  }
  return energy_j;
}

double moving_mass_kg(const World& world) {
  double mass_kg = 0.0;
  for (const Body& body : world.bodies) mass_kg += body.fixed ? 0.0 : body.mass_kg;
  return mass_kg;
}

}  // namespace brickbench::testing
