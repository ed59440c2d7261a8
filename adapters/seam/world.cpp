#include "adapters/seam/world.hpp"

#include <fmt/core.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "adapters/seam/shape.hpp"

namespace brickbench {
namespace {

// A quaternion further than this from unit length is a mistake, not rounding.
constexpr double k_unit_quaternion_tolerance = 1e-9;
// Triangle inequality of inertia, relative: a flat plate meets it with equality, so allow rounding.
constexpr double k_inertia_triangle_slack = 1e-12;

bool positive(double x) { return std::isfinite(x) && x > 0.0; }

Expected<void> validate_shape(const Body& body) {
  return by_shape(
      body.shape,
      [&](const BoxShape& box) -> Expected<void> {
        for (const double half : box.half_extents_m) {
          if (!positive(half)) {
            return fail(Fault::invalid, fmt::format("body '{}': half extent {} m must be positive",
                                                    body.name, half));
          }
        }
        return {};
      },
      [&](const SphereShape& sphere) -> Expected<void> {
        if (!positive(sphere.radius_m)) {
          return fail(Fault::invalid, fmt::format("body '{}': radius {} m must be positive",
                                                  body.name, sphere.radius_m));
        }
        return {};
      },
      [&](const PlaneShape&) -> Expected<void> {
        if (!body.fixed) {
          return fail(Fault::invalid, fmt::format("body '{}': a plane must be fixed", body.name));
        }
        return {};
      });
}

Expected<void> validate_inertia(const Body& body) {
  if (!positive(body.mass_kg)) {
    return fail(Fault::invalid,
                fmt::format("body '{}': mass {} kg must be positive", body.name, body.mass_kg));
  }
  const Eigen::Vector3d& inertia = body.inertia_kgm2;
  for (int i = 0; i < 3; ++i) {
    const double rest = inertia.sum() - inertia[i];
    if (!positive(inertia[i]) || inertia[i] > rest * (1.0 + k_inertia_triangle_slack)) {
      return fail(Fault::invalid,
                  fmt::format("body '{}': inertia ({}, {}, {}) kg m2 is not that of a rigid body",
                              body.name, inertia[0], inertia[1], inertia[2]));
    }
  }
  return {};
}

Expected<void> validate_initial(const Body& body) {
  if (!is_finite(body.initial)) {
    return fail(Fault::invalid,
                fmt::format("body '{}': its initial state is not finite", body.name));
  }
  const double norm = body.initial.orientation.norm();
  if (std::abs(norm - 1.0) > k_unit_quaternion_tolerance) {
    return fail(Fault::invalid, fmt::format("body '{}': quaternion of length {} must have length 1",
                                            body.name, norm));
  }
  if (body.fixed && (!body.initial.velocity_mps.isZero(0.0) ||
                     !body.initial.angular_velocity_radps.isZero(0.0))) {
    return fail(Fault::invalid, fmt::format("body '{}': a fixed body has no velocity", body.name));
  }
  return {};
}

Expected<void> validate_law(const ContactLaw& law) {
  if (!std::isfinite(law.friction) || law.friction < 0.0) {
    return fail(Fault::invalid, fmt::format("friction {} must be at least 0", law.friction));
  }
  if (!(law.restitution >= 0.0 && law.restitution <= 1.0)) {
    return fail(Fault::invalid, fmt::format("restitution {} must lie in 0..1", law.restitution));
  }
  return {};
}

}  // namespace

ContactLaw contact_law(const World& world, std::size_t a, std::size_t b) {
  const auto [low, high] = std::minmax(world.bodies[a].surface, world.bodies[b].surface);
  for (const PairLaw& pair : world.exceptions) {
    if (std::minmax(pair.surface_a, pair.surface_b) == std::minmax(low, high)) return pair.law;
  }
  return world.law;
}

double solid_mass_kg(const Shape& shape, double density_kgpm3) {
  return by_shape(
      shape, [&](const BoxShape& box) { return density_kgpm3 * 8.0 * box.half_extents_m.prod(); },
      [&](const SphereShape& ball) {
        const double r_m = ball.radius_m;
        return density_kgpm3 * 4.0 / 3.0 * std::numbers::pi * r_m * r_m * r_m;
      },
      [](const PlaneShape&) { return std::numeric_limits<double>::infinity(); });
}

Eigen::Vector3d solid_inertia_kgm2(const Shape& shape, double mass_kg) {
  using Vector = Eigen::Vector3d;
  return by_shape(
      shape,
      [&](const BoxShape& box) -> Vector {
        const Vector squares = box.half_extents_m.cwiseAbs2();
        return mass_kg / 3.0 * (Vector::Constant(squares.sum()) - squares);
      },
      [&](const SphereShape& ball) -> Vector {
        return Vector::Constant(0.4 * mass_kg * ball.radius_m * ball.radius_m);
      },
      [](const PlaneShape&) -> Vector {
        return Vector::Constant(std::numeric_limits<double>::infinity());
      });
}

Body solid_body(std::string name, Shape shape, double density_kgpm3, State initial) {
  const double mass_kg = solid_mass_kg(shape, density_kgpm3);
  return {.name = std::move(name),
          .shape = shape,
          .fixed = false,
          .mass_kg = mass_kg,
          .inertia_kgm2 = solid_inertia_kgm2(shape, mass_kg),
          .surface = 0,
          .initial = initial};
}

Body fixed_body(std::string name, Shape shape, State initial) {
  Body body;
  body.name = std::move(name);
  body.shape = shape;
  body.fixed = true;
  body.initial = initial;
  return body;
}

Body ground_plane(double height_m) {
  State at;
  at.position_m.z() = height_m;
  return fixed_body("ground", PlaneShape{}, at);
}

Expected<void> validate(const World& world) {
  if (!world.gravity_mps2.allFinite()) return fail(Fault::invalid, "gravity is not finite");
  if (auto law = validate_law(world.law); !law) return law;
  std::set<std::pair<int, int>> seen;
  for (const PairLaw& pair : world.exceptions) {
    if (auto law = validate_law(pair.law); !law) return law;
    if (!seen.insert(std::minmax(pair.surface_a, pair.surface_b)).second) {
      return fail(Fault::invalid, fmt::format("the law of surfaces {} and {} is given twice",
                                              pair.surface_a, pair.surface_b));
    }
  }
  for (const Body& body : world.bodies) {
    if (auto shape = validate_shape(body); !shape) return shape;
    if (auto initial = validate_initial(body); !initial) return initial;
    if (body.fixed) continue;
    if (auto inertia = validate_inertia(body); !inertia) return inertia;
  }
  return {};
}

bool is_finite(const State& state) {
  return state.position_m.allFinite() && state.orientation.coeffs().allFinite() &&
         state.velocity_mps.allFinite() && state.angular_velocity_radps.allFinite();
}

std::uint64_t hash_states(std::span<const State> states, std::uint64_t seed) {
  std::uint64_t hash = seed;
  for (const State& s : states) {
    const std::array<double, 13> values = {s.position_m.x(),
                                           s.position_m.y(),
                                           s.position_m.z(),
                                           s.orientation.w(),
                                           s.orientation.x(),
                                           s.orientation.y(),
                                           s.orientation.z(),
                                           s.velocity_mps.x(),
                                           s.velocity_mps.y(),
                                           s.velocity_mps.z(),
                                           s.angular_velocity_radps.x(),
                                           s.angular_velocity_radps.y(),
                                           s.angular_velocity_radps.z()};
    hash = XXH3_64bits_withSeed(values.data(), sizeof values, hash);
  }
  return hash;
}

}  // namespace brickbench
