#include <algorithm>
#include <cmath>

#include "ourengine/contact/cone_kernels.hpp"
#include "ourengine/contact/solver_common.hpp"
#include "ourengine/linear/block_lu.hpp"

namespace ourengine {
namespace {

constexpr int kMaxNewtonSteps = 3000;
constexpr int kMaxInnerSteps = 25;
constexpr int kMaxHalvings = 5;       // of one line search
constexpr int kMaxSlowSteps = 2;      // that reduce the merit by less than a tenth
constexpr double kSufficient = 1e-2;  // decrease of the merit, per step length
constexpr double kColdSoftness = 5.0;
constexpr double kWarmSoftness = 30.0;  // times the residual of the start
constexpr double kLeastWarmSoftness = 1e-5;
constexpr double kMaxSoftness = 1.0;
constexpr double kLeastSoftness = 1e-7;
// Softness after an inner problem that was solved; the lagged method starts near its goal.
constexpr double kHarder = 0.7;
constexpr double kHarderLagged = 0.25;
constexpr double kSofter = 2.5;          // softness after an inner problem that was given up
constexpr double kInnerAccuracy = 0.01;  // merit at which an inner problem is solved, in units of
                                         // residual * softness
constexpr double kMeritFloor = 1e-12;    // rounding
constexpr int kPatience = 60;            // outer iterations without a better residual

// The proximal method of multipliers (Rockafellar, Augmented Lagrangians and applications of the
// proximal point algorithm, 1976) on Coulomb's law in velocity space. Each outer iteration solves
//
//   R(v) = M (v_free - v) + J^T f(v) = 0,   f(v) = P_K(f_k - K (w + mu |w_t| e_n)),  w = J v + b,
//
// with K = 1 / (softness A), by damped semismooth Newton on |R| in the norm of M^-1, and takes
// f(v) as the next f_k; the softness falls as long as that works and rises when it does not.
//
// Lagged: mu |w_t| is frozen at the previous outer iterate, so that the matrix M + J^T D J is
// symmetric (Cholesky); the outer iteration is then Acary and Cadoux' fixed point (2011) as well.
// Exact: mu |w_t| is differentiated, and the matrix is not symmetric (LU).
class ProximalNewton {
 public:
  ProximalNewton(const ContactSystem& system, BlockCholesky& cholesky, BlockLu& lu, bool lagged)
      : system_(system), cholesky_(cholesky), lu_(lu), lagged_(lagged), shift_(system.stride()) {
    const std::size_t rows = system.rows();
    for (AlignedDoubles* x : {&w_, &f_, &trial_w_, &trial_f_, &direction_w_}) x->resize(rows);
    d_.resize((lagged ? 6 : 9) * system.stride());
    x_.stride = system.stride();
    x_.friction = system.friction().data();
    x_.delassus = system.delassus().data();
    x_.shift = lagged ? shift_.data() : nullptr;
    x_.d = d_.data();
  }

  Outcome run(const SolveOptions& options, const AlignedDoubles& start) {
    const int limit = iterations_or(options, kMaxNewtonSteps);
    Outcome best = no_impulses(system_, ContactLaw::kCoulomb);
    AlignedDoubles start_v;
    const double start_residual = residual_of(start, start_v);
    if (start_residual < HUGE_VAL) {
      best = {.f = start, .v = start_v, .residual = start_residual};
    } else {
      best.residual = residual_of(best.f, best.v);  // also the shift is no number
    }
    centre_ = best.f;
    double residual = best.residual;
    v_ = best.v;
    const bool cold =
        std::all_of(centre_.begin(), centre_.end(), [](double x) { return x == 0.0; });
    double softness = cold ? kColdSoftness
                           : std::clamp(kWarmSoftness * residual, kLeastWarmSoftness, kMaxSoftness);
    int since_best = 0;
    while (best.residual > options.tolerance && steps_ < limit && since_best < kPatience) {
      ++since_best;
      x_.softness = softness;
      const double goal =
          std::max(kMeritFloor, std::min(1e-4, kInnerAccuracy * residual * softness));
      const AlignedDoubles before = v_;
      if (!solve_inner(goal, limit)) {
        v_ = before;
        softness = std::min(kMaxSoftness, kSofter * softness);
        continue;
      }
      centre_ = f_;
      AlignedDoubles v;
      residual = residual_of(f_, v);
      if (residual < best.residual) since_best = 0;
      keep_better(best, f_, v, residual);
      softness = std::max(kLeastSoftness, (lagged_ ? kHarderLagged : kHarder) * softness);
    }
    best.iterations = steps_;
    best.status = best.residual <= options.tolerance ? SolveStatus::kSolved
                  : steps_ >= limit                  ? SolveStatus::kMaxIterations
                                                     : SolveStatus::kStalled;
    return best;
  }

 private:
  // Residual of the exact law at f; v belongs to f. Freezes the shift there.
  double residual_of(const AlignedDoubles& f, AlignedDoubles& v) {
    const double residual = contact_residual_of(system_, f, ContactLaw::kCoulomb, v, residual_w_);
    const std::size_t n = system_.stride();
    for (std::size_t i = 0; i < n; ++i) {
      const double w1 = residual_w_[n + i], w2 = residual_w_[2 * n + i];
      shift_[i] = system_.friction()[i] * std::sqrt(w1 * w1 + w2 * w2);
    }
    return residual;
  }

