#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "ourengine/contact/islands.hpp"
#include "ourengine/contact/solver_common.hpp"

namespace ourengine {
namespace {

constexpr int kWarmNewtonSteps = 8;
constexpr int kPivotContacts = 1000;  // pivoting costs the square of the contacts, per pivot
constexpr double kSliding = 1e-3;     // of the scale: slip and load from which a contact slides
constexpr int kRescueSweeps = 2000;   // of Gauss-Seidel where it is the last resort

enum class Method { kIpm, kDantzig, kNsgs, kAlm, kSocp, kNewton };

// One island: methods take over from each other until one reaches the tolerance; the best iterate
// of all is kept.
class Relay {
 public:
  Relay(const ContactSystem& system, const SolveOptions& options, const WarmStart& warm,
        SolverMemory& memory)
      : system_(system), options_(options), tight_(options.tolerance), memory_(memory) {
    system.load_impulses(warm.impulses_ns, start_);
    best_ = no_impulses(system, ContactLaw::kCoulomb);
    if (!warm.impulses_ns.empty()) consider(start_, "warm start");
    if (!this->warm()) start_.assign(system.rows(), 0.0);
  }

  bool solved() const { return best_.residual <= options_.tolerance; }
  bool warm() const { return method_ == std::string_view("warm start"); }
  // Where contacts slip each digit is dear.
  void loosen() { options_.tolerance = std::max(tight_, options_.slip_tolerance); }
  void tighten() { options_.tolerance = tight_; }

  void forget_start() { std::fill(start_.begin(), start_.end(), 0.0); }

  // Whether a contact slides under load in the best iterate, so that the convex law, which lifts
  // it, is not the exact one.
  bool slides() const {
    const std::size_t n = system_.stride();
    const double least = kSliding * system_.scale_mps();
    AlignedDoubles w(system_.rows());
    simd_kernels().multiply_j(system_.view(), best_.v.data(), true, w.data());
    for (std::size_t i = 0; i < static_cast<std::size_t>(system_.contacts()); ++i) {
      const bool loaded = system_.delassus()[i] * best_.f[i] > least;
      if (loaded && system_.friction()[i] * std::hypot(w[n + i], w[2 * n + i]) > least) return true;
    }
    return false;
  }

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
        return take(newton(system_, options, start_, memory_.lu), "newton");
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
  double tight_;
  SolverMemory& memory_;
  AlignedDoubles start_;  // the warm impulses where they are better than none, else none
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
  const bool slid = relay.slides();
  if (!slid) relay.attempt(Method::kSocp, options);
  relay.loosen();
  relay.attempt(Method::kNewton, options);
  relay.forget_start();
  relay.attempt(Method::kNewton, options);
  if (slid && !relay.slides()) {
    relay.tighten();
    relay.attempt(Method::kSocp, options);
    relay.loosen();
  }
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
