// Carnot's theorem for every step: docs/hunt.md, section impact.
#include <algorithm>
#include <cmath>

#include "experiments/exact/scheme_map.hpp"
#include "experiments/hunt/bounds.hpp"
#include "experiments/hunt/extent.hpp"
#include "experiments/hunt/oracles.hpp"
#include "experiments/metrics/deepest_overlap.hpp"

namespace brickbench::hunt {
namespace {

// Of the energy of the velocities that the step's impulses gave: a restitution that is off by as
// much is told, less is the error of a solver that was stopped.
constexpr double k_impact_share = 0.1;

// What the impulses of one step did.
struct Impulses {
  double gift_j = 0.0;     // (v+ + e v-) . p, with p the impulses: never positive
  double change_j = 0.0;   // p . M^-1 p / 2
  double size_ns = 0.0;    // sum of |p|
  double slip_mps = 0.0;   // fastest point of any body before
  double turn_mps2 = 0.0;  // largest w^2 r: how fast a point of contact turns away
};

// p = M (v+ - v_free), with the free step that the engine states.
Impulses impulses_of(const World& world, const gate::StepRecord& record, const Scheme& scheme,
                     double restitution) {
  Impulses all;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (body.fixed) continue;
    const State& before = record.before[i];
    const State& after = record.after[i];
    const State free = exact::next_free_state(scheme, body, before, record.wrenches[i],
                                              world.gravity_mps2, record.step_s);
    const Eigen::Vector3d push_ns = body.mass_kg * (after.velocity_mps - free.velocity_mps);
    const Eigen::Quaterniond turn = after.orientation.normalized();
    const Eigen::Vector3d spun_radps = after.angular_velocity_radps - free.angular_velocity_radps;
    const Eigen::Vector3d twist_nms =
        turn * body.inertia_kgm2.cwiseProduct(turn.conjugate() * spun_radps);
    const Eigen::Vector3d speed_mps = after.velocity_mps + restitution * before.velocity_mps;
    const Eigen::Vector3d spin_radps =
        after.angular_velocity_radps + restitution * before.angular_velocity_radps;
    all.gift_j += push_ns.dot(speed_mps) + twist_nms.dot(spin_radps);
    all.change_j += 0.5 * (push_ns.squaredNorm() / body.mass_kg + twist_nms.dot(spun_radps));
    all.size_ns += push_ns.norm() + twist_nms.norm() / reach_m(body.shape);
    all.slip_mps = std::max(all.slip_mps, fastest_point_mps(body, before));
    const double spin_of_body = std::max(before.angular_velocity_radps.squaredNorm(),
                                         after.angular_velocity_radps.squaredNorm());
    all.turn_mps2 = std::max(all.turn_mps2, spin_of_body * reach_m(body.shape));
  }
  return all;
}

// Speed, m/s, at which the engine may push an overlap apart.
double push_mps(const Motion& motion, double depth_m) {
  if (!motion.scheme || !motion.scheme->impulse) return depth_m / motion.step_s;
  const ImpulseContact& contact = *motion.scheme->impulse;
  return std::min(contact.error_reduction * depth_m / motion.step_s, contact.max_correction_mps);
}

}  // namespace

std::optional<Breach> impact_breach(const Motion& motion) {
  const World& world = motion.scene.world;
  if (!motion.scheme) return std::nullopt;
  const ContactLaw law = greatest_law(world);
  // With restitution the theorem is proven for contacts that all bounce: one pair.
  const bool one_pair = world.bodies.size() == 2;
  if (law.restitution > 0.0 && !one_pair) return std::nullopt;
  DeepestOverlap overlap(world);
  const double edge_j = edge_energy_j(world);
  Worst worst;
  for (std::size_t n = 0; n < motion.steps(); ++n) {
    const gate::StepRecord record = motion.record(n);
    const Impulses p = impulses_of(world, record, *motion.scheme, law.restitution);
    const double scale_j = kinetic_j(world, record.before) + edge_j;
    const double h = motion.step_s;
    const double depth_m =
        std::max(overlap.find(record.before).depth_m, overlap.find(record.after).depth_m);
    const double slack_mps =
        push_mps(motion, depth_m) + h * (2.0 * world.gravity_mps2.norm() + p.turn_mps2);
    const double cone = law.friction / std::hypot(1.0, law.friction);
    const double slip_mps = law.restitution * cone * p.slip_mps;
    const double allowed_j =
        k_impact_share * p.change_j + p.size_ns * (slack_mps + slip_mps) + k_energy_share * scale_j;
    worst.see({"impact", p.gift_j, allowed_j, "J", n + 1, 0.0, ""});
  }
  return worst.breach(motion);
}

}  // namespace brickbench::hunt
