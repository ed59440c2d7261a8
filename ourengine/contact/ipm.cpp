#include <algorithm>
#include <cmath>

#include "ourengine/contact/cone_kernels.hpp"
#include "ourengine/contact/solver_common.hpp"

namespace ourengine {
namespace {

constexpr int kMaxIterations = 80;
constexpr double kProximal = 1e-9;      // of the Delassus diagonal: bounds the weights of H
constexpr double kClip = 100.0;         // second-order correction, in units of the mean f w
constexpr double kStartSlack = 0.05;    // least of w at the start, in units of the scale
constexpr double kStartImpulse = 1.0;   // A f at the start, in the same units
constexpr double kClear = 1e-2;         // A f over w, or its inverse, where it is clear which is 0
constexpr double kPolishFrom = 2e-3;    // part of contacts not clear at the first polish ...
constexpr double kPolishAgain = 0.3;    // ... and, times that, at the next
constexpr double kPolishAnyway = 1e-5;  // apparent residual from which to polish all the same ...
constexpr double kPolishAnyAgain = 0.01;  // ... and, times that, again
constexpr double kPolishSoftness = 1e-5;
constexpr double kPolishHopeless = 0.02;  // residual after the first guess; then must halve
constexpr int kPolishGuesses = 4;
constexpr int kPolishSolves = 3;
constexpr int kCentralityCorrectors = 1;
constexpr double kLongerBy = 1.5;  // the step that a centrality corrector aims at
constexpr double kLongerPlus = 0.1;
constexpr double kBand = 0.1;         // products f w outside target * (band, 1 / band) are moved
constexpr double kLeastGain = 0.2;    // of the longer step, for a corrector to be kept
constexpr int kCycle = 6;             // iterations in which the mean f w has not fallen ...
constexpr double kFall = 0.9;         // ... by this factor: no more corrections
constexpr double kPlainTarget = 0.3;  // of the mean f w: where a plain step then aims
constexpr double kToBoundary = 0.99;  // fraction of the step to the boundary: the least ...
constexpr double kShortOfBoundary = 1.0 - 1e-6;  // ... and the most, near the solution

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
    Outcome best = no_impulses(system_, ContactLaw::kCoulomb);
    const int limit = iterations_or(options, kMaxIterations);
    int iteration = 0;
    for (;; ++iteration) {
      refresh();
      if (apparent_ < least_apparent_) {
        least_apparent_ = apparent_;
        f_.assign(o_.f, o_.f + n_);
        if (apparent_residual() <= 3.0 * options.tolerance) keep_best(best);
      }
      if (best.residual <= options.tolerance || iteration == limit) break;
      if (worth_polishing() && polish(best, options)) break;
      if (!goes_on() || !step()) break;
    }
    keep_best(best);
    best.iterations = iteration + polishes_;
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
      o_.w[i] = std::max(o_.primal[i], kStartSlack * scale);
      o_.f[i] = kStartImpulse * scale / system_.delassus()[i];
    }
    for (std::size_t i = count(); i < n_; ++i) o_.f[i] = o_.w[i] = 1.0;  // inert padding
  }

  std::size_t count() const { return static_cast<std::size_t>(system_.contacts()); }

  // s = J v + b, primal residual s - w, mean complementarity, momentum residual.
  void refresh() {
    simd_kernels().multiply_j(system_.view(), v_.data(), true, o_.primal);
    apparent_ = 0.0;
    unclear_ = 0;
    for (std::size_t i = 0; i < count(); ++i) {
      const double loaded = system_.delassus()[i] * o_.f[i];
      const double off = std::abs(std::min(loaded, o_.primal[i]));
      apparent_ = off < HUGE_VAL ? std::max(apparent_, off) : HUGE_VAL;  // NaN included
      unclear_ += loaded > kClear * o_.w[i] && o_.w[i] > kClear * loaded ? 1 : 0;
    }
    for (std::size_t i = 0; i < n_; ++i) o_.primal[i] -= o_.w[i];
    for (std::size_t i = count(); i < n_; ++i) {
      o_.primal[i] = 0.0;
      o_.f[i] = o_.w[i] = complementarity_;
    }
    complementarity_ = count() == 0 ? 0.0
                                    : ordered_dot(o_.f, o_.w, count() / 8 * 8) / mean_divisor() +
                                          tail_dot() / mean_divisor();
    if (complementarity_ < kFall * least_complementarity_) {
      least_complementarity_ = complementarity_;
      rises_ = 0;
    } else {
      ++rises_;
    }
    plain_ = plain_ || rises_ >= kCycle;
  }

  // Whether there is a next step: not where the products f w have come down to nothing (the method
  // divides by them) or have left the numbers.
  bool goes_on() const { return complementarity_ > 0.0 && apparent_ < HUGE_VAL; }

  double mean_divisor() const { return static_cast<double>(count()); }
  double tail_dot() const {
    double sum = 0.0;
    for (std::size_t i = count() / 8 * 8; i < count(); ++i) sum += o_.f[i] * o_.w[i];
    return sum;
  }

  double apparent_residual() const { return apparent_ / system_.scale_mps(); }

  // Is it known of nearly all contacts whether they carry load? (At rest long before the residual
  // is small, in an impact about when it is.)
  bool worth_polishing() {
    const double unclear = unclear_ / mean_divisor();
    const bool worth = unclear <= next_unclear_ || apparent_residual() < next_polish_;
    if (!worth) return false;
    next_unclear_ = kPolishAgain * std::min(unclear, next_unclear_);
    next_polish_ = std::min(next_polish_, kPolishAnyAgain * apparent_residual());
    return true;
  }

  // Scores the iterate of least apparent residual.
  void keep_best(Outcome& best) {
    if (f_.empty()) return;
    for (std::size_t i = count(); i < n_; ++i) f_[i] = 0.0;
    AlignedDoubles v, w;
    const double residual = contact_residual_of(system_, f_, ContactLaw::kCoulomb, v, w);
    keep_better(best, f_, v, residual);
  }

  // Primal-dual active set (Hintermueller, Ito, Kunisch 2002) from the iterate: contacts with
  // A f > w are taken to carry load and solved for by a stiff proximal iteration on one factor; the
  // guess is corrected a few times. Contacts that neither carry load nor open (f = w = 0) would
  // otherwise cost an iteration per factor of two. True if that solves the problem.
  bool polish(Outcome& best, const SolveOptions& options) {
    AlignedDoubles f(o_.f, o_.f + n_), w(o_.w, o_.w + n_), v = v_, kept_v, kept_w;
    double last = kPolishHopeless;
    for (int guess = 0; guess < kPolishGuesses; ++guess) {
      int changed = 0;
      for (std::size_t i = 0; i < n_; ++i) {
        const bool loaded = i < count() && system_.delassus()[i] * f[i] > w[i];
        const double weight = loaded ? 1.0 / (kPolishSoftness * system_.delassus()[i]) : 0.0;
        changed += guess > 0 && weight != d_polish_[i] ? 1 : 0;
        d_polish_.resize(n_);
        d_polish_[i] = weight;
        if (!loaded) f[i] = 0.0;
      }
      if (guess > 0 && changed == 0) break;
      ++polishes_;
      if (!cholesky_.factor(system_.view(), system_.fronts(), d_polish_)) break;
      solve_loaded(v, f, w);
      kept_f_ = f;
      for (double& impulse : kept_f_) impulse = std::max(impulse, 0.0);
      const double residual =
          contact_residual_of(system_, kept_f_, ContactLaw::kCoulomb, kept_v, kept_w);
      keep_better(best, kept_f_, kept_v, residual);
      if (residual <= options.tolerance) return true;
      if (!(residual <= 0.5 * last)) break;
      last = residual;
    }
    return false;
  }

  // Proximal iterations for w = 0 at the contacts with weight, f = 0 at the others.
  void solve_loaded(AlignedDoubles& v, AlignedDoubles& f, AlignedDoubles& w) {
    AlignedDoubles r;
    for (int k = 0; k < kPolishSolves; ++k) {
      simd_kernels().multiply_j(system_.view(), v.data(), true, w.data());
      for (std::size_t i = 0; i < n_; ++i) w[i] = f[i] - d_polish_[i] * w[i];
      for (std::size_t i = 0; i < v.size(); ++i) change_[i] = system_.free_velocity()[i] - v[i];
      system_.multiply_mass(change_, r);
      simd_kernels().multiply_jt(system_.view(), w.data(), r.data());
      cholesky_.solve(r);
      for (std::size_t i = 0; i < v.size(); ++i) v[i] += r[i];
      simd_kernels().multiply_j(system_.view(), v.data(), true, w.data());
      for (std::size_t i = 0; i < n_; ++i) f[i] -= d_polish_[i] * w[i];
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

  // Gondzio's corrector (Multiple centrality corrections in a primal-dual method for linear
  // programming, 1996): pulls outlying products f w at a longer step back into a band around the
  // target, for the price of one solve. Keeps the direction only if the step grows enough.
  bool correct_centrality(double ratio) {
    const double now = std::min(1.0, largest_step());
    if (now >= 0.95) return false;
    const double aim = std::min(1.0, kLongerBy * now + kLongerPlus);
    const double target = ratio * ratio * ratio * complementarity_;
    old_rhs_.assign(o_.rhs, o_.rhs + n_);
    old_df_.assign(o_.df, o_.df + n_);
    old_dw_.assign(o_.dw, o_.dw + n_);
    old_ratio_.assign(o_.ratio, o_.ratio + n_);
    old_dv_ = dv_;
    for (std::size_t i = 0; i < n_; ++i) {
      const double product = (o_.f[i] + aim * o_.df[i]) * (o_.w[i] + aim * o_.dw[i]);
      const double wanted = std::clamp(product, kBand * target, target / kBand);
      const double change = std::max(wanted - product, -target / kBand);
      o_.rhs[i] -= change * o_.inverse_f[i];
    }
    direction();
    if (std::min(1.0, largest_step()) >= now + kLeastGain * (aim - now)) return true;
    std::copy(old_rhs_.begin(), old_rhs_.end(), o_.rhs);
    std::copy(old_df_.begin(), old_df_.end(), o_.df);
    std::copy(old_dw_.begin(), old_dw_.end(), o_.dw);
    std::copy(old_ratio_.begin(), old_ratio_.end(), o_.ratio);
    dv_ = old_dv_;
    return false;
  }

  // False if the matrix could not be factored: the iterate is as far as rounding lets it come.
  bool step() {
    cone_kernels().orthant_scaling(o_);
    for (std::size_t i = count(); i < n_; ++i) o_.d[i] = 0.0;
    d_.assign(o_.d, o_.d + n_);
    if (!cholesky_.factor(system_.view(), system_.fronts(), d_)) return false;
    // momentum_ = J^T f - M (v - v_free)
    for (std::size_t i = 0; i < v_.size(); ++i) change_[i] = system_.free_velocity()[i] - v_[i];
    system_.multiply_mass(change_, momentum_);
    simd_kernels().multiply_jt(system_.view(), o_.f, momentum_.data());
    direction();
    plain_ ? follow_path() : predict_and_correct();
    const double scale = system_.scale_mps();
    const double damping =
        std::clamp(1.0 - complementarity_ / (scale * scale), kToBoundary, kShortOfBoundary);
    const double length = std::min(1.0, damping * largest_step());
    for (std::size_t i = 0; i < v_.size(); ++i) v_[i] += length * dv_[i];
    for (std::size_t i = 0; i < n_; ++i) {
      o_.w[i] += length * o_.dw[i];
      o_.f[i] += length * o_.df[i];
    }
    return true;
  }

  // The corrections can bring Mehrotra's method into a cycle (C. Cartis, Some disadvantages of a
  // Mehrotra-type primal-dual corrector interior point algorithm for linear programming, Appl.
  // Numer. Math. 59, 2009). The Newton step towards a nearby point of the central path cannot.
  void follow_path() {
    cone_kernels().orthant_corrector(o_, kPlainTarget * complementarity_, 0.0);
    direction();
  }

  void predict_and_correct() {
    const double affine = std::min(1.0, largest_step());
    double after = 0.0;
    for (std::size_t i = 0; i < count(); ++i)
      after += (o_.f[i] + affine * o_.df[i]) * (o_.w[i] + affine * o_.dw[i]);
    const double ratio = after / mean_divisor() / complementarity_;
    cone_kernels().orthant_corrector(o_, ratio * ratio * ratio * complementarity_,
                                     kClip * complementarity_);
    direction();
    for (int k = 0; k < kCentralityCorrectors && correct_centrality(ratio); ++k) {
    }
  }

  const ContactSystem& system_;
  BlockCholesky& cholesky_;
  std::size_t n_;
  AlignedDoubles store_, regular_, f_, d_, v_, dv_, momentum_;
  AlignedDoubles old_rhs_, old_df_, old_dw_, old_ratio_, old_dv_;
  AlignedDoubles change_ = AlignedDoubles(system_.body_doubles(), 0.0);
  OrthantArrays o_;
  double complementarity_ = 1.0;
  double apparent_ = 0.0;
  double least_apparent_ = HUGE_VAL;
  double least_complementarity_ = HUGE_VAL;
  int rises_ = 0;       // iterations since then
  bool plain_ = false;  // without corrections
  int unclear_ = 0;
  double next_unclear_ = kPolishFrom;
  double next_polish_ = kPolishAnyway;
  int polishes_ = 0;
  AlignedDoubles d_polish_, kept_f_;
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
