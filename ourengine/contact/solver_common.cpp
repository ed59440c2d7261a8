#include "ourengine/contact/solver_common.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace ourengine {

double largest_friction(const ContactProblem& problem) {
  double largest = 0.0;
  for (const ProblemContact& contact : problem.contacts)
    largest = std::max(largest, contact.friction);
  return largest;
}

Outcome no_impulses(const ContactSystem& system, ContactLaw law) {
  Outcome outcome;
  AlignedDoubles w;
  outcome.f.assign(system.rows(), 0.0);
  outcome.residual = contact_residual_of(system, outcome.f, law, outcome.v, w);
  return outcome;
}

void keep_better(Outcome& best, const AlignedDoubles& f, const AlignedDoubles& v, double residual) {
  if (!(residual < best.residual)) return;
  best.f = f;
  best.v = v;
  best.residual = residual;
}

ContactSolution unsuitable(const ContactProblem& problem, std::string method) {
  ContactSolution solution;
  solution.velocity = problem.free_velocity;
  solution.impulse_ns.assign(problem.contacts.size(), Eigen::Vector3d::Zero());
  solution.residual = contact_residual(problem, solution.impulse_ns);
  solution.status = SolveStatus::kUnsuitable;
  solution.method = std::move(method);
  return solution;
}

ContactSolution hand_back(const ContactProblem& problem, const ContactSystem& system,
                          const Outcome& outcome, std::string method) {
  ContactSolution solution;
  system.store(outcome.f, outcome.v, problem, solution);
  solution.iterations = outcome.iterations;
  solution.residual = outcome.residual;
  solution.status = outcome.status;
  solution.method = std::move(method);
  return solution;
}

}  // namespace ourengine
