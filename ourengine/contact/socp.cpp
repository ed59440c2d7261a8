#include <algorithm>
#include <cmath>

#include "ourengine/contact/cone_kernels.hpp"
#include "ourengine/contact/solver_common.hpp"

namespace ourengine {
namespace {

constexpr int kMaxIterations = 80;
constexpr double kToBoundary = 0.99;
constexpr double kClip = 20.0;  // second-order correction, in units of the mean complementarity
constexpr double kLeastCentring = 1e-6;

// Predictor-corrector with Nesterov-Todd scaling (Nesterov, Todd, Self-scaled barriers and
// interior-point methods for convex programming, 1997; formulas as in Vandenberghe, The CVXOPT
// linear and quadratic cone program solvers, 2010) for
//   min 1/2 |v - v_free|_M^2  subject to  s = (1, mu, mu) (J v + b) in the second-order cone.
class ConeMethod {
 public:
  ConeMethod(const ContactSystem& system, BlockCholesky& cholesky)
      : system_(system), cholesky_(cholesky), n_(system.stride()), store_((12 * 3 + 2) * n_) {
    double* next = store_.data();
    for (double** array : {&c_.s, &c_.z, &c_.jw, &c_.vv, &c_.lambda, &c_.rhs, &c_.primal, &c_.y,
                           &c_.jd, &c_.a, &c_.b, &c_.dz}) {
      *array = next;
      next += 3 * n_;
    }
    c_.beta = next;
    c_.ratio = next + n_;
    ds_.resize(3 * n_);
    d_.resize(6 * n_);
    c_.ds = ds_.data();
    c_.d = d_.data();
    c_.stride = n_;
    c_.friction = system.friction().data();
  }

  Outcome run(const SolveOptions& options) {
    start();
    Outcome best = no_impulses(system_, ContactLaw::kConvex);
    const int limit = iterations_or(options, kMaxIterations);
    int iteration = 0;
    for (;; ++iteration) {
      refresh();
      keep_best(best);
      if (best.residual <= options.tolerance || iteration == limit) break;
      if (!(complementarity_ > 0.0 && complementarity_ < HUGE_VAL) || rises_ > 8 || !step()) break;
    }
    best.iterations = iteration;
    best.status = best.residual <= options.tolerance ? SolveStatus::kSolved
                  : iteration == limit               ? SolveStatus::kMaxIterations
                                                     : SolveStatus::kStalled;
    return best;
  }

 private:
  std::size_t count() const { return static_cast<std::size_t>(system_.contacts()); }

  void into_cone(double* x, std::size_t i, double margin) const {
    const double t = std::hypot(x[n_ + i], x[2 * n_ + i]);
    x[i] = std::max(x[i], t + margin);
  }

  void start() {
    v_ = system_.free_velocity();
    simd_kernels().multiply_j(system_.view(), v_.data(), true, c_.s);
    cone_kernels().scale(n_, c_.friction, c_.s);
    const double margin = 0.3 * system_.scale_mps();
    std::fill(c_.z, c_.z + 3 * n_, 0.0);
    for (std::size_t i = 0; i < n_; ++i) {
      into_cone(c_.s, i, margin);
      into_cone(c_.z, i, margin / system_.delassus()[i]);
    }
  }

  void refresh() {
    simd_kernels().multiply_j(system_.view(), v_.data(), true, c_.primal);
    cone_kernels().scale(n_, c_.friction, c_.primal);
    for (std::size_t i = 0; i < 3 * n_; ++i) c_.primal[i] -= c_.s[i];
    for (std::size_t i = count(); i < n_; ++i) {  // inert padding on the central path
      for (std::size_t k = 0; k < 3; ++k)
        c_.primal[k * n_ + i] = c_.s[k * n_ + i] = c_.z[k * n_ + i] = 0.0;
      c_.s[i] = c_.z[i] = std::sqrt(complementarity_);
    }
    double sum = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < count(); ++i) sum += c_.s[k * n_ + i] * c_.z[k * n_ + i];
    }
    complementarity_ = count() == 0 ? 0.0 : sum / static_cast<double>(count());
  }

