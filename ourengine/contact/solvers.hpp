// The solvers of a contact problem, all behind one signature, so that methods can be compared on
// equal problems with one residual (residual.hpp). Theory, limits and sources: docs/contact.md.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string_view>
#include <vector>

#include "ourengine/contact/problem.hpp"
#include "ourengine/contact/residual.hpp"
#include "ourengine/linear/block_cholesky.hpp"
#include "ourengine/linear/block_lu.hpp"
#include "ourengine/linear/ordering.hpp"

namespace ourengine {

struct SolveOptions {
  double tolerance = 1e-10;  // on the residual of the solver's law
  int max_iterations = 0;    // of the solver's own unit; 0: its default
  // solve_exact() only: a problem that neither the warm start nor the interior point solves has
  // contacts that slip, where each digit is dear; its residual need not be below this.
  double slip_tolerance = 0.0;
};

// Impulses to start from, one per contact of the problem; empty: a cold start.
struct WarmStart {
  std::vector<Eigen::Vector3d> impulses_ns;
};

// What may be kept from one solve to the next: symbolic factors and buffers. It changes the cost
// of a solve, never its result.
struct SolverMemory {
  // threads >= 1, the caller's included. They change no bit of a result.
  explicit SolverMemory(int threads = 1)
      : SolverMemory(threads > 1 ? std::make_shared<WorkerPool>(threads) : nullptr) {}
  // A pool that others use as well, at other times; null: no threads.
  explicit SolverMemory(std::shared_ptr<WorkerPool> workers) { cholesky.share(std::move(workers)); }

  SymbolicCache symbolic;
  BlockCholesky cholesky;
  BlockLu lu;
};

// A problem that is not well formed (problem_error) is the caller's mistake. A solver that misses
// its tolerance returns its best iterate, the residual it has, and why it stopped.
using Solver = ContactSolution (*)(const ContactProblem& problem, const SolveOptions& options,
                                   const WarmStart& warm, SolverMemory& memory);

// The default of the accurate mode: the exact law, island by island. Warm impulses that are good
// enough are kept. Else methods take over from each other until one reaches the tolerance: with
// friction a few warm steps of `alm`, the interior point `socp`, which is exact where nothing slips
// and left out where they show slip, `newton` from the warm impulses and from cold, `nsgs`; without
// friction `ipm`, `dantzig`, `nsgs`. The best iterate of all of them and of no impulses at all is
// returned; `method` names what gave it. kStalled if it misses the tolerance.
ContactSolution solve_exact(const ContactProblem&, const SolveOptions&, const WarmStart&,
                            SolverMemory&);
// The same for the frictionless law, with the method named as the first. kUnsuitable with friction.
ContactSolution solve_ipm_first(const ContactProblem&, const SolveOptions&, const WarmStart&,
                                SolverMemory&);
ContactSolution solve_dantzig_first(const ContactProblem&, const SolveOptions&, const WarmStart&,
                                    SolverMemory&);
ContactSolution solve_nsgs_first(const ContactProblem&, const SolveOptions&, const WarmStart&,
                                 SolverMemory&);
// Frictionless interior point: Mehrotra's predictor-corrector with a proximal term, in velocity
// space. The law must be frictionless (mu = 0 at all contacts), else kUnsuitable.
ContactSolution solve_ipm(const ContactProblem&, const SolveOptions&, const WarmStart&,
                          SolverMemory&);
// Frictionless Lemke-Dantzig-Baraff pivoting on an incremental Cholesky factor; iterations are
// pivots. kUnsuitable with friction. Starts cold always.
ContactSolution solve_dantzig(const ContactProblem&, const SolveOptions&, const WarmStart&,
                              SolverMemory&);
// Convex friction (ContactLaw::kConvex): second-order-cone interior point with Nesterov-Todd
// scaling. Starts cold always.
ContactSolution solve_socp(const ContactProblem&, const SolveOptions&, const WarmStart&,
                           SolverMemory&);
// Augmented Lagrangian with semismooth Newton steps on Coulomb's cones; exact law, de Saxce's shift
// taken from the previous outer iteration. For warm starts.
ContactSolution solve_alm(const ContactProblem&, const SolveOptions&, const WarmStart&,
                          SolverMemory&);
// The same method with the shift differentiated, hence with LU instead of Cholesky: for contacts
// that slip. Iterations are Newton steps.
ContactSolution solve_newton(const ContactProblem&, const SolveOptions&, const WarmStart&,
                             SolverMemory&);
// Projected (nonsmooth) Gauss-Seidel on the exact law; with mu = 0 it is PGS. Iterations: sweeps.
ContactSolution solve_nsgs(const ContactProblem&, const SolveOptions&, const WarmStart&,
                           SolverMemory&);

struct SolverEntry {
  std::string_view name;
  Solver solve;
  ContactLaw law;     // whose residual it reports
  bool frictionless;  // covers mu = 0 only
};

// All solvers, in the order above.
std::span<const SolverEntry> solver_catalog();

}  // namespace ourengine
