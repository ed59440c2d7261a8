#include "experiments/oracle/impulse_oracle.hpp"

#include <algorithm>
#include <cmath>

#include "adapters/seam/shape.hpp"
#include "experiments/metrics/mechanics.hpp"
#include "experiments/metrics/placed.hpp"
#include "experiments/oracle/contact_candidates.hpp"

namespace brickbench::gate {
namespace {

// An upper bound of how far any point of the body travels in the step.
double travel_m(const Shape& shape, const StepRecord& record, std::size_t body) {
  if (is_half_space(shape)) return 0.0;
  const auto speed = [&](const State& s) {
    return s.velocity_mps.norm() + s.angular_velocity_radps.norm() * bounding_radius_m(shape);
  };
  return record.step_s * std::max(speed(record.before[body]), speed(record.after[body]));
}

struct PairBuilder {
  const World& world;
  const StepRecord& record;
  const std::vector<std::size_t>& index;  // of the body among those that move
  ConeProblem& problem;
  const ContactRoom& room;
  std::vector<ContactCandidate> found = {};

  void add(std::size_t a, std::size_t b) {
    const Body& body_a = world.bodies[a];
    const Body& body_b = world.bodies[b];
    const double size_m = std::min(thickness_m(body_a.shape), thickness_m(body_b.shape));
    const double moved_m = travel_m(body_a.shape, record, a) + travel_m(body_b.shape, record, b);
    const double room_m = room.gap_share * size_m;
    const CandidateRange range{room_m + moved_m, room_m, room.border_share * size_m};
    const double gap_m = (record.before[b].position_m - record.before[a].position_m).norm() -
                         bounding_radius_m(body_a.shape) - bounding_radius_m(body_b.shape);
    if (gap_m > room_m + moved_m) return;
    add_from(a, b, record.before, range);
    if (moved_m > 0.01 * size_m) add_from(a, b, record.after, range);
  }

  void add_from(std::size_t a, std::size_t b, std::span<const State> states,
                const CandidateRange& range) {
    found.clear();
    contact_candidates(world.bodies[a].shape, states[a], world.bodies[b].shape, states[b], range,
                       found);
    for (const ContactCandidate& candidate : found) {
      if (!room.head_joints && std::abs(candidate.normal.z()) < M_SQRT1_2) continue;
      ConeContact contact;
      contact.body_a = index[a];
      contact.body_b = index[b];
      contact.arm_a_m = candidate.position_m - states[a].position_m;
      contact.arm_b_m = candidate.position_m - states[b].position_m;
      contact.normal = candidate.normal;
      contact.friction = contact_law(world, a, b).friction;
      problem.contacts.push_back(contact);
    }
  }
};

std::vector<std::size_t> moving_index(const World& world) {
  std::vector<std::size_t> index(world.bodies.size(), ConeContact::none);
  std::size_t next = 0;
  for (std::size_t i = 0; i < index.size(); ++i) {
    if (!world.bodies[i].fixed) index[i] = next++;
  }
  return index;
}

}  // namespace

ConeProblem cone_problem(const World& world, const StepRecord& record, const ContactRoom& room) {
  const std::vector<std::size_t> index = moving_index(world);
  ConeProblem problem;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (body.fixed) continue;
    const State& before = record.before[i];
    const State& after = record.after[i];
    problem.linear_ns.push_back(
        body.mass_kg * (after.velocity_mps - before.velocity_mps) -
        record.step_s * (body.mass_kg * world.gravity_mps2 + record.wrenches[i].force_n));
    problem.angular_nms.push_back(spin_nms(body, after) - spin_nms(body, before) -
                                  record.step_s * record.wrenches[i].torque_nm);
    problem.gyration_m.push_back(std::sqrt(body.inertia_kgm2.mean() / body.mass_kg));
  }
  PairBuilder builder{world, record, index, problem, room};
  for (std::size_t a = 0; a < world.bodies.size(); ++a) {
    for (std::size_t b = a + 1; b < world.bodies.size(); ++b) {
      if (world.bodies[a].fixed && world.bodies[b].fixed) continue;
      if (room.with_fixed_only && !world.bodies[a].fixed && !world.bodies[b].fixed) continue;
      builder.add(a, b);
    }
  }
  return problem;
}

Unexplained unexplained_momentum(const World& world, const StepRecord& record, double gap_ns) {
  const ConeProblem problem = cone_problem(world, record);
  const ConeSolution solution = solve(problem, gap_ns);
  Unexplained result;
  result.upper_ns = solution.residual_ns;
  result.lower_ns = solution.bound_ns;
  result.contacts = problem.contacts.size();
  double square = 0.0;
  double largest = -1.0;
  std::size_t worst = 0;
  std::vector<std::size_t> body_of;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    if (!world.bodies[i].fixed) body_of.push_back(i);
  }
  for (std::size_t i = 0; i < body_of.size(); ++i) {
    const double g = problem.gyration_m[i];
    square += problem.linear_ns[i].squaredNorm() + (problem.angular_nms[i] / g).squaredNorm();
    const double left = solution.linear_residual_ns[i].squaredNorm() +
                        (solution.angular_residual_nms[i] / g).squaredNorm();
    if (left > largest) {
      largest = left;
      worst = i;
    }
  }
  result.given_ns = std::sqrt(square);
  result.worst_body = body_of[worst];
  result.worst_partner = result.worst_body;
  double push = 0.0;
  const std::vector<std::size_t> index = moving_index(world);
  std::size_t fixed = result.worst_body;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    if (world.bodies[i].fixed) fixed = i;
  }
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const ConeContact& contact = problem.contacts[c];
    if (contact.body_a != worst && contact.body_b != worst) continue;
    if (solution.impulses_ns[c].norm() < push) continue;
    push = solution.impulses_ns[c].norm();
    const std::size_t other = contact.body_a == worst ? contact.body_b : contact.body_a;
    result.worst_partner = other == ConeContact::none ? fixed : body_of[other];
  }
  return result;
}

}  // namespace brickbench::gate
