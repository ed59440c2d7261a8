#include <algorithm>
#include <cmath>
#include <limits>

#include "ourengine/contact/solver_common.hpp"

namespace ourengine {
namespace {

constexpr double kFeasible = 1e-10;  // of the scale: a contact counts as violated beyond this
// The two thresholds must fit each other: a contact refused as dependent must also pass as
// unblocking, or it is chosen again for ever.
constexpr double kDependent = 1e-11;  // Schur pivot over A_dd below which a contact is dependent
constexpr double kBlocking = 1e-7;    // rate of w over A_ii below which a contact cannot block
constexpr double kHarris = 0.1;       // of kFeasible: given way in the ratio test
constexpr int kPivotsPerContact = 5;

// Cottle and Dantzig's principal pivoting for 0 <= f _|_ w = A f + b >= 0, as in Baraff (Fast
// contact force computation for nonpenetrating rigid bodies, 1994): contacts are satisfied one by
// one, the most violated first, while those satisfied stay so. A is never formed: directions go
// through the sparse Jacobian, and the Cholesky factor of A over the clamped set C is updated by
// one row per pivot.
class Pivoting {
 public:
  explicit Pivoting(const ContactSystem& system)
      : system_(system),
        count_(system.contacts()),
        f_(system.rows(), 0.0),
        w_(system.rows()),
        rate_(system.rows()),
        velocity_(system.body_doubles()),
        place_(static_cast<std::size_t>(count_), -1),
        settled_(static_cast<std::size_t>(count_), 0),
        column_(static_cast<std::size_t>(count_), 0.0),
        touching_(static_cast<std::size_t>(system.bodies()) + 1) {
    for (int i = 0; i < count_; ++i) {
      touching_[body(i, 0)].push_back(i);
      touching_[body(i, 1)].push_back(i);
    }
    simd_kernels().multiply_j(system.view(), system.free_velocity().data(), true, w_.data());
  }

  Outcome run(const SolveOptions& options) {
    const int limit = iterations_or(options, kPivotsPerContact * std::max(count_, 20));
    Outcome outcome = no_impulses(system_, ContactLaw::kCoulomb);
    bool bounded = true;
    for (int next = most_violated(); next >= 0 && bounded && pivots_ < limit;
         next = most_violated()) {
      settled_[at(next)] = 0;
      bounded = drive_to_zero(next, limit);
    }
    for (double& f : f_) f = std::max(f, 0.0);
    AlignedDoubles v, w;
    const double residual = contact_residual_of(system_, f_, ContactLaw::kCoulomb, v, w);
    keep_better(outcome, f_, v, residual);
    outcome.iterations = pivots_;
    outcome.status = outcome.residual <= options.tolerance ? SolveStatus::kSolved
                     : pivots_ >= limit                    ? SolveStatus::kMaxIterations
                                                           : SolveStatus::kStalled;
    return outcome;
  }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  std::size_t body(int contact, int side) const {
    const SystemView& view = system_.view();
    return static_cast<std::size_t>((side == 0 ? view.offset_a : view.offset_b)[contact]) /
           kBodyStride;
  }

  int most_violated() const {
    int worst = -1;
    double least = -kFeasible * system_.scale_mps();
    for (int i = 0; i < count_; ++i) {
      if (place_[at(i)] < 0 && w_[at(i)] < least) {
        least = w_[at(i)];
        worst = i;
      }
    }
    return worst;
  }

  // Column d of A over the clamped set, and A_dd.
  double clamped_column(int d, std::vector<double>& over_set) {
    const SystemView& view = system_.view();
    const double* inverse = system_.inverse_rows().data() + 16 * at(d);
    for (int side = 0; side < 2; ++side) {
      const std::size_t moved = body(d, side);
      if (moved == at(system_.bodies())) continue;
      for (const int i : touching_[moved]) {
        const double* row = view.rows + 16 * at(i) + (body(i, 0) == moved ? 0 : 8);
        for (int c = 0; c < 6; ++c) column_[at(i)] += row[c] * inverse[8 * side + c];
      }
    }
    over_set.resize(clamped_.size());
    for (std::size_t k = 0; k < clamped_.size(); ++k) over_set[k] = column_[at(clamped_[k])];
    const double diagonal = column_[at(d)];
    for (int side = 0; side < 2; ++side) {
      for (const int i : touching_[body(d, side)]) column_[at(i)] = 0.0;
    }
    return diagonal;
  }

  // y <- L^-1 y; returns the squared length.
  double forward(std::vector<double>& y) const {
    double square = 0.0;
    for (std::size_t i = 0; i < y.size(); ++i) {
      double sum = y[i];
      for (std::size_t j = 0; j < i; ++j) sum -= factor_[i][j] * y[j];
      y[i] = sum / factor_[i][i];
      square += y[i] * y[i];
    }
    return square;
  }

  void backward(std::vector<double>& y) const {
    for (std::size_t i = y.size(); i-- > 0;) {
      y[i] /= factor_[i][i];
      for (std::size_t j = 0; j < i; ++j) y[j] -= factor_[i][j] * y[i];
    }
  }

  // False if d depends on the clamped set.
  bool clamp(int d) {
    std::vector<double> y;
    const double diagonal = clamped_column(d, y);
    const double pivot = diagonal - forward(y);
    if (pivot < kDependent * diagonal) return false;
    y.push_back(std::sqrt(pivot));
    factor_.push_back(std::move(y));
    place_[at(d)] = static_cast<int>(clamped_.size());
    clamped_.push_back(d);
    return true;
  }

