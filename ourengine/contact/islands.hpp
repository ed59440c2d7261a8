// Islands: the parts of a contact problem that do not influence each other.
#pragma once

#include <vector>

#include "ourengine/contact/solvers.hpp"

namespace ourengine {

struct Island {
  std::vector<int> bodies;    // of the problem, ascending; the fixed ones that it touches included
  std::vector<int> contacts;  // of the problem, ascending
};

// Bodies connected by contacts; fixed bodies do not connect. Islands come in the order of their
// first body. Bodies without contact are in none.
std::vector<Island> find_islands(const ContactProblem& problem);

// The island as a problem of its own.
ContactProblem extract(const ContactProblem& problem, const Island& island);

// Solves island by island and puts the results together: iterations and factorisations are sums,
// residual and status are those of the worst island, each measured against its own speeds (a brick
// in flight elsewhere does not excuse a wall that rests).
ContactSolution solve_islands(const ContactProblem& problem, Solver solver,
                              const SolveOptions& options, const WarmStart& warm,
                              SolverMemory& memory);

}  // namespace ourengine
