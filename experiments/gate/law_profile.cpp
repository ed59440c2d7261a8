#include "experiments/gate/law_profile.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/gate/contact_candidates.hpp"
#include "experiments/gate/impulse_oracle.hpp"
#include "experiments/metrics/deepest_overlap.hpp"
#include "experiments/metrics/mechanics.hpp"

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

void see(Violation& violation, double value, const Step& step, const std::string& a,
         const std::string& b) {
  ++violation.looked_at;
  violation.total += value;
  if (value > violation.allowance) ++violation.steps;
  if (value <= violation.worst) return;
  violation.worst = value;
  violation.worst_time_s = step.time_s();
  violation.body_a = a;
  violation.body_b = b;
}

void see_impulses(Violation& violation, const Step& step) {
  const auto& bodies = step.scene.world.bodies;
  const Unexplained unexplained =
      unexplained_momentum(step.scene.world, step.record(), 0.1 * violation.allowance);
  const double before = violation.worst;
  see(violation, unexplained.upper_ns, step, bodies[unexplained.worst_body].name,
      bodies[unexplained.worst_partner].name);
  if (violation.worst > before) violation.proven = unexplained.lower_ns;
}

double energy_j(const World& world, const std::vector<State>& states) {
  double sum = 0.0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (world.bodies[i].fixed) continue;
    sum += kinetic_energy_j(world.bodies[i], states[i]) -
           world.bodies[i].mass_kg * world.gravity_mps2.dot(states[i].position_m);
  }
  return sum;
}

// Work with the mean velocity of the step: exact for a force that is held.
double work_j(const Step& step) {
  const StepRecord record = step.record();
  double sum = 0.0;
  for (std::size_t i = 0; i < record.before.size(); ++i) {
    sum += 0.5 * record.step_s *
           (record.wrenches[i].force_n.dot(record.before[i].velocity_mps +
                                           record.after[i].velocity_mps) +
            record.wrenches[i].torque_nm.dot(record.before[i].angular_velocity_radps +
                                             record.after[i].angular_velocity_radps));
  }
  return sum;
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

// Horizontal momentum that the fixed bodies cannot have given: at most their friction times the
// vertical impulse that all bodies together received (upright worlds whose fixed bodies are level).
double horizontal_excess_ns(const Step& step) {
  const StepRecord record = step.record();
  Eigen::Vector3d given = Eigen::Vector3d::Zero();
  double friction = 0.0;
  const World& world = step.scene.world;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    if (world.bodies[i].fixed) continue;
    given +=
        world.bodies[i].mass_kg * (record.after[i].velocity_mps - record.before[i].velocity_mps -
                                   record.step_s * world.gravity_mps2) -
        record.step_s * record.wrenches[i].force_n;
    for (std::size_t k = 0; k < world.bodies.size(); ++k) {
      if (world.bodies[k].fixed) friction = std::max(friction, contact_law(world, i, k).friction);
    }
  }
  return std::max(0.0, given.head<2>().norm() - friction * std::max(0.0, given.z()));
}

}  // namespace

std::vector<Violation> law_profile(const Scene& scene, const Recording& recording,
                                   const LawPlan& plan) {
  const World& world = scene.world;
  double mass_kg = 0.0;
  for (const Body& body : world.bodies) mass_kg += body.fixed ? 0.0 : body.mass_kg;
  const double h = recording.step_s;
  const double g = world.gravity_mps2.norm();
  Violation impulse{.law = "contact_impulse", .unit = "N s"};
  impulse.allowance = plan.impulse_share * mass_kg * std::max(g, 1.0) * h;
  Violation energy{.law = "energy", .unit = "J"};
  energy.allowance = 0.5 * mass_kg * g * g * h * h;
  Violation penetration{.law = "penetration", .unit = "m"};
  Violation momentum{.law = "momentum", .unit = "N s"};
  momentum.allowance = 1e-9 * mass_kg * std::max(g, 1.0);
  DeepestOverlap overlaps(world);
  for (std::size_t number = 1; number < recording.states.size(); ++number) {
    const Step step{scene, recording, number};
    if (number % plan.stride == 0) see_impulses(impulse, step);
    const double rise = energy_j(world, recording.states[number]) -
                        energy_j(world, recording.states[number - 1]) - work_j(step);
    see(energy, std::max(0.0, rise), step, world.bodies[most_energised(step)].name, "");
    const Overlap overlap = overlaps.find(recording.states[number]);
    see(penetration, overlap.depth_m, step, world.bodies[overlap.body_a].name,
        world.bodies[overlap.body_b].name);
    see(momentum, horizontal_excess_ns(step), step, "", "");
  }
  if (penetration.looked_at > 0) {
    penetration.total /= static_cast<double>(penetration.looked_at);
  }
  return {impulse, energy, penetration, momentum};
}

}  // namespace brickbench::gate
