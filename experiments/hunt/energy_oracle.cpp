// Energy is never created: docs/hunt.md, section energy.
#include <algorithm>

#include "experiments/hunt/bounds.hpp"
#include "experiments/hunt/extent.hpp"
#include "experiments/hunt/oracles.hpp"
#include "experiments/metrics/mechanics.hpp"

namespace brickbench::hunt {
namespace {

// Above this restitution, Newton's law with Coulomb's friction may itself create energy: see
// may_create().
constexpr double k_tame_restitution = 0.3;
// ... and then only this multiple of all energy that there was counts: an explosion.
constexpr double k_explosion = 100.0;

// For one impact the law gives at most 2 c s - s^2 - (1 - e^2) in units of the energy of approach,
// with s the slip and c the coupling of normal and tangential impulse (Kane and Levinson's
// paradox): never positive for c^2 <= 1 - e^2. A rod has c = 0.6, a slab on its edge c^2 = 0.75.
bool may_create(const ContactLaw& law) {
  return law.friction > 0.0 && law.restitution > k_tame_restitution;
}

// The larger of the work at the mean velocity and at that without contacts: which of the two an
// engine's contacts let through depends on their order within the step.
double work_j(const World& world, const gate::StepRecord& record) {
  double sum_j = 0.0;
  for (std::size_t i = 0; i < record.before.size(); ++i) {
    const Body& body = world.bodies[i];
    if (body.fixed || is_zero(record.wrenches[i])) continue;
    const State& before = record.before[i];
    const State& after = record.after[i];
    const Eigen::Vector3d push_ns = record.step_s * record.wrenches[i].force_n;
    const Eigen::Vector3d twist_nms = record.step_s * record.wrenches[i].torque_nm;
    const double mean_j =
        0.5 * (push_ns.dot(before.velocity_mps + after.velocity_mps) +
               twist_nms.dot(before.angular_velocity_radps + after.angular_velocity_radps));
    const double free_j = push_ns.dot(before.velocity_mps) +
                          0.5 * push_ns.squaredNorm() / body.mass_kg +
                          twist_nms.dot(before.angular_velocity_radps) +
                          0.5 * twist_nms.squaredNorm() / body.inertia_kgm2.minCoeff();
    sum_j += std::max(mean_j, free_j);
  }
  return sum_j;
}

// What the attitude of one step may add, J: a rule that turns by 2 atan(h w / 2) or the like is
// off by (h w)^3 / 12, and the energy of a held angular momentum changes by the gyroscopic torque
// times that angle.
double attitude_energy_j(const World& world, const gate::StepRecord& record) {
  double sum_j = 0.0;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    if (world.bodies[i].fixed) continue;
    const Eigen::Vector3d& spin_radps = record.before[i].angular_velocity_radps;
    const double turn_rad = record.step_s * spin_radps.norm();
    const double torque_nm = spin_radps.cross(spin_nms(world.bodies[i], record.before[i])).norm();
    sum_j += torque_nm * turn_rad * turn_rad * turn_rad / 12.0;
  }
  return sum_j;
}

}  // namespace

std::optional<Breach> energy_breach(const Motion& motion) {
  const World& world = motion.scene.world;
  double mass_kg = 0.0;
  for (const Body& body : world.bodies) mass_kg += body.fixed ? 0.0 : body.mass_kg;
  const double unseen_mps = rounding_speed_mps(motion);
  const double unseen_j = mass_kg * unseen_mps * unseen_mps;
  const bool loose = may_create(greatest_law(world));
  const double start_j = gate::energy_j(world, motion.states.front());
  const double fall_j = height_energy_j(world, motion.states.front());
  Fastest fastest(world);
  double most_kinetic_j = kinetic_j(world, motion.states.front());
  const double first_kinetic_j = most_kinetic_j;
  double given_j = 0.0;
  double scheme_j = 0.0;
  Worst worst;
  for (std::size_t n = 0; n < motion.steps(); ++n) {
    const gate::StepRecord record = motion.record(n);
    given_j += work_j(world, record);
    scheme_j += gate::energy_allowance_j(world, record, motion.scheme, k_rounding);
    scheme_j += attitude_energy_j(world, record);
    most_kinetic_j = std::max(most_kinetic_j, kinetic_j(world, record.after));
    fastest.see(motion.states[n]);
    fastest.see(motion.states[n + 1]);
    const double excess_j = gate::energy_j(world, record.after) - start_j - given_j;
    const double first_order_j = first_order_energy_j(world, fastest, motion.step_s);
    const double scale_j = most_kinetic_j + edge_energy_j(world);
    const double allowed_j =
        unseen_j +
        (loose ? k_explosion * (first_kinetic_j + std::max(given_j, 0.0) + fall_j + scheme_j)
               : scheme_j + first_order_j + k_energy_share * scale_j);
    worst.see({"energy", excess_j, allowed_j, "J", n + 1, 0.0, ""});
  }
  return worst.breach(motion);
}

}  // namespace brickbench::hunt
