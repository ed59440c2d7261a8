#include "experiments/exact/schemes/scheme_map.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/exact/schemes/compliant_map.hpp"
#include "experiments/exact/schemes/impulse_map.hpp"
#include "experiments/exact/schemes/sequential_map.hpp"
#include "experiments/exact/schemes/soft_map.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Vector3d;

// One moving body on one compliant, frictionless, central contact; gravity and force along the
// normal included. Runge-Kutta evaluates the contact in each stage.
bool advance_compliant(const Scheme& scheme, const ExactRun& run, std::span<const Wrench> wrenches,
                       const PointContact& contact, std::span<State> states, std::string& why) {
  const std::size_t i = contact.body_b;
  const Body& body = run.world.bodies[i];
  const ContactLaw law = contact_law(run.world, contact.body_a, i);
  if (!run.world.bodies[contact.body_a].fixed) {
    why = "a compliant contact between two moving bodies is not predicted";
    return false;
  }
  if (law.restitution > 0.0) {
    why = "a compliant contact has no coefficient of restitution";
    return false;
  }
  const Vector3d free = run.world.gravity_mps2 + wrenches[i].force_n / body.mass_kg;
  const double h = run.step_s;
  const Vector3d& n = contact.normal;
  const Vector3d x0 = states[i].position_m;
  const Vector3d v0 = states[i].velocity_mps;
  const auto acceleration = [&](const Vector3d& x, const Vector3d& v) -> Vector3d {
    const double share = contact.boxes ? scheme.compliant()->box_gap_share : 1.0;
    const double gap = share * (contact.gap_m + n.dot(x - x0));
    if (gap >= 0.0) return free;
    const double along = compliant_acceleration_mps2(*scheme.compliant(), gap, n.dot(v),
                                                     n.dot(free), contact.points, h);
    return free + (along - n.dot(free)) * n;
  };
  State& s = states[i];
  if (scheme.position == PositionRule::runge_kutta_4) {
    const Vector3d a1 = acceleration(x0, v0);
    const Vector3d v2 = v0 + 0.5 * h * a1, a2 = acceleration(x0 + 0.5 * h * v0, v2);
    const Vector3d v3 = v0 + 0.5 * h * a2, a3 = acceleration(x0 + 0.5 * h * v2, v3);
    const Vector3d v4 = v0 + h * a3, a4 = acceleration(x0 + h * v3, v4);
    s.position_m = x0 + h / 6.0 * (v0 + 2.0 * v2 + 2.0 * v3 + v4);
    s.velocity_mps = v0 + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  } else {
    s.velocity_mps = v0 + h * acceleration(x0, v0);
    advance_position(scheme.position, v0, h, s);
  }
  return true;
}

}  // namespace

double compliant_acceleration_mps2(const CompliantContact& contact, double gap_m,
                                   double velocity_mps, double free_acceleration_mps2, int points,
                                   double step_s) {
  const auto [d, stiffness, damping] = compliant_law(contact, gap_m, step_s);
  const double reference = -damping * velocity_mps - stiffness * d * gap_m;
  if (reference <= free_acceleration_mps2) return free_acceleration_mps2;
  const double weight = points * d;
  return ((1.0 - d) * free_acceleration_mps2 + weight * reference) / (1.0 - d + weight);
}

bool advance(const Scheme& scheme, const ExactRun& run, std::span<const Wrench> wrenches,
             std::span<State> states, std::string& why) {
  std::vector<PointContact> contacts;
  if (run.geometry) run.geometry(states, contacts);
  if (run.geometry && scheme.impulse()) {
    return advance_impulse(scheme, run, wrenches, contacts, states, why);
  }
  if (run.geometry && scheme.sequential()) {
    return advance_sequential(scheme, run, wrenches, states, why);
  }
  if (run.geometry && !scheme.compliant()) {
    why = "the scheme states no contact map";
    return false;
  }
  if (run.geometry && contacts.size() == 1 && contacts[0].central &&
      contact_law(run.world, contacts[0].body_a, contacts[0].body_b).friction == 0.0) {
    return advance_compliant(scheme, run, wrenches, contacts[0], states, why);
  }
  if (run.geometry) {
    return advance_compliant_bodies(scheme, run, wrenches, states, why);
  }
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (run.world.bodies[i].fixed) continue;
    states[i] = next_free_state(scheme, run.world.bodies[i], states[i], wrenches[i],
                                run.world.gravity_mps2, run.step_s);
  }
  return true;
}

std::optional<std::vector<double>> discrete_truth(const ExactCase& exact_case, const ExactRun& run,
                                                  const Scheme& scheme, std::string* why) {
  std::string reason;
  std::string& out = why == nullptr ? reason : *why;
  const bool touching = exact_case.needs.contacts != Contacts::none;
  if (touching && !run.geometry && !scheme.soft()) {
    out = "no closed map: several contacts share the load";
    return std::nullopt;
  }
  Recorder recorder(run, exact_case.observables.size());
  ExactRun seen = run;
  if (run.geometry && scheme.impulse() && std::isfinite(scheme.impulse()->plane_reach_share)) {
    seen.geometry = corner_by_corner(*scheme.impulse(), run);
  }
  std::optional<SoftMap> soft;
  if (scheme.soft() && touching) soft.emplace(scheme, run);
  std::vector<Contact> contacts;
  std::vector<State> states;
  for (const Body& body : run.world.bodies) states.push_back(body.initial);
  std::vector<Wrench> wrenches(states.size());
  recorder.see({.step = 0,
                .time_s = 0.0,
                .states = states,
                .wrenches = wrenches,
                .contacts = nullptr,
                .diagnostics = {}});
  for (std::size_t step = 0; step < run.steps; ++step) {
    const double start_s = static_cast<double>(step) * run.step_s;
    std::ranges::fill(wrenches, Wrench{});
    if (run.load) run.load(step, start_s, wrenches);
    if (soft) {
      if (!soft->advance(wrenches, states, out)) return std::nullopt;
      contacts = soft->contacts();
    } else if (!advance(scheme, seen, wrenches, states, out)) {
      return std::nullopt;
    }
    recorder.see({.step = step + 1,
                  .time_s = static_cast<double>(step + 1) * run.step_s,
                  .states = states,
                  .wrenches = wrenches,
                  .contacts = soft ? &contacts : nullptr,
                  .diagnostics = {}});
  }
  return recorder.values();
}

}  // namespace brickbench::exact
