#include "ourengine/exact/rebound.hpp"

#include <algorithm>
#include <cmath>

namespace ourengine {
namespace {

// Of the kinetic energy: gains below this are the residual of the solver (1e-10 of velocities).
constexpr double k_gain_tolerance = 1e-9;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

double kinetic_j(const ProblemBody& body, const Velocity6& v) {
  return 0.5 * (body.mass_kg * v.head<3>().squaredNorm() +
                v.tail<3>().dot(body.inertia_kgm2 * v.tail<3>()));
}

// Energy (J) that the contacts give to a body that ends with velocity v.
double gain_j(const ProblemBody& body, const BodyStep& step, const Velocity6& v) {
  const Eigen::Vector3d moved_m = step.span_s * v.head<3>() + step.lag_m;
  const Eigen::Vector3d turned_rad = 0.5 * step.span_s * (v.tail<3>() + step.before.tail<3>());
  return kinetic_j(body, v) - kinetic_j(body, step.before) -
         body.mass_kg * step.acceleration_mps2.dot(moved_m) - step.torque_nm.dot(turned_rad);
}

bool is_struck(const ContactProblem& problem, const Island& island, double resting_mps) {
  return std::ranges::any_of(island.contacts, [&](int c) {
    const ProblemContact& contact = problem.contacts[index(c)];
    return contact.restitution > 0.0 || contact.approach_mps < -resting_mps;
  });
}

// (bodies) whether an impulse acts on it.
std::vector<bool> pushed_bodies(const ContactProblem& problem,
                                std::span<const Eigen::Vector3d> impulses_ns) {
  std::vector<bool> pushed(problem.bodies.size(), false);
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    if (impulses_ns[c].isZero(0.0)) continue;
    pushed[index(problem.contacts[c].body_a)] = true;
    pushed[index(problem.contacts[c].body_b)] = true;
  }
  return pushed;
}

ContactProblem without_bounces(ContactProblem problem) {
  for (ProblemContact& contact : problem.contacts) {
    contact.restitution = 0.0;
    contact.gap_m = std::max(0.0, contact.gap_m);
  }
  return problem;
}

// The largest s in 0 .. 1 with gain(s) <= 0 of a parabola with gain(0), gain(1) > 0 and curvature
// gain'' / 2 >= 0.
double largest_share(double at_0, double at_1, double curvature) {
  if (at_0 >= 0.0) return 0.0;
  const double slope = at_1 - at_0 - curvature;
  const double root = std::sqrt(slope * slope - 4.0 * curvature * at_0);
  return std::clamp(slope > 0.0 ? -2.0 * at_0 / (slope + root) : (root - slope) / (2.0 * curvature),
                    0.0, 1.0);
}

}  // namespace

double keep_energy(const ContactProblem& problem, std::span<const Island> islands,
                   std::span<const BodyStep> steps, double resting_mps, Solver solver,
                   const SolveOptions& options, SolverMemory& memory, ContactSolution& solution) {
  double least_share = 1.0;
  const std::vector<bool> pushed = pushed_bodies(problem, solution.impulse_ns);
  for (const Island& island : islands) {
    if (!is_struck(problem, island, resting_mps)) continue;
    const auto moves = [&](int i) { return !problem.bodies[index(i)].fixed && pushed[index(i)]; };
    double gained_j = 0.0;
    double scale_j = 0.0;
    for (const int i : island.bodies) {
      if (!moves(i)) continue;
      const ProblemBody& body = problem.bodies[index(i)];
      gained_j += gain_j(body, steps[index(i)], solution.velocity[index(i)]);
      scale_j += kinetic_j(body, solution.velocity[index(i)]);
    }
    if (!(gained_j > k_gain_tolerance * scale_j)) continue;

    WarmStart warm;
    for (const int c : island.contacts) warm.impulses_ns.push_back(solution.impulse_ns[index(c)]);
    const ContactSolution plastic =
        solver(without_bounces(extract(problem, island)), options, warm, memory);
    solution.iterations += plastic.iterations;
    solution.factorisations += plastic.factorisations;
    double plastic_j = 0.0;
    double curvature_j = 0.0;
    for (std::size_t k = 0; k < island.bodies.size(); ++k) {
      const int i = island.bodies[k];
      if (problem.bodies[index(i)].fixed) continue;
      const ProblemBody& body = problem.bodies[index(i)];
      const Velocity6 change = solution.velocity[index(i)] - plastic.velocity[k];
      if (!moves(i) && change.isZero(0.0)) continue;
      plastic_j += gain_j(body, steps[index(i)], plastic.velocity[k]);
      curvature_j += kinetic_j(body, change);
    }
    const double share = largest_share(plastic_j, gained_j, curvature_j);
    least_share = std::min(least_share, share);
    for (std::size_t k = 0; k < island.bodies.size(); ++k) {
      Velocity6& v = solution.velocity[index(island.bodies[k])];
      v = plastic.velocity[k] + share * (v - plastic.velocity[k]);
    }
    for (std::size_t k = 0; k < island.contacts.size(); ++k) {
      Eigen::Vector3d& impulse_ns = solution.impulse_ns[index(island.contacts[k])];
      impulse_ns = plastic.impulse_ns[k] + share * (impulse_ns - plastic.impulse_ns[k]);
    }
  }
  return least_share;
}

}  // namespace ourengine
