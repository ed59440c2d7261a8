#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "adapters/seam/shape.hpp"
#include "experiments/scenes/scene_facts.hpp"

namespace brickbench {
namespace {

using Eigen::Vector3d;

// A sweep over contacts carries an error over one body of mass ratio r in about r sweeps: beyond
// this, the usual tens of sweeps are not enough.
constexpr double k_suspicious_mass_ratio = 100.0;
// Of the largest moving body's longest edge to the smallest one's shortest: what is a millimetre
// to one of them is a metre to the other.
constexpr double k_suspicious_size_ratio = 1000.0;
// Relative distance of an inertia from that of the uniform solid: beyond rounding and beyond the
// digits that people write.
constexpr double k_solid_tolerance = 1e-3;

// The largest principal moments (kg m2) that a body of this shape and mass can have, all of it as
// far out as the shape goes.
Vector3d largest_inertia_kgm2(const Body& body) {
  return by_shape(
      body.shape,
      [&](const BoxShape& box) -> Vector3d {
        const Vector3d squares = box.half_extents_m.cwiseAbs2();
        return body.mass_kg * (Vector3d::Constant(squares.sum()) - squares);
      },
      [&](const SphereShape& ball) -> Vector3d {
        return Vector3d::Constant(body.mass_kg * ball.radius_m * ball.radius_m);
      },
      [](const PlaneShape&) -> Vector3d {
        return Vector3d::Constant(std::numeric_limits<double>::infinity());
      });
}

std::optional<Doubt> inertia_doubt(const Body& body) {
  const Vector3d most = largest_inertia_kgm2(body);
  Eigen::Index axis = 0;
  const double share = body.inertia_kgm2.cwiseQuotient(most).maxCoeff(&axis);
  if (share > 1.0) {
    return Doubt{.kind = "inertia",
                 .text = fmt::format("the inertia of '{}' about its {} axis is {:.4g} kg m2; no "
                                     "body of this shape and mass has more than {:.4g} kg m2",
                                     body.name, "xyz"[axis], body.inertia_kgm2[axis], most[axis]),
                 .unit = "kg m2",
                 .value = body.inertia_kgm2[axis],
                 .limit = most[axis],
                 .bodies = {body.name}};
  }
  const Vector3d solid = solid_inertia_kgm2(body.shape, body.mass_kg);
  const Vector3d off = (body.inertia_kgm2.cwiseQuotient(solid) - Vector3d::Ones()).cwiseAbs();
  const double worst = off.maxCoeff(&axis);
  if (!(worst > k_solid_tolerance)) return std::nullopt;
  return Doubt{.kind = "not_solid",
               .text = fmt::format("the inertia of '{}' about its {} axis is {:.4g} kg m2; that of "
                                   "the uniform solid is {:.4g} kg m2",
                                   body.name, "xyz"[axis], body.inertia_kgm2[axis], solid[axis]),
               .unit = "1",
               .value = worst,
               .limit = k_solid_tolerance,
               .bodies = {body.name}};
}

void add_inertia(const World& world, std::vector<Doubt>& out) {
  for (const Body& body : world.bodies) {
    if (body.fixed) continue;
    if (auto doubt = inertia_doubt(body)) out.push_back(std::move(*doubt));
  }
}

void add_overlaps(const World& world, std::vector<Doubt>& out) {
  for (const Touch& touch : touches_at_start(world)) {
    if (!touch.overlap) continue;
    const std::string& a = world.bodies[touch.body_a].name;
    const std::string& b = world.bodies[touch.body_b].name;
    out.push_back({.kind = touch.inside ? "inside" : "overlap",
                   .text = touch.inside
                               ? fmt::format("of '{}' and '{}' one lies wholly inside the other; "
                                             "the way out is {:.4g} m",
                                             a, b, touch.depth_m)
                               : fmt::format("'{}' and '{}' overlap by {:.4g} m at the start", a, b,
                                             touch.depth_m),
                   .unit = "m",
                   .value = touch.depth_m,
                   .limit = 0.0,
                   .bodies = {a, b}});
  }
}

void add_mass_ratio(const World& world, std::vector<Doubt>& out) {
  const Body* lightest = nullptr;
  const Body* heaviest = nullptr;
  for (const Body& body : world.bodies) {
    if (body.fixed) continue;
    if (lightest == nullptr || body.mass_kg < lightest->mass_kg) lightest = &body;
    if (heaviest == nullptr || body.mass_kg > heaviest->mass_kg) heaviest = &body;
  }
  if (lightest == nullptr) return;
  const double ratio = heaviest->mass_kg / lightest->mass_kg;
  if (!(ratio > k_suspicious_mass_ratio)) return;
  out.push_back({.kind = "mass_ratio",
                 .text = fmt::format("'{}' has {:.4g} kg, '{}' {:.4g} kg, {:.4g} times as much: "
                                     "sweeps over contacts need about as many rounds",
                                     lightest->name, lightest->mass_kg, heaviest->name,
                                     heaviest->mass_kg, ratio),
                 .unit = "1",
                 .value = ratio,
                 .limit = k_suspicious_mass_ratio,
                 .bodies = {lightest->name, heaviest->name}});
}

void add_size_ratio(const World& world, std::vector<Doubt>& out) {
  const Body* smallest = nullptr;
  const Body* largest = nullptr;
  const auto longest_m = [](const Body& body) {
    return 2.0 * half_extents_m(body.shape).maxCoeff();
  };
  for (const Body& body : world.bodies) {
    if (body.fixed) continue;
    if (smallest == nullptr || thickness_m(body.shape) < thickness_m(smallest->shape)) {
      smallest = &body;
    }
    if (largest == nullptr || longest_m(body) > longest_m(*largest)) largest = &body;
  }
  if (smallest == nullptr) return;
  const double ratio = longest_m(*largest) / thickness_m(smallest->shape);
  if (!(ratio > k_suspicious_size_ratio)) return;
  out.push_back({.kind = "size_ratio",
                 .text = fmt::format("'{}' is {:.4g} m long, '{}' {:.4g} m thin: {:.4g} to 1",
                                     largest->name, longest_m(*largest), smallest->name,
                                     thickness_m(smallest->shape), ratio),
                 .unit = "1",
                 .value = ratio,
                 .limit = k_suspicious_size_ratio,
                 .bodies = {largest->name, smallest->name}});
}

void add_step(const Scene& scene, double step_s, std::vector<Doubt>& out) {
  const double longest_s = longest_step_s(scene);
  if (!(step_s > longest_s)) return;
  out.push_back({.kind = "step",
                 .text = fmt::format("in a step of {:.4g} s a body moves by more than half its "
                                     "thickness; steps up to {:.4g} s do not let it",
                                     step_s, longest_s),
                 .unit = "s",
                 .value = step_s,
                 .limit = longest_s,
                 .bodies = {}});
}

}  // namespace

std::vector<Doubt> doubts(const Scene& scene, std::optional<double> step_s) {
  std::vector<Doubt> all;
  add_overlaps(scene.world, all);
  add_inertia(scene.world, all);
  add_mass_ratio(scene.world, all);
  add_size_ratio(scene.world, all);
  if (step_s) add_step(scene, *step_s, all);
  // Kinds stay together, the worst first.
  const auto excess = [](const Doubt& doubt) {
    return doubt.limit > 0.0 ? doubt.value / doubt.limit : doubt.value;
  };
  std::vector<std::string> order;
  for (const Doubt& doubt : all) {
    if (std::ranges::find(order, doubt.kind) == order.end()) order.push_back(doubt.kind);
  }
  std::ranges::stable_sort(all, [&](const Doubt& a, const Doubt& b) {
    const auto place = [&](const Doubt& doubt) { return std::ranges::find(order, doubt.kind); };
    return place(a) != place(b) ? place(a) < place(b) : excess(a) > excess(b);
  });
  return all;
}

}  // namespace brickbench
