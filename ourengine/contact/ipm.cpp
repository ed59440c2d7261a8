#include <algorithm>
#include <cmath>

#include "ourengine/contact/cone_kernels.hpp"
#include "ourengine/contact/solver_common.hpp"

namespace ourengine {
namespace {

constexpr int kMaxIterations = 80;
constexpr double kProximal = 1e-9;    // of the Delassus diagonal: bounds the weights of H
constexpr double kClip = 10.0;        // second-order correction, in units of the mean f w
constexpr double kToBoundary = 0.99;  // least fraction of the step to the boundary

// Mehrotra's predictor-corrector (On the implementation of a primal-dual interior point method,
// 1992) for min 1/2 |v - v_free|_M^2 subject to w = J v + b >= 0, with multipliers f. Each step
// solves H dv = r, H = M + J^T diag(1 / (w / f + delta)) J, positive definite because M is,
// however dependent the contacts are.
class OrthantMethod {
 public:
  OrthantMethod(const ContactSystem& system, BlockCholesky& cholesky)
      : system_(system), cholesky_(cholesky), n_(system.stride()), store_(12 * n_) {
    double* next = store_.data();
    for (double** array : {&o_.f, &o_.w, &o_.primal, &o_.inverse_f, &o_.inverse_w, &o_.rhs, &o_.y,
                           &o_.jd, &o_.df, &o_.dw, &o_.ratio, &o_.d}) {
      *array = next;
      next += n_;
    }
    o_.stride = n_;
    for (const double a : system.delassus()) regular_.push_back(kProximal * a);
    o_.regular = regular_.data();
  }

  Outcome run(const SolveOptions& options) {
    start();
    Outcome best;
    best.residual = HUGE_VAL;
    const int limit = iterations_or(options, kMaxIterations);
    int iteration = 0;
    for (;; ++iteration) {
      refresh();
      if (apparent_residual() <= 3.0 * options.tolerance || iteration == limit) keep_best(best);
      if (best.residual <= options.tolerance || iteration == limit) break;
      if (!(complementarity_ < HUGE_VAL)) break;
      step();
    }
    if (!(best.residual < HUGE_VAL)) keep_best(best);
    best.iterations = iteration;
    best.status = best.residual <= options.tolerance ? SolveStatus::kSolved
                  : iteration == limit               ? SolveStatus::kMaxIterations
                                                     : SolveStatus::kStalled;
    return best;
  }

 private:
  void start() {
    const double scale = system_.scale_mps();
    v_ = system_.free_velocity();
    simd_kernels().multiply_j(system_.view(), v_.data(), true, o_.primal);
    for (std::size_t i = 0; i < n_; ++i) {
      o_.w[i] = std::max(o_.primal[i], 0.1 * scale);
      o_.f[i] = 0.5 * scale / system_.delassus()[i];
    }
    for (std::size_t i = count(); i < n_; ++i) o_.f[i] = o_.w[i] = 1.0;  // inert padding
  }

  std::size_t count() const { return static_cast<std::size_t>(system_.contacts()); }

  // s = J v + b, primal residual s - w, mean complementarity, momentum residual.
  void refresh() {
    simd_kernels().multiply_j(system_.view(), v_.data(), true, o_.primal);
    apparent_ = 0.0;
    for (std::size_t i = 0; i < count(); ++i) {
      apparent_ =
          std::max(apparent_, std::abs(std::min(system_.delassus()[i] * o_.f[i], o_.primal[i])));
    }
    for (std::size_t i = 0; i < n_; ++i) o_.primal[i] -= o_.w[i];
    for (std::size_t i = count(); i < n_; ++i) {
      o_.primal[i] = 0.0;
      o_.f[i] = o_.w[i] = complementarity_;
    }
    complementarity_ = count() == 0 ? 0.0
                                    : ordered_dot(o_.f, o_.w, count() / 8 * 8) / mean_divisor() +
                                          tail_dot() / mean_divisor();
  }

