// What the solvers of this folder share.
#pragma once

#include <string>

#include "ourengine/contact/solvers.hpp"
#include "ourengine/contact/system.hpp"

namespace ourengine {

// Outcome of a method on a compiled system, before it is handed back to the caller.
struct Outcome {
  AlignedDoubles f;  // impulses, components x stride
  AlignedDoubles v;  // velocities that belong to f: v_free + M^-1 J^T f
  double residual = 0.0;
  int iterations = 0;
  SolveStatus status = SolveStatus::kMaxIterations;
};

// Zero impulses and what they are worth under the law: finite, and what any other iterate must
// beat.
Outcome no_impulses(const ContactSystem& system, ContactLaw law);

// Replaces `best` by impulses of a smaller residual; what is not finite has an infinite one.
void keep_better(Outcome& best, const AlignedDoubles& f, const AlignedDoubles& v, double residual);

inline int iterations_or(const SolveOptions& options, int standard) {
  return options.max_iterations > 0 ? options.max_iterations : standard;
}

// The largest friction coefficient of the problem's contacts.
double largest_friction(const ContactProblem& problem);

// The answer of a method that does not cover the problem: free velocities, no impulses, the
// residual of that, kUnsuitable.
ContactSolution unsuitable(const ContactProblem& problem, std::string method);

// From internal arrays to the caller's.
ContactSolution hand_back(const ContactProblem& problem, const ContactSystem& system,
                          const Outcome& outcome, std::string method);

// The methods on a compiled system (components as each demands), for the solvers and for `exact`.
Outcome ipm(const ContactSystem& system, const SolveOptions& options, BlockCholesky& cholesky);
Outcome socp(const ContactSystem& system, const SolveOptions& options, BlockCholesky& cholesky);
Outcome alm(const ContactSystem& system, const SolveOptions& options, const AlignedDoubles& start,
            BlockCholesky& cholesky);
Outcome newton(const ContactSystem& system, const SolveOptions& options,
               const AlignedDoubles& start, BlockLu& lu);
Outcome dantzig(const ContactSystem& system, const SolveOptions& options);
Outcome nsgs(const ContactSystem& system, const SolveOptions& options, const AlignedDoubles& start);

}  // namespace ourengine
