#include <algorithm>
#include <array>

#include "ourengine/contact/islands.hpp"
#include "ourengine/contact/solver_common.hpp"

namespace ourengine {
namespace {

constexpr int kWarmNewtonSteps = 8;

struct Attempt {
  Outcome outcome;
  const char* method;
};

// Keeps the better of the two; iterations add up.
void keep_better(Attempt& best, Attempt next) {
  next.outcome.iterations += best.outcome.iterations;
  if (next.outcome.residual < best.outcome.residual) {
    best = std::move(next);
  } else {
    best.outcome.iterations = next.outcome.iterations;
  }
}

bool solved(const Attempt& attempt, const SolveOptions& options) {
  return attempt.outcome.residual <= options.tolerance;
}

// What the impulses of the last step are worth as they are.
Attempt judge(const ContactSystem& system, const AlignedDoubles& start) {
  Attempt attempt{{}, "warm start"};
  AlignedDoubles w;
  attempt.outcome.f = start;
  attempt.outcome.residual =
      contact_residual_of(system, start, ContactLaw::kCoulomb, attempt.outcome.v, w);
  return attempt;
}

// The interior point, whose law is the exact one only where nothing slips: scored on the exact law.
Attempt interior_point(const ContactSystem& system, const SolveOptions& options,
                       SolverMemory& memory) {
  if (system.components() == 1) return {ipm(system, options, memory.cholesky), "ipm"};
  Attempt attempt{socp(system, options, memory.cholesky), "socp"};
  attempt.outcome.residual = judge(system, attempt.outcome.f).outcome.residual;
  return attempt;
}

ContactSolution solve_one(const ContactProblem& problem, const SolveOptions& options,
                          const WarmStart& warm, SolverMemory& memory) {
  const bool friction = largest_friction(problem) > 0.0;
  const ContactSystem system(problem, friction ? 3 : 1, memory.symbolic);
  const int before = memory.cholesky.factorisations() + memory.lu.factorisations();
  AlignedDoubles start;
  system.load_impulses(warm.impulses_ns, start);
  Attempt best = judge(system, start);
  if (!solved(best, options) && friction && !warm.impulses_ns.empty()) {
    SolveOptions few = options;
    few.max_iterations = kWarmNewtonSteps;
    keep_better(best, {alm(system, few, best.outcome.f, memory.cholesky), "alm"});
  }
  if (!solved(best, options)) keep_better(best, interior_point(system, options, memory));
  SolveOptions slipping = options;
  slipping.tolerance = std::max(options.tolerance, options.slip_tolerance);
  if (!solved(best, slipping) && friction) {
    const AlignedDoubles nothing(system.rows(), 0.0);
    keep_better(best, {newton(system, slipping, nothing, memory.lu), "newton"});
  }
  best.outcome.status = solved(best, slipping) ? SolveStatus::kSolved : SolveStatus::kStalled;
  ContactSolution solution = hand_back(problem, system, best.outcome, best.method);
  solution.factorisations = memory.cholesky.factorisations() + memory.lu.factorisations() - before;
  return solution;
}

}  // namespace

ContactSolution solve_exact(const ContactProblem& problem, const SolveOptions& options,
                            const WarmStart& warm, SolverMemory& memory) {
  return solve_islands(problem, solve_one, ContactLaw::kCoulomb, options, warm, memory);
}

std::span<const SolverEntry> solver_catalog() {
  static constexpr std::array<SolverEntry, 7> kSolvers = {{
      {"exact", solve_exact, ContactLaw::kCoulomb, false},
      {"ipm", solve_ipm, ContactLaw::kCoulomb, true},
      {"dantzig", solve_dantzig, ContactLaw::kCoulomb, true},
      {"socp", solve_socp, ContactLaw::kConvex, false},
      {"alm", solve_alm, ContactLaw::kCoulomb, false},
      {"newton", solve_newton, ContactLaw::kCoulomb, false},
      {"nsgs", solve_nsgs, ContactLaw::kCoulomb, false},
  }};
  return kSolvers;
}

}  // namespace ourengine
