#include <algorithm>
#include <cmath>

#include "ourengine/contact/solver_common.hpp"

namespace ourengine {
namespace {

constexpr int kMaxSweeps = 100000;

// Nonsmooth Gauss-Seidel (Moreau, Jean: Contact Dynamics, 1999): contacts in the caller's order,
// each solved for its own impulse with the others frozen; normal first, then the tangential part
// by one projected step on the disc of radius mu f_n. Without friction this is projected
// Gauss-Seidel.
class GaussSeidel {
 public:
  GaussSeidel(const ContactSystem& system, const AlignedDoubles& start)
      : system_(system), n_(system.stride()), f_(start) {
    for (int i = 0; i < system.contacts(); ++i) tangent_step_.push_back(tangent_step(i));
  }

  Outcome run(const SolveOptions& options) {
    const int limit = iterations_or(options, kMaxSweeps);
    Outcome outcome = no_impulses(system_, ContactLaw::kCoulomb);
    if (!check(outcome)) {  // what cannot be started from
      f_ = outcome.f;
      v_ = outcome.v;
    }
    int sweeps = 0;
    bool finite = true;
    while (outcome.residual > options.tolerance && sweeps < limit && finite) {
      const int until = std::min(limit, sweeps + std::max(8, sweeps / 8));
      for (; sweeps < until; ++sweeps) sweep();
      finite = check(outcome);
    }
    outcome.iterations = sweeps;
    outcome.status = outcome.residual <= options.tolerance ? SolveStatus::kSolved
                     : sweeps >= limit                     ? SolveStatus::kMaxIterations
                                                           : SolveStatus::kStalled;
    return outcome;
  }

 private:
  const double* row(int contact, int component) const {
    return system_.view().rows + offset(contact, component);
  }
  const double* inverse_row(int contact, int component) const {
    return system_.inverse_rows().data() + offset(contact, component);
  }
  std::size_t offset(int contact, int component) const {
    return 16 * static_cast<std::size_t>(contact * system_.components() + component);
  }

  // 1 / the largest eigenvalue of the tangential 2x2 block of the Delassus operator.
  double tangent_step(int i) const {
    if (system_.components() == 1) return 0.0;
    const double a11 = product(row(i, 1), inverse_row(i, 1));
    const double a12 = product(row(i, 1), inverse_row(i, 2));
    const double a22 = product(row(i, 2), inverse_row(i, 2));
    return 1.0 / (0.5 * (a11 + a22) + std::hypot(0.5 * (a11 - a22), a12));
  }

  static double product(const double* x, const double* y) {
    double sum = 0.0;
    for (int c = 0; c < 16; ++c) sum += x[c] * y[c];
    return sum;
  }

  double velocity(int i, int k) const {
    const SystemView& view = system_.view();
    const double *r = row(i, k), *va = v_.data() + view.offset_a[i],
                 *vb = v_.data() + view.offset_b[i];
    const std::size_t at = static_cast<std::size_t>(i);
    double w =
        k == 0 ? view.bias[at] : view.tangent_bias[static_cast<std::size_t>(k - 1) * n_ + at];
    for (int c = 0; c < 6; ++c) w += r[c] * va[c] + r[8 + c] * vb[c];
    return w;
  }

  void set_impulse(int i, int k, double value) {
    double& f = f_[static_cast<std::size_t>(k) * n_ + static_cast<std::size_t>(i)];
    const double change = value - f;
    if (change == 0.0) return;
    f = value;
    const SystemView& view = system_.view();
    const double* m = inverse_row(i, k);
    double *va = v_.data() + view.offset_a[i], *vb = v_.data() + view.offset_b[i];
    for (int c = 0; c < 6; ++c) {
      va[c] += m[c] * change;
      vb[c] += m[8 + c] * change;
    }
  }

  void sweep() {
    for (const int i : system_.sweep_order()) {
      const std::size_t at = static_cast<std::size_t>(i);
      set_impulse(i, 0, std::max(0.0, f_[at] - velocity(i, 0) / system_.delassus()[at]));
      if (system_.components() == 1) continue;
      double t1 = f_[n_ + at] - velocity(i, 1) * tangent_step_[at];
      double t2 = f_[2 * n_ + at] - velocity(i, 2) * tangent_step_[at];
      const double size = std::hypot(t1, t2);
      const double radius = system_.friction()[at] * f_[at];
      if (size > radius) {
        t1 *= radius / size;
        t2 *= radius / size;
      }
      set_impulse(i, 1, t1);
      set_impulse(i, 2, t2);
    }
  }

  // Scores the impulses with the velocity recomputed, which also removes drift from v_. False if
  // they are not finite.
  bool check(Outcome& best) {
    const double residual = contact_residual_of(system_, f_, ContactLaw::kCoulomb, v_, w_);
    keep_better(best, f_, v_, residual);
    return residual < HUGE_VAL;
  }

  const ContactSystem& system_;
  std::size_t n_;
  AlignedDoubles f_, v_, w_;
  std::vector<double> tangent_step_;
};

}  // namespace

Outcome nsgs(const ContactSystem& system, const SolveOptions& options,
             const AlignedDoubles& start) {
  return GaussSeidel(system, start).run(options);
}

ContactSolution solve_nsgs(const ContactProblem& problem, const SolveOptions& options,
                           const WarmStart& warm, SolverMemory& memory) {
  const ContactSystem system(problem, largest_friction(problem) > 0.0 ? 3 : 1, memory.symbolic);
  AlignedDoubles start;
  system.load_impulses(warm.impulses_ns, start);
  return hand_back(problem, system, nsgs(system, options, start), "nsgs");
}

}  // namespace ourengine