  void evaluate(const AlignedDoubles& w, AlignedDoubles& f, bool derivative) {
    x_.centre = centre_.data();
    x_.w = w.data();
    x_.f = f.data();
    (derivative ? cone_kernels().proximal_derivative : cone_kernels().proximal)(x_);
  }

  // r = R(v); returns its size as a velocity, relative to the scale of the problem.
  double merit(const AlignedDoubles& v, const AlignedDoubles& f, AlignedDoubles& r) {
    difference_.resize(v.size());
    for (std::size_t i = 0; i < v.size(); ++i) difference_[i] = system_.free_velocity()[i] - v[i];
    system_.multiply_mass(difference_, r);
    simd_kernels().multiply_jt(system_.view(), f.data(), r.data());
    system_.multiply_inverse_mass(r, difference_);
    const double square = ordered_dot(r.data(), difference_.data(), r.size());
    return std::sqrt(square / std::max(1, system_.bodies())) / system_.scale_mps();
  }

  bool factor() {
    return lagged_ ? cholesky_.factor(system_.view(), system_.fronts(), d_)
                   : lu_.factor(system_.view(), system_.targets(), system_.symbolic().pattern, d_);
  }
  void solve(AlignedDoubles& x) const { lagged_ ? cholesky_.solve(x) : lu_.solve(x); }

  bool solve_inner(double goal, int limit) {
    simd_kernels().multiply_j(system_.view(), v_.data(), true, w_.data());
    evaluate(w_, f_, true);
    double size = merit(v_, f_, r_);
    int slow = 0;
    for (int step = 0; step < kMaxInnerSteps && steps_ < limit; ++step) {
      if (size < goal) return true;
      if (!factor()) return false;
      ++steps_;
      direction_ = r_;
      solve(direction_);
      simd_kernels().multiply_j(system_.view(), direction_.data(), false, direction_w_.data());
      const double next = line_search(size);
      if (!(next < size)) return false;
      if (next > 0.9 * size && ++slow >= kMaxSlowSteps) return false;
      evaluate(w_, f_, true);
      size = next;
    }
    return size < goal;
  }

  // Halves the step until the merit falls; moves v_, w_, r_ there. Infinity if it never does.
  double line_search(double size) {
    double length = 1.0;
    for (int halving = 0; halving < kMaxHalvings; ++halving, length *= 0.5) {
      trial_v_.resize(v_.size());
      for (std::size_t i = 0; i < v_.size(); ++i) trial_v_[i] = v_[i] + length * direction_[i];
      for (std::size_t i = 0; i < w_.size(); ++i) trial_w_[i] = w_[i] + length * direction_w_[i];
      evaluate(trial_w_, trial_f_, false);
      const double next = merit(trial_v_, trial_f_, trial_r_);
      if (next < (1.0 - kSufficient * length) * size) {
        v_.swap(trial_v_);
        w_.swap(trial_w_);
        r_.swap(trial_r_);
        return next;
      }
    }
    return HUGE_VAL;
  }

  const ContactSystem& system_;
  BlockCholesky& cholesky_;
  BlockLu& lu_;
  bool lagged_;
  ProximalArrays x_;
  AlignedDoubles shift_, centre_, v_, w_, f_, r_, d_, direction_, direction_w_, difference_;
  AlignedDoubles trial_v_, trial_w_, trial_f_, trial_r_, residual_w_;
  int steps_ = 0;
};

ContactSolution solve_with(const ContactProblem& problem, const SolveOptions& options,
                           const WarmStart& warm, SolverMemory& memory, bool lagged) {
  const ContactSystem system(problem, 3, memory.symbolic);
  AlignedDoubles start;
  system.load_impulses(warm.impulses_ns, start);
  const int before = memory.cholesky.factorisations() + memory.lu.factorisations();
  const Outcome outcome = lagged ? alm(system, options, start, memory.cholesky)
                                 : newton(system, options, start, memory.lu);
  ContactSolution solution = hand_back(problem, system, outcome, lagged ? "alm" : "newton");
  solution.factorisations = memory.cholesky.factorisations() + memory.lu.factorisations() - before;
  return solution;
}

}  // namespace

Outcome alm(const ContactSystem& system, const SolveOptions& options, const AlignedDoubles& start,
            BlockCholesky& cholesky) {
  BlockLu unused;
  return ProximalNewton(system, cholesky, unused, true).run(options, start);
}

Outcome newton(const ContactSystem& system, const SolveOptions& options,
               const AlignedDoubles& start, BlockLu& lu) {
  BlockCholesky unused;
  return ProximalNewton(system, unused, lu, false).run(options, start);
}

ContactSolution solve_alm(const ContactProblem& problem, const SolveOptions& options,
                          const WarmStart& warm, SolverMemory& memory) {
  return solve_with(problem, options, warm, memory, true);
}

ContactSolution solve_newton(const ContactProblem& problem, const SolveOptions& options,
                             const WarmStart& warm, SolverMemory& memory) {
  return solve_with(problem, options, warm, memory, false);
}

}  // namespace ourengine
