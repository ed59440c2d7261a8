#include "experiments/oracle/law_profile.hpp"

#include <algorithm>
#include <cmath>

#include "adapters/seam/shape.hpp"
#include "experiments/metrics/deepest_overlap.hpp"
#include "experiments/metrics/mechanics.hpp"
#include "experiments/oracle/impulse_oracle.hpp"
#include "experiments/oracle/step_laws.hpp"

namespace brickbench::gate {
namespace {

struct Step {
  const Scene& scene;
  const Recording& recording;
  std::size_t number;  // from 1

  StepRecord record() const {
    return {recording.states[number - 1], recording.states[number], recording.wrenches[number - 1],
            recording.step_s};
  }
  double time_s() const { return static_cast<double>(number) * recording.step_s; }
};

void see(Violation& violation, double value, double allowance, const Step& step,
         const std::string& a, const std::string& b) {
  ++violation.looked_at;
  violation.total += value;
  if (value > allowance) ++violation.steps;
  if (value <= violation.worst && violation.looked_at > 1) return;
  violation.allowance = allowance;
  violation.worst = value;
  violation.worst_time_s = step.time_s();
  violation.body_a = a;
  violation.body_b = b;
}

void see_impulses(Violation& violation, double allowance_ns, const Step& step) {
  const auto& bodies = step.scene.world.bodies;
  const Unexplained unexplained =
      unexplained_momentum(step.scene.world, step.record(), 0.1 * allowance_ns);
  const double before = violation.worst;
  see(violation, unexplained.upper_ns, allowance_ns, step, bodies[unexplained.worst_body].name,
      bodies[unexplained.worst_partner].name);
  if (violation.worst > before) violation.proven = unexplained.lower_ns;
}

// The body whose own energy rose most: where to look.
std::size_t most_energised(const Step& step) {
  const StepRecord record = step.record();
  const auto& bodies = step.scene.world.bodies;
  std::size_t worst = 0;
  double most = -HUGE_VAL;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].fixed) continue;
    const double rise = kinetic_energy_j(bodies[i], record.after[i]) -
                        kinetic_energy_j(bodies[i], record.before[i]);
    if (rise > most) {
      most = rise;
      worst = i;
    }
  }
  return worst;
}

double smallest_edge_m(const World& world) {
  double edge_m = HUGE_VAL;
  for (const Body& body : world.bodies) {
    if (body.fixed) continue;
    edge_m = std::min(edge_m, thickness_m(body.shape));
  }
  return edge_m;
}

}  // namespace

LawPlan law_plan(const Adapter& adapter, const Settings& settings, std::size_t stride) {
  LawPlan plan;
  plan.stride = stride;
  // A few hundred operations on each body per step.
  plan.rounding = variant_of(adapter, settings.variant).precision == "f32" ? 1e-5 : 1e-12;
  plan.scheme = scheme_of(adapter, settings);
  return plan;
}

std::vector<Violation> law_profile(const Scene& scene, const Recording& recording,
                                   const LawPlan& plan) {
  const World& world = scene.world;
  double mass_kg = 0.0;
  for (const Body& body : world.bodies) mass_kg += body.fixed ? 0.0 : body.mass_kg;
  const double h = recording.step_s;
  const double g = std::max(world.gravity_mps2.norm(), 1.0);
  const double impulse_ns = plan.impulse_share * mass_kg * g * h;
  const double overlap_m = plan.overlap_share * smallest_edge_m(world);
  const double rounding_ns = 1e3 * plan.rounding * mass_kg * g;
  Violation impulse{.law = "contact_impulse", .unit = "N s"};
  Violation energy{.law = "energy", .unit = "J"};
  Violation penetration{.law = "penetration", .unit = "m"};
  Violation momentum{.law = "momentum", .unit = "N s"};
  DeepestOverlap overlaps(world);
  for (std::size_t number = 1; number < recording.states.size(); ++number) {
    const Step step{scene, recording, number};
    if (number % plan.stride == 0) see_impulses(impulse, impulse_ns, step);
    see(energy, std::max(0.0, energy_gain_j(world, step.record())),
        energy_allowance_j(world, step.record(), plan.scheme, plan.rounding), step,
        world.bodies[most_energised(step)].name, "");
    const Overlap overlap = overlaps.find(recording.states[number]);
    see(penetration, overlap.depth_m, overlap_m, step, world.bodies[overlap.body_a].name,
        world.bodies[overlap.body_b].name);
    see(momentum, external_excess_ns(world, step.record(), 0.1 * rounding_ns), rounding_ns, step,
        "", "");
  }
  if (penetration.looked_at > 0) {
    penetration.total /= static_cast<double>(penetration.looked_at);
  }
  return {impulse, energy, penetration, momentum};
}

const Violation* broken_most(const std::vector<Violation>& profile) {
  const auto share = [](const Violation& v) {
    return v.looked_at == 0 ? 0.0 : static_cast<double>(v.steps) / static_cast<double>(v.looked_at);
  };
  const auto most = std::ranges::max_element(profile, {}, share);
  return most == profile.end() || most->steps == 0 ? nullptr : &*most;
}

}  // namespace brickbench::gate
