#include "experiments/oracle/step_laws.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "experiments/metrics/mechanics.hpp"

namespace brickbench::gate {
namespace {

struct Cone {
  Eigen::Vector3d normal;  // into the moving body
  double friction;
};

// The cones of the contacts with fixed bodies, each direction once.
std::vector<Cone> fixed_cones(const World& world, const StepRecord& record) {
  constexpr double same = 1.0 - 1e-12;  // cosine of directions that count as one
  std::vector<Cone> cones;
  for (const ConeContact& contact :
       cone_problem(world, record, {.with_fixed_only = true}).contacts) {
    const Eigen::Vector3d normal =
        contact.body_a == ConeContact::none ? contact.normal : Eigen::Vector3d(-contact.normal);
    const auto known =
        std::ranges::find_if(cones, [&](const Cone& c) { return c.normal.dot(normal) > same; });
    if (known == cones.end()) {
      cones.push_back({normal, contact.friction});
    } else {
      known->friction = std::max(known->friction, contact.friction);
    }
  }
  return cones;
}

double distance_to_cone(const Eigen::Vector3d& given, const Cone& cone) {
  const double along = given.dot(cone.normal);
  const double across = (given - along * cone.normal).norm();
  if (across <= cone.friction * along) return 0.0;
  if (cone.friction * across <= -along) return given.norm();
  return (across - cone.friction * along) / std::hypot(1.0, cone.friction);
}

double gyroscopic_gain_j(const Body& body, const State& state, double step_s) {
  const Eigen::Vector3d spin_radps = state.orientation.conjugate() * state.angular_velocity_radps;
  const Eigen::Vector3d torque_nm = spin_radps.cross(body.inertia_kgm2.cwiseProduct(spin_radps));
  return 0.5 * step_s * step_s * torque_nm.dot(torque_nm.cwiseQuotient(body.inertia_kgm2));
}

}  // namespace

double external_excess_ns(const World& world, const StepRecord& record, double gap_ns) {
  Eigen::Vector3d given_ns = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (body.fixed) continue;
    given_ns += body.mass_kg * (record.after[i].velocity_mps - record.before[i].velocity_mps) -
                record.step_s * (body.mass_kg * world.gravity_mps2 + record.wrenches[i].force_n);
  }
  const std::vector<Cone> cones = fixed_cones(world, record);
  if (cones.empty()) return given_ns.norm();
  if (cones.size() == 1) return distance_to_cone(given_ns, cones.front());
  ConeProblem problem;
  problem.linear_ns = {given_ns};
  problem.angular_nms = {Eigen::Vector3d::Zero()};
  problem.gyration_m = {1.0};
  for (const Cone& cone : cones) {
    ConeContact contact;
    contact.body_b = 0;
    contact.normal = cone.normal;
    contact.friction = cone.friction;
    problem.contacts.push_back(contact);
  }
  return solve(problem, gap_ns).residual_ns;
}

double energy_j(const World& world, std::span<const State> states) {
  double sum = 0.0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (world.bodies[i].fixed) continue;
    sum += kinetic_energy_j(world.bodies[i], states[i]) -
           world.bodies[i].mass_kg * world.gravity_mps2.dot(states[i].position_m);
  }
  return sum;
}

double energy_gain_j(const World& world, const StepRecord& record) {
  double work_j = 0.0;
  for (std::size_t i = 0; i < record.before.size(); ++i) {
    const State& before = record.before[i];
    const State& after = record.after[i];
    work_j += 0.5 * record.step_s *
              (record.wrenches[i].force_n.dot(before.velocity_mps + after.velocity_mps) +
               record.wrenches[i].torque_nm.dot(before.angular_velocity_radps +
                                                after.angular_velocity_radps));
  }
  return energy_j(world, record.after) - energy_j(world, record.before) - work_j;
}

double energy_allowance_j(const World& world, const StepRecord& record,
                          const std::optional<Scheme>& scheme, double rounding) {
  const bool falls = !scheme || scheme->position == PositionRule::old_velocity;
  const bool spins = !scheme || (scheme->gyroscopic != GyroscopicRule::neglected &&
                                 scheme->gyroscopic != GyroscopicRule::frozen_momentum);
  const double h = record.step_s;
  double allowance_j = 0.0;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (body.fixed) continue;
    const double g = world.gravity_mps2.norm();
    if (falls) allowance_j += 0.5 * body.mass_kg * g * g * h * h;
    if (spins) allowance_j += gyroscopic_gain_j(body, record.before[i], h);
    allowance_j += rounding * (kinetic_energy_j(body, record.before[i]) +
                               body.mass_kg * g * record.before[i].position_m.norm());
  }
  return allowance_j;
}

}  // namespace brickbench::gate
