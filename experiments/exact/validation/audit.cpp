#include "experiments/exact/validation/audit.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "adapters/seam/shape.hpp"
#include "adapters/seam/unit.hpp"

namespace brickbench::exact {
namespace {

// Sums and squares inside an engine may round; a wrong fact is wrong by much more.
constexpr double k_relative = 1e-12;

bool same(double a, double b) { return std::abs(a - b) <= k_relative * (1.0 + std::abs(b)); }
bool same(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return (a - b).norm() <= k_relative * (1e-30 + b.norm());
}
bool same_mass(double a, double b) { return std::abs(a - b) <= k_relative * b; }

std::string text(const Eigen::Vector3d& v) {
  return fmt::format("({}, {}, {})", v.x(), v.y(), v.z());
}

bool same_shape(const Shape& a, const Shape& b) {
  return size_difference_m(a, b) <= k_relative * bounding_radius_m(b);
}

void compare_body(const Body& body, const BodyAudit& live, std::vector<std::string>& out) {
  const auto note = [&](std::string what) {
    out.push_back(fmt::format("body '{}': {}", body.name, what));
  };
  if (live.fixed != body.fixed) note(live.fixed ? "is fixed" : "is not fixed");
  if (!same_shape(live.shape, body.shape)) note("its shape differs");
  if (body.fixed) return;
  if (!same_mass(live.mass_kg, body.mass_kg)) {
    note(fmt::format("mass {} kg instead of {} kg", live.mass_kg, body.mass_kg));
  }
  if (!same(live.inertia_kgm2, body.inertia_kgm2)) {
    note(fmt::format("inertia {} kg m2 instead of {} kg m2", text(live.inertia_kgm2),
                     text(body.inertia_kgm2)));
  }
  if (live.linear_damping_hz != 0.0 || live.angular_damping_hz != 0.0) {
    note(fmt::format("damping {} and {} Hz instead of none", live.linear_damping_hz,
                     live.angular_damping_hz));
  }
  if (live.can_sleep) note("may fall asleep");
}

void compare_settings(std::span<const AuditFact> live, std::span<const AuditFact> asked,
                      std::vector<std::string>& out) {
  for (const AuditFact& wanted : asked) {
    const auto found = std::ranges::find(live, wanted.name, &AuditFact::name);
    if (found == live.end()) {
      out.push_back(fmt::format("setting '{}': the live engine does not show it", wanted.name));
    } else if (found->value != wanted.value) {
      const std::string unit = unit_suffix(found->unit);
      out.push_back(fmt::format("setting '{}': {}{} instead of {}{}", wanted.name, found->value,
                                unit, wanted.value, unit));
    }
  }
}

}  // namespace

std::vector<std::string> audit_differences(const World& world, const AuditView& view,
                                           std::span<const AuditFact> asked) {
  std::vector<std::string> out;
  const Audit audit = view.audit();
  compare_settings(audit.settings, asked, out);
  if (!same(audit.gravity_mps2, world.gravity_mps2)) {
    out.push_back(fmt::format("gravity {} m/s2 instead of {} m/s2", text(audit.gravity_mps2),
                              text(world.gravity_mps2)));
  }
  if (audit.bodies.size() != world.bodies.size()) {
    out.push_back(fmt::format("{} bodies instead of {}", audit.bodies.size(), world.bodies.size()));
    return out;
  }
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    compare_body(world.bodies[i], audit.bodies[i], out);
  }
  for (std::size_t a = 0; a < world.bodies.size(); ++a) {
    for (std::size_t b = a + 1; b < world.bodies.size(); ++b) {
      if (world.bodies[a].fixed && world.bodies[b].fixed) continue;
      const ContactLaw live = view.pair_law(a, b), asked = contact_law(world, a, b);
      if (same(live.friction, asked.friction) && same(live.restitution, asked.restitution))
        continue;
      out.push_back(
          fmt::format("bodies '{}' and '{}': friction {} and restitution {} instead of "
                      "{} and {}",
                      world.bodies[a].name, world.bodies[b].name, live.friction, live.restitution,
                      asked.friction, asked.restitution));
    }
  }
  return out;
}

}  // namespace brickbench::exact