  double mean_divisor() const { return static_cast<double>(count()); }
  double tail_dot() const {
    double sum = 0.0;
    for (std::size_t i = count() / 8 * 8; i < count(); ++i) sum += o_.f[i] * o_.w[i];
    return sum;
  }

  double apparent_residual() const { return apparent_ / system_.scale_mps(); }

  void keep_best(Outcome& best) {
    f_.assign(o_.f, o_.f + n_);
    for (std::size_t i = count(); i < n_; ++i) f_[i] = 0.0;
    AlignedDoubles v, w;
    const double residual = contact_residual_of(system_, f_, ContactLaw::kCoulomb, v, w);
    if (best.f.empty() || residual < best.residual) {
      best.f = f_;
      best.v = v;
      best.residual = residual;
    }
  }

  // dv, df, dw for the right-hand side in o_.rhs.
  void direction() {
    cone_kernels().orthant_right_side(o_);
    dv_ = momentum_;
    simd_kernels().multiply_jt(system_.view(), o_.y, dv_.data());
    cholesky_.solve(dv_);
    simd_kernels().multiply_j(system_.view(), dv_.data(), false, o_.jd);
    cone_kernels().orthant_direction(o_);
  }

  double largest_step() const { return 1.0 / std::max(ordered_max(o_.ratio, n_), 1e-300); }

  void step() {
    cone_kernels().orthant_scaling(o_);
    for (std::size_t i = count(); i < n_; ++i) o_.d[i] = 0.0;
    d_.assign(o_.d, o_.d + n_);
    cholesky_.factor(system_, d_);
    // momentum_ = J^T f - M (v - v_free)
    for (std::size_t i = 0; i < v_.size(); ++i) change_[i] = system_.free_velocity()[i] - v_[i];
    system_.multiply_mass(change_, momentum_);
    simd_kernels().multiply_jt(system_.view(), o_.f, momentum_.data());
    direction();
    const double affine = std::min(1.0, largest_step());
    double after = 0.0;
    for (std::size_t i = 0; i < count(); ++i)
      after += (o_.f[i] + affine * o_.df[i]) * (o_.w[i] + affine * o_.dw[i]);
    const double ratio = after / mean_divisor() / complementarity_;
    cone_kernels().orthant_corrector(o_, ratio * ratio * ratio * complementarity_,
                                     kClip * complementarity_);
    direction();
    const double scale = system_.scale_mps();
    const double damping = std::max(kToBoundary, 1.0 - complementarity_ / (scale * scale));
    const double length = std::min(1.0, damping * largest_step());
    for (std::size_t i = 0; i < v_.size(); ++i) v_[i] += length * dv_[i];
    for (std::size_t i = 0; i < n_; ++i) {
      o_.w[i] += length * o_.dw[i];
      o_.f[i] += length * o_.df[i];
    }
  }

  const ContactSystem& system_;
  BlockCholesky& cholesky_;
  std::size_t n_;
  AlignedDoubles store_, regular_, f_, d_, v_, dv_, momentum_;
  AlignedDoubles change_ = AlignedDoubles(system_.body_doubles(), 0.0);
  OrthantArrays o_;
  double complementarity_ = 1.0;
  double apparent_ = 0.0;
};

}  // namespace

Outcome ipm(const ContactSystem& system, const SolveOptions& options, BlockCholesky& cholesky) {
  return OrthantMethod(system, cholesky).run(options);
}

ContactSolution solve_ipm(const ContactProblem& problem, const SolveOptions& options,
                          const WarmStart& /*interior points start cold*/, SolverMemory& memory) {
  if (largest_friction(problem) > 0.0) return unsuitable(problem, "ipm");
  const ContactSystem system(problem, 1, memory.symbolic);
  const int before = memory.cholesky.factorisations();
  ContactSolution solution =
      hand_back(problem, system, ipm(system, options, memory.cholesky), "ipm");
  solution.factorisations = memory.cholesky.factorisations() - before;
  return solution;
}

}  // namespace ourengine