  void keep_best(Outcome& best) {
    f_.assign(c_.z, c_.z + 3 * n_);
    cone_kernels().scale(n_, c_.friction, f_.data());
    for (std::size_t i = count(); i < n_; ++i) f_[i] = 0.0;
    const double residual = contact_residual_of(system_, f_, ContactLaw::kConvex, kept_v_, w_);
    rises_ = residual < best.residual ? 0 : rises_ + 1;
    keep_better(best, f_, kept_v_, residual);
  }

  void direction() {
    cone_kernels().right_side(c_);
    dv_ = momentum_;
    simd_kernels().multiply_jt(system_.view(), c_.y, dv_.data());
    cholesky_.solve(dv_);
    simd_kernels().multiply_j(system_.view(), dv_.data(), false, c_.jd);
    cone_kernels().scale(n_, c_.friction, c_.jd);
    cone_kernels().direction(c_);
  }

  double largest_step() const { return 1.0 / std::max(ordered_max(c_.ratio, n_), 1e-300); }

  // False if the matrix could not be factored: the iterate is as far as rounding lets it come.
  bool step() {
    cone_kernels().scaling(c_);
    for (std::size_t k = 0; k < 6; ++k)
      std::fill(c_.d + k * n_ + count(), c_.d + (k + 1) * n_, 0.0);
    if (!cholesky_.factor(system_.view(), system_.fronts(), d_)) return false;
    for (std::size_t i = 0; i < v_.size(); ++i) change_[i] = system_.free_velocity()[i] - v_[i];
    system_.multiply_mass(change_, momentum_);
    simd_kernels().multiply_jt(system_.view(), f_.data(), momentum_.data());
    direction();
    const double affine = std::min(1.0, largest_step());
    const double target = centring(affine) * complementarity_;
    cone_kernels().corrector(c_, target, kClip * complementarity_);
    direction();
    const double length = std::min(1.0, kToBoundary * largest_step());
    for (std::size_t i = 0; i < v_.size(); ++i) v_[i] += length * dv_[i];
    for (std::size_t i = 0; i < 3 * n_; ++i) {
      c_.s[i] += length * c_.ds[i];
      c_.z[i] += length * c_.dz[i];
    }
    return true;
  }

  // Mehrotra's centring parameter from the complementarity after the predictor step.
  double centring(double affine) const {
    double after = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t i = k * n_; i < k * n_ + count(); ++i)
        after += (c_.lambda[i] + affine * c_.a[i]) * (c_.lambda[i] + affine * c_.b[i]);
    }
    const double ratio = std::max(0.0, after / static_cast<double>(count()) / complementarity_);
    return std::clamp(ratio * ratio * ratio, kLeastCentring, 1.0);
  }

  const ContactSystem& system_;
  BlockCholesky& cholesky_;
  std::size_t n_;
  AlignedDoubles store_, ds_, d_, f_, w_, v_, kept_v_, dv_, momentum_;
  AlignedDoubles change_ = AlignedDoubles(system_.body_doubles(), 0.0);
  ConeArrays c_;
  double complementarity_ = 1.0;
  int rises_ = 0;
};

}  // namespace

Outcome socp(const ContactSystem& system, const SolveOptions& options, BlockCholesky& cholesky) {
  return ConeMethod(system, cholesky).run(options);
}

ContactSolution solve_socp(const ContactProblem& problem, const SolveOptions& options,
                           const WarmStart& /*interior points start cold*/, SolverMemory& memory) {
  const ContactSystem system(problem, 3, memory.symbolic);
  const int before = memory.cholesky.factorisations();
  ContactSolution solution =
      hand_back(problem, system, socp(system, options, memory.cholesky), "socp");
  solution.factorisations = memory.cholesky.factorisations() - before;
  return solution;
}

}  // namespace ourengine
