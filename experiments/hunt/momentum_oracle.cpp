// Momentum of bodies among themselves: docs/hunt.md, section momentum.
#include <algorithm>

#include "experiments/hunt/bounds.hpp"
#include "experiments/hunt/extent.hpp"
#include "experiments/hunt/oracles.hpp"
#include "experiments/metrics/mechanics.hpp"

namespace brickbench::hunt {
namespace {

// Of the sum of all momenta and impulses without signs: action equals reaction whatever a solver
// leaves undone, so that only rounding remains, of some thousand steps. Engines that count in
// single precision inside round at 1.2e-7 in every sub-step.
constexpr double k_momentum_share = 1e-9;
constexpr double k_single_share = 1e-4;

double share_of(const Motion& motion) { return motion.single ? k_single_share : k_momentum_share; }

Eigen::Vector3d momentum_ns(const World& world, std::span<const State> states) {
  Eigen::Vector3d sum_ns = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < states.size(); ++i) {
    sum_ns += world.bodies[i].mass_kg * states[i].velocity_mps;
  }
  return sum_ns;
}

struct Spin {
  Eigen::Vector3d about_centre_nms = Eigen::Vector3d::Zero();
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  double size_nms = 0.0;  // sum without signs
};

Spin spin_of(const World& world, std::span<const State> states) {
  Spin spin;
  double mass_kg = 0.0;
  Eigen::Vector3d drift_mps = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < states.size(); ++i) {
    mass_kg += world.bodies[i].mass_kg;
    spin.centre_m += world.bodies[i].mass_kg * states[i].position_m;
    drift_mps += world.bodies[i].mass_kg * states[i].velocity_mps;
  }
  spin.centre_m /= mass_kg;
  drift_mps /= mass_kg;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const Body& body = world.bodies[i];
    const Eigen::Vector3d own_nms = spin_nms(body, states[i]);
    const Eigen::Vector3d orbit_nms =
        body.mass_kg *
        (states[i].position_m - spin.centre_m).cross(states[i].velocity_mps - drift_mps);
    spin.about_centre_nms += own_nms + orbit_nms;
    spin.size_nms += own_nms.norm() + orbit_nms.norm();
  }
  return spin;
}

// What one step may change by being of first order: gyroscopic terms, and the arm of each impulse,
// which is off by the way of a step and by the overlap that is pushed out.
double first_order_nms(const World& world, const gate::StepRecord& record) {
  const double h = record.step_s;
  double sum_nms = 0.0;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    const State& before = record.before[i];
    const State& after = record.after[i];
    const Eigen::Vector3d own_nms = spin_nms(body, before);
    const double torque_nm = before.angular_velocity_radps.cross(own_nms).norm();
    // The second: turning with the spin of the step's end instead of its start.
    sum_nms += h * torque_nm + h * h * torque_nm / body.inertia_kgm2.minCoeff() * own_nms.norm();
    const double push_ns =
        body.mass_kg * (after.velocity_mps - before.velocity_mps - h * world.gravity_mps2).norm();
    const double way_m = h * (fastest_point_mps(body, before) + fastest_point_mps(body, after)) +
                         (after.position_m - before.position_m).norm();
    sum_nms += push_ns * way_m + body.mass_kg * after.velocity_mps.norm() *
                                     ((after.position_m - before.position_m -
                                       0.5 * h * (before.velocity_mps + after.velocity_mps))
                                          .norm());
  }
  return sum_nms;
}

// N m s: velocities are rounded, at the arms of their bodies about the common centre.
double rounding_nms(const Motion& motion, const gate::StepRecord& record,
                    const Eigen::Vector3d& centre_m, double unseen_mps) {
  const World& world = motion.scene.world;
  double sum_nms = 0.0, unseen_nms = 0.0;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const double arm_m =
        (record.after[i].position_m - centre_m).norm() + reach_m(world.bodies[i].shape);
    sum_nms += world.bodies[i].mass_kg * arm_m *
               (fastest_point_mps(world.bodies[i], record.before[i]) +
                fastest_point_mps(world.bodies[i], record.after[i]));
    unseen_nms += world.bodies[i].mass_kg * arm_m * unseen_mps;
  }
  return (motion.single ? k_single_rounding : k_rounding) * sum_nms + unseen_nms;
}

}  // namespace

std::optional<Breach> momentum_breach(const Motion& motion) {
  const World& world = motion.scene.world;
  if (has_fixed(world)) return std::nullopt;
  const Eigen::Vector3d start_ns = momentum_ns(world, motion.states.front());
  Eigen::Vector3d given_ns = Eigen::Vector3d::Zero();
  double size_ns = 0.0;
  double unseen_ns = 0.0;
  const double unseen_mps = rounding_speed_mps(motion);
  for (const Body& body : world.bodies) unseen_ns += body.mass_kg * unseen_mps;
  Worst worst;
  for (std::size_t n = 0; n < motion.steps(); ++n) {
    double now_ns = 0.0;
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      const Eigen::Vector3d push_ns =
          motion.step_s *
          (motion.wrenches[n][i].force_n + world.bodies[i].mass_kg * world.gravity_mps2);
      given_ns += push_ns;
      size_ns += push_ns.norm();
      now_ns += world.bodies[i].mass_kg * (motion.states[n][i].velocity_mps.norm() +
                                           motion.states[n + 1][i].velocity_mps.norm());
    }
    const double error_ns = (momentum_ns(world, motion.states[n + 1]) - start_ns - given_ns).norm();
    const double allowed_ns = share_of(motion) * (size_ns + now_ns) + unseen_ns;
    worst.see({"momentum", error_ns, allowed_ns, "N s", n + 1, 0.0, ""});
  }
  return worst.breach(motion);
}

std::optional<Breach> spin_breach(const Motion& motion) {
  const World& world = motion.scene.world;
  // An engine that neglects gyroscopic torques says so: its error has no bound.
  const bool neglects = !motion.scheme || motion.scheme->gyroscopic == GyroscopicRule::neglected;
  if (has_fixed(world) || neglects) return std::nullopt;
  const Spin start = spin_of(world, motion.states.front());
  Eigen::Vector3d given_nms = Eigen::Vector3d::Zero();
  double given_size_nms = 0.0;
  double slack_nms = 0.0;
  const double unseen_mps = rounding_speed_mps(motion);
  Worst worst;
  for (std::size_t n = 0; n < motion.steps(); ++n) {
    const gate::StepRecord record = motion.record(n);
    const Spin now = spin_of(world, record.after);
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      const Eigen::Vector3d arm_m =
          0.5 * (record.before[i].position_m + record.after[i].position_m) - now.centre_m;
      const Eigen::Vector3d moment_nms =
          motion.step_s * (arm_m.cross(record.wrenches[i].force_n) + record.wrenches[i].torque_nm);
      given_nms += moment_nms;
      given_size_nms += moment_nms.norm();
    }
    slack_nms +=
        first_order_nms(world, record) + rounding_nms(motion, record, now.centre_m, unseen_mps);
    const double error_nms = (now.about_centre_nms - start.about_centre_nms - given_nms).norm();
    const double allowed_nms =
        share_of(motion) * (now.size_nms + start.size_nms + given_size_nms) + slack_nms;
    worst.see({"spin", error_nms, allowed_nms, "N m s", n + 1, 0.0, ""});
  }
  return worst.breach(motion);
}

}  // namespace brickbench::hunt
