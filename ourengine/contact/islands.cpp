#include "ourengine/contact/islands.hpp"

#include <algorithm>
#include <numeric>

namespace ourengine {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

int root_of(std::vector<int>& parent, int i) {
  while (parent[at(i)] != i) {
    parent[at(i)] = parent[at(parent[at(i)])];
    i = parent[at(i)];
  }
  return i;
}

bool worse(SolveStatus a, SolveStatus b) { return static_cast<int>(a) > static_cast<int>(b); }

}  // namespace

std::vector<Island> find_islands(const ContactProblem& problem) {
  const int bodies = static_cast<int>(problem.bodies.size());
  const auto moves = [&](int i) { return !problem.bodies[at(i)].fixed; };
  std::vector<int> parent(at(bodies));
  std::iota(parent.begin(), parent.end(), 0);
  for (const ProblemContact& contact : problem.contacts) {
    if (!moves(contact.body_a) || !moves(contact.body_b)) continue;
    const int a = root_of(parent, contact.body_a), b = root_of(parent, contact.body_b);
    parent[at(std::max(a, b))] = std::min(a, b);
  }
  std::vector<int> island_of(at(bodies), -1);  // of a root, which is an island's first body
  std::vector<char> touched(at(bodies), 0);
  for (const ProblemContact& contact : problem.contacts) {
    for (const int i : {contact.body_a, contact.body_b}) {
      if (moves(i)) touched[at(root_of(parent, i))] = 1;
    }
  }
  std::vector<Island> islands;
  for (int i = 0; i < bodies; ++i) {
    if (!moves(i)) continue;
    const int root = root_of(parent, i);
    if (touched[at(root)] == 0) continue;
    if (island_of[at(root)] < 0) {
      island_of[at(root)] = static_cast<int>(islands.size());
      islands.emplace_back();
    }
    islands[at(island_of[at(root)])].bodies.push_back(i);
  }
  for (int c = 0; c < static_cast<int>(problem.contacts.size()); ++c) {
    const ProblemContact& contact = problem.contacts[at(c)];
    const int mover = moves(contact.body_a) ? contact.body_a : contact.body_b;
    if (!moves(mover)) continue;
    Island& island = islands[at(island_of[at(root_of(parent, mover))])];
    island.contacts.push_back(c);
    for (const int i : {contact.body_a, contact.body_b}) {
      if (!moves(i)) island.bodies.push_back(i);
    }
  }
  for (Island& island : islands) {
    std::sort(island.bodies.begin(), island.bodies.end());
    island.bodies.erase(std::unique(island.bodies.begin(), island.bodies.end()),
                        island.bodies.end());
  }
  return islands;
}

ContactProblem extract(const ContactProblem& problem, const Island& island) {
  ContactProblem part;
  part.step_s = problem.step_s;
  part.recovery_mps = problem.recovery_mps;
  part.least_speed_mps = problem.least_speed_mps;
  const auto local = [&](int body) {
    return static_cast<int>(std::lower_bound(island.bodies.begin(), island.bodies.end(), body) -
                            island.bodies.begin());
  };
  for (const int i : island.bodies) {
    part.bodies.push_back(problem.bodies[at(i)]);
    part.free_velocity.push_back(problem.free_velocity[at(i)]);
  }
  for (const int c : island.contacts) {
    part.contacts.push_back(problem.contacts[at(c)]);
    part.contacts.back().body_a = local(part.contacts.back().body_a);
    part.contacts.back().body_b = local(part.contacts.back().body_b);
  }
  return part;
}

ContactSolution solve_islands(const ContactProblem& problem, Solver solver,
                              const SolveOptions& options, const WarmStart& warm,
                              SolverMemory& memory) {
  const std::vector<Island> islands = find_islands(problem);
  if (islands.size() == 1 && islands[0].contacts.size() == problem.contacts.size())
    return solver(problem, options, warm, memory);
  ContactSolution whole;
  whole.velocity = problem.free_velocity;
  whole.impulse_ns.assign(problem.contacts.size(), Eigen::Vector3d::Zero());
  for (const Island& island : islands) {
    WarmStart start;
    if (!warm.impulses_ns.empty()) {
      for (const int c : island.contacts) start.impulses_ns.push_back(warm.impulses_ns[at(c)]);
    }
    const ContactSolution part = solver(extract(problem, island), options, start, memory);
    for (std::size_t i = 0; i < island.bodies.size(); ++i)
      whole.velocity[at(island.bodies[i])] = part.velocity[i];
    for (std::size_t c = 0; c < island.contacts.size(); ++c)
      whole.impulse_ns[at(island.contacts[c])] = part.impulse_ns[c];
    whole.iterations += part.iterations;
    whole.factorisations += part.factorisations;
    if (worse(part.status, whole.status)) whole.status = part.status;
    whole.residual = std::max(whole.residual, part.residual);
    if (whole.method.find(part.method) == std::string::npos)
      whole.method += (whole.method.empty() ? "" : ", ") + part.method;
  }
  return whole;
}

}  // namespace ourengine