  // Drops a row of the factor; Givens rotations restore its triangle.
  void release(int d) {
    const std::size_t gone = at(place_[at(d)]);
    place_[at(d)] = -1;
    clamped_.erase(clamped_.begin() + static_cast<std::ptrdiff_t>(gone));
    factor_.erase(factor_.begin() + static_cast<std::ptrdiff_t>(gone));
    for (std::size_t i = gone; i < clamped_.size(); ++i) {
      place_[at(clamped_[i])] = static_cast<int>(i);
      const double length = std::hypot(factor_[i][i], factor_[i][i + 1]);
      const double c = factor_[i][i] / length, s = factor_[i][i + 1] / length;
      factor_[i][i] = length;
      factor_[i].resize(i + 1);
      for (std::size_t q = i + 1; q < clamped_.size(); ++q) {
        const double a = factor_[q][i], b = factor_[q][i + 1];
        factor_[q][i] = c * a + s * b;
        factor_[q][i + 1] = c * b - s * a;
      }
    }
  }

  void add_to_velocity(int i, double impulse) {
    const double* inverse = system_.inverse_rows().data() + 16 * at(i);
    for (int side = 0; side < 2; ++side) {
      double* v = velocity_.data() + kBodyStride * body(i, side);
      for (int c = 0; c < 6; ++c) v[c] += inverse[8 * side + c] * impulse;
    }
  }

  // Rates of f over the clamped set (-share_) and of w per unit of f_d.
  bool rates(int d) {
    const double diagonal = clamped_column(d, share_);
    const double pivot = diagonal - forward(share_);
    backward(share_);
    std::fill(velocity_.begin(), velocity_.end(), 0.0);
    add_to_velocity(d, 1.0);
    for (std::size_t k = 0; k < clamped_.size(); ++k) add_to_velocity(clamped_[k], -share_[k]);
    simd_kernels().multiply_j(system_.view(), velocity_.data(), false, rate_.data());
    return pivot >= kDependent * diagonal;
  }

  struct Step {
    double length = HUGE_VAL;
    int stopper = -1;
  };

  // Calls see(contact, slack, rate, give) for each contact that the step would take out of its set:
  // a clamped force that falls or a settled velocity that closes, by `rate` per unit of f_d.
  template <typename See>
  void for_blocking(See see) const {
    const double give_mps = kHarris * kFeasible * system_.scale_mps();
    for (std::size_t k = 0; k < clamped_.size(); ++k) {
      if (share_[k] <= 1e-12) continue;
      const int i = clamped_[k];
      const double diagonal = system_.delassus()[at(i)];
      see(i, diagonal * f_[at(i)], diagonal * share_[k], give_mps);
    }
    for (int i = 0; i < count_; ++i) {
      if (settled_[at(i)] == 0 || rate_[at(i)] >= -kBlocking * system_.delassus()[at(i)]) continue;
      see(i, std::max(0.0, w_[at(i)]), -rate_[at(i)], give_mps);
    }
  }

  // How far f_d may rise. Of the contacts that stop it within the give of each other, the one that
  // changes fastest is taken: it makes the best pivot, and rounding does not choose (P. M. J.
  // Harris, Pivot selection methods of the Devex LP code, Math. Program. 5, 1973).
  Step longest_step(int d, bool independent) const {
    Step step;
    if (independent) step = {-w_[at(d)] / rate_[at(d)], d};
    double longest = step.length;
    for_blocking([&](int, double slack, double rate, double give) {
      longest = std::min(longest, (slack + give) / rate);
    });
    if (step.length <= longest) return step;
    double fastest = 0.0;
    for_blocking([&](int i, double slack, double rate, double) {
      if (slack / rate > longest || rate <= fastest) return;
      fastest = rate;
      step = {std::max(0.0, slack / rate), i};
    });
    return step;
  }

  // Raises f_d until w_d = 0. False if nothing stops it.
  bool drive_to_zero(int d, int limit) {
    while (pivots_ < limit) {
      ++pivots_;
      const Step step = longest_step(d, rates(d));
      if (step.stopper < 0) return false;
      advance(d, step.length);
      if (exchange(d, step.stopper)) return true;
    }
    return true;
  }

  void advance(int d, double step) {
    f_[at(d)] += step;
    for (std::size_t k = 0; k < clamped_.size(); ++k) f_[at(clamped_[k])] -= step * share_[k];
    for (int i = 0; i < count_; ++i) w_[at(i)] += step * rate_[at(i)];
  }

  // Moves the contact that stopped the step between the sets; true if it was d itself.
  bool exchange(int d, int stopper) {
    if (place_[at(stopper)] >= 0) {
      f_[at(stopper)] = 0.0;
      release(stopper);
      settled_[at(stopper)] = 1;
      return false;
    }
    w_[at(stopper)] = 0.0;
    settled_[at(stopper)] = clamp(stopper) ? 0 : 1;
    return stopper == d;
  }

  const ContactSystem& system_;
  int count_;
  AlignedDoubles f_, w_, rate_, velocity_;
  std::vector<int> place_;     // in the clamped set, or -1
  std::vector<char> settled_;  // held at f = 0, w >= 0
  std::vector<double> column_, share_;
  std::vector<std::vector<int>> touching_;
  std::vector<int> clamped_;
  std::vector<std::vector<double>> factor_;  // rows of the lower Cholesky factor of A_CC
  int pivots_ = 0;
};

}  // namespace

Outcome dantzig(const ContactSystem& system, const SolveOptions& options) {
  return Pivoting(system).run(options);
}

ContactSolution solve_dantzig(const ContactProblem& problem, const SolveOptions& options,
                              const WarmStart& /*pivoting starts cold*/, SolverMemory& memory) {
  if (largest_friction(problem) > 0.0) return unsuitable(problem, "dantzig");
  const ContactSystem system(problem, 1, memory.symbolic);
  return hand_back(problem, system, dantzig(system, options), "dantzig");
}

}  // namespace ourengine
