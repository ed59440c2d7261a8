#include <algorithm>
#include <array>
#include <string_view>

#include "ourengine/contact/islands.hpp"
#include "ourengine/contact/solver_common.hpp"

namespace ourengine {
namespace {

constexpr int kWarmNewtonSteps = 8;
constexpr int kPivotContacts = 1000;  // pivoting costs the square of the contacts, per pivot
constexpr int kRescueSweeps = 2000;   // of Gauss-Seidel where it is the last resort

enum class Method { kIpm, kDantzig, kNsgs, kAlm, kSocp, kNewton };

// One island: methods take over from each other until one reaches the tolerance; the best iterate
// of all is kept.
class Relay {
 public:
  Relay(const ContactSystem& system, const SolveOptions& options, const WarmStart& warm,
        SolverMemory& memory)
      : system_(system), options_(options), memory_(memory) {
    system.load_impulses(warm.impulses_ns, start_);
    best_ = no_impulses(system, ContactLaw::kCoulomb);
    if (!warm.impulses_ns.empty()) consider(start_, "warm start");
  }

  bool solved() const { return best_.residual <= options_.tolerance; }
  bool warm() const { return method_ == std::string_view("warm start"); }
  // From here on each digit is dear.
  void slips() { options_.tolerance = std::max(options_.tolerance, options_.slip_tolerance); }

  // Nothing if the problem is solved already.
  void attempt(Method method, SolveOptions options) {
    if (solved()) return;
    options.tolerance = options_.tolerance;
    switch (method) {
      case Method::kIpm:
        return take(ipm(system_, options, memory_.cholesky), "ipm");
      case Method::kDantzig:
        return take(dantzig(system_, options), "dantzig");
      case Method::kNsgs:
        return take(nsgs(system_, options, best_.f), "nsgs");
      case Method::kAlm:
        return take(alm(system_, options, best_.f, memory_.cholesky), "alm");
      case Method::kSocp:
        return take(socp(system_, options, memory_.cholesky), "socp");
      case Method::kNewton:
        return take(newton(system_, options, AlignedDoubles(system_.rows(), 0.0), memory_.lu),
                    "newton");
    }
  }

  ContactSolution result(const ContactProblem& problem) {
    best_.iterations = iterations_;
    best_.status = solved() ? SolveStatus::kSolved : SolveStatus::kStalled;
    return hand_back(problem, system_, best_, method_);
  }

 private:
  void consider(const AlignedDoubles& f, const char* method) {
    AlignedDoubles v, w;
    const double residual = contact_residual_of(system_, f, ContactLaw::kCoulomb, v, w);
    if (residual < best_.residual) method_ = method;
    keep_better(best_, f, v, residual);
  }

  // Scores on the exact law what may have been solved for another.
  void take(const Outcome& outcome, const char* method) {
    iterations_ += outcome.iterations;
    consider(outcome.f, method);
  }

  const ContactSystem& system_;
  SolveOptions options_;
  SolverMemory& memory_;
  AlignedDoubles start_;
  Outcome best_;
  const char* method_ = "no impulses";
  int iterations_ = 0;
};

SolveOptions limited(const SolveOptions& options, int iterations) {
  SolveOptions few = options;
  few.max_iterations = iterations;
  return few;
}

// Whether the method, as one that takes over, is worth a try.
bool affordable(Method method, const ContactSystem& system) {
  return method != Method::kDantzig || system.contacts() <= kPivotContacts;
}

ContactSolution without_friction(const ContactProblem& problem, const SolveOptions& options,
                                 const WarmStart& warm, SolverMemory& memory, Method first) {
  const ContactSystem system(problem, 1, memory.symbolic);
  const int before = memory.cholesky.factorisations();
  Relay relay(system, options, warm, memory);
  relay.attempt(first, options);
  for (const Method method : {Method::kIpm, Method::kDantzig, Method::kNsgs}) {
    if (method == first || !affordable(method, system)) continue;
    relay.attempt(method, method == Method::kNsgs ? limited(options, kRescueSweeps) : options);
  }
  ContactSolution solution = relay.result(problem);
  solution.factorisations = memory.cholesky.factorisations() - before;
  return solution;
}

ContactSolution with_friction(const ContactProblem& problem, const SolveOptions& options,
                              const WarmStart& warm, SolverMemory& memory) {
  const ContactSystem system(problem, 3, memory.symbolic);
  const int before = memory.cholesky.factorisations() + memory.lu.factorisations();
  Relay relay(system, options, warm, memory);
  if (relay.warm()) relay.attempt(Method::kAlm, limited(options, kWarmNewtonSteps));
  relay.attempt(Method::kSocp, options);
  relay.slips();
  relay.attempt(Method::kNewton, options);
  relay.attempt(Method::kNsgs, limited(options, kRescueSweeps));
  ContactSolution solution = relay.result(problem);
  solution.factorisations = memory.cholesky.factorisations() + memory.lu.factorisations() - before;
  return solution;
}

template <Method first>
ContactSolution solve_one(const ContactProblem& problem, const SolveOptions& options,
                          const WarmStart& warm, SolverMemory& memory) {
  if (largest_friction(problem) > 0.0) return with_friction(problem, options, warm, memory);
  return without_friction(problem, options, warm, memory, first);
}

template <Method first>
ContactSolution solve_frictionless(const ContactProblem& problem, const SolveOptions& options,
                                   const WarmStart& warm, SolverMemory& memory,
                                   const char* method) {
  if (largest_friction(problem) > 0.0) return unsuitable(problem, method);
  return solve_islands(problem, solve_one<first>, options, warm, memory);
}

}  // namespace

ContactSolution solve_exact(const ContactProblem& problem, const SolveOptions& options,
                            const WarmStart& warm, SolverMemory& memory) {
  return solve_islands(problem, solve_one<Method::kIpm>, options, warm, memory);
}

ContactSolution solve_ipm_first(const ContactProblem& problem, const SolveOptions& options,
                                const WarmStart& warm, SolverMemory& memory) {
  return solve_frictionless<Method::kIpm>(problem, options, warm, memory, "ipm");
}

ContactSolution solve_dantzig_first(const ContactProblem& problem, const SolveOptions& options,
                                    const WarmStart& warm, SolverMemory& memory) {
  return solve_frictionless<Method::kDantzig>(problem, options, warm, memory, "dantzig");
}

ContactSolution solve_nsgs_first(const ContactProblem& problem, const SolveOptions& options,
                                 const WarmStart& warm, SolverMemory& memory) {
  return solve_frictionless<Method::kNsgs>(problem, options, warm, memory, "nsgs");
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
