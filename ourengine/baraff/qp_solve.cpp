#include "ourengine/baraff/qp_solve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "ourengine/baraff/clamped_factor.hpp"

namespace ourengine::baraff {
namespace {

constexpr double k_regular = 1e-9;    // of A_ii, added to the diagonal
constexpr double k_pivot = 1e-11;     // of A_dd: below it a contact depends on C
constexpr double k_change = 1e-7;     // of sqrt(A_ii A_dd): a smaller change does not block
constexpr double k_feasible = 1e-11;  // of s, see qp_solve.hpp
constexpr double k_harris = 0.1;      // of the feasibility tolerance, given way in the ratio test
constexpr double k_accepted = 1e-9;   // residual above which the regularised method is tried
constexpr double k_usable = 1e-6;     // residual above which the solve has failed
constexpr double k_solved = 1e-11;    // residual at which the correction by refine() may stop
constexpr int k_visits = 4;
constexpr int k_refinements = 4;
constexpr double k_infinite = std::numeric_limits<double>::infinity();

// `none`: not looked after yet.
enum class Set : unsigned char { none, clamped, free };

double scale_of(const Eigen::VectorXd& b, double term_size) {
  return b.size() == 0 ? term_size : std::max(term_size, b.cwiseAbs().maxCoeff());
}

class Dantzig {
 public:
  Dantzig(const SparseMatrix& a_matrix, const Eigen::VectorXd& b, double term_size, double regular)
      : a_matrix_(a_matrix),
        b_(b),
        term_size_(term_size),
        unregular_(a_matrix.diagonal()),
        diagonal_((1.0 + regular) * unregular_),
        factor_(b.size()),
        in_(static_cast<std::size_t>(b.size()), Set::none),
        place_(static_cast<std::size_t>(b.size()), -1),
        tolerance_(k_feasible * scale_of(b, term_size)),
        cap_(4 * static_cast<int>(b.size()) + 100) {
    result_.force = Eigen::VectorXd::Zero(b.size());
    result_.acceleration = b;
  }

  QpResult solve() {
    for (int visit = 0; visit < k_visits && !result_.failed; ++visit) {
      for (Eigen::Index d = most_violated(); d >= 0 && !result_.failed; d = most_violated()) {
        drive_to_zero(d);
      }
      refine();
      if (result_.residual <= k_accepted) break;
    }
    result_.failed = result_.failed || !(result_.residual < k_infinite);
    return std::move(result_);
  }

 private:
  static std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }

  // A_Cd in the order of the factor.
  Eigen::VectorXd clamped_column(Eigen::Index d) const {
    Eigen::VectorXd column = Eigen::VectorXd::Zero(factor_.size());
    for (SparseMatrix::InnerIterator entry(a_matrix_, d); entry; ++entry) {
      if (const Eigen::Index place = place_[at(entry.col())]; place >= 0) {
        column[place] = entry.value();
      }
    }
    return column;
  }

  // Change of all forces per unit of f_d that leaves the clamped accelerations alone.
  Eigen::VectorXd fdirection(Eigen::Index d) {
    forward_ = factor_.forward(clamped_column(d));
    pivot_ = diagonal_[d] - forward_.squaredNorm();
    const Eigen::VectorXd on_clamped = factor_.backward(forward_);
    Eigen::VectorXd direction = Eigen::VectorXd::Zero(b_.size());
    direction[d] = 1.0;
    for (std::size_t k = 0; k < clamped_.size(); ++k) {
      direction[clamped_[k]] = -on_clamped[static_cast<Eigen::Index>(k)];
    }
    return direction;
  }

  // A df, of which d and the clamped contacts alone have entries.
  Eigen::VectorXd changes(Eigen::Index d, const Eigen::VectorXd& df) const {
    Eigen::VectorXd da = Eigen::VectorXd::Zero(b_.size());
    const auto add = [&](Eigen::Index i) {
      for (SparseMatrix::InnerIterator entry(a_matrix_, i); entry; ++entry) {
        da[entry.col()] += entry.value() * df[i];
      }
      da[i] += (diagonal_[i] - unregular_[i]) * df[i];
    };
    add(d);
    for (const Eigen::Index i : clamped_) add(i);
    return da;
  }

  struct Step {
    double length = k_infinite;
    Eigen::Index blocking = -1;
  };

  // The unclamped contact whose acceleration is most negative, or -1.
  Eigen::Index most_violated() const {
    Eigen::Index worst = -1;
    double least = -tolerance_;
    for (Eigen::Index i = 0; i < b_.size(); ++i) {
      if (in_[at(i)] != Set::clamped && result_.acceleration[i] < least) {
        least = result_.acceleration[i];
        worst = i;
      }
    }
    return worst;
  }

  bool blocks(Eigen::Index i, double change, const Eigen::VectorXd& da) const {
    return in_[at(i)] == Set::free && da[i] < -change * std::sqrt(diagonal_[i]);
  }

  // How far f may move until a_d is zero, a clamped force vanishes or a free contact closes. Ties
  // within a tenth of the tolerance go to the contact that changes fastest (Harris).
  Step maxstep(Eigen::Index d, const Eigen::VectorXd& df, const Eigen::VectorXd& da) const {
    const double change = k_change * std::sqrt(diagonal_[d]);
    const double give = k_harris * tolerance_;
    double longest =
        pivot_ > k_pivot * diagonal_[d] ? -result_.acceleration[d] / pivot_ : k_infinite;
    Step step{longest, longest < k_infinite ? d : -1};
    for (const Eigen::Index i : clamped_) {
      if (df[i] < 0.0)
        longest = std::min(longest, (result_.force[i] + give / diagonal_[i]) / -df[i]);
    }
    for (Eigen::Index i = 0; i < b_.size(); ++i) {
      if (blocks(i, change, da)) {
        longest = std::min(longest, (std::max(0.0, result_.acceleration[i]) + give) / -da[i]);
      }
    }
    if (step.length <= longest) return step;
    double fastest = 0.0;
    const auto choose = [&](Eigen::Index i, double length, double rate) {
      if (length > longest || rate <= fastest) return;
      fastest = rate;
      step = {std::max(0.0, length), i};
    };
    for (const Eigen::Index i : clamped_) {
      if (df[i] < 0.0)
        choose(i, result_.force[i] / -df[i], -df[i] * std::sqrt(diagonal_[i] / diagonal_[d]));
    }
    for (Eigen::Index i = 0; i < b_.size(); ++i) {
      if (blocks(i, change, da)) {
        choose(i, result_.acceleration[i] / -da[i],
               -da[i] / std::sqrt(diagonal_[i] * diagonal_[d]));
      }
    }
    return step;
  }

  // False where i depends on C: its acceleration stays zero all the same.
  bool clamp(Eigen::Index i) {
    const Eigen::VectorXd y = factor_.forward(clamped_column(i));
    const double pivot = diagonal_[i] - y.squaredNorm();
    if (!(pivot > k_pivot * diagonal_[i])) return false;
    in_[at(i)] = Set::clamped;
    place_[at(i)] = factor_.size();
    clamped_.push_back(i);
    factor_.append(y, pivot);
    return true;
  }

  void release(Eigen::Index i) {
    const Eigen::Index place = place_[at(i)];
    factor_.remove(place);
    clamped_.erase(clamped_.begin() + place);
    for (std::size_t k = at(place); k < clamped_.size(); ++k) --place_[at(clamped_[k])];
    place_[at(i)] = -1;
    in_[at(i)] = Set::free;
    result_.force[i] = 0.0;
    result_.acceleration[i] = 0.0;
  }

  // Raises f_d from zero until a_d is zero, keeping the three conditions at all other contacts.
  void drive_to_zero(Eigen::Index d) {
    in_[at(d)] = Set::none;
    while (result_.acceleration[d] < -tolerance_) {
      const Eigen::VectorXd df = fdirection(d);
      const Eigen::VectorXd da = changes(d, df);
      const auto [length, blocking] = maxstep(d, df, da);
      result_.failed = ++result_.pivots > cap_ || !(length < k_infinite);
      if (result_.failed) return;
      if (length <= 0.0) ++result_.zero_steps;
      result_.force += length * df;
      result_.acceleration += length * da;
      for (const Eigen::Index i : clamped_) {
        result_.acceleration[i] = 0.0;
        result_.force[i] = std::max(0.0, result_.force[i]);
      }
      if (blocking == d) break;
      if (in_[at(blocking)] == Set::clamped) {
        release(blocking);
      } else {
        result_.acceleration[blocking] = 0.0;
        static_cast<void>(clamp(blocking));
      }
    }
    result_.acceleration[d] = 0.0;
    in_[at(d)] = Set::free;
    settle(d);
  }

  // Clamps d, whose acceleration is zero. Where d depends on C its force is handed over to C, until
  // it vanishes or a contact leaves that d can replace.
  void settle(Eigen::Index d) {
    while (result_.force[d] > 0.0 && !clamp(d)) {
      const Eigen::VectorXd df = fdirection(d);
      double length = result_.force[d];
      Eigen::Index blocking = -1;
      for (const Eigen::Index i : clamped_) {
        if (df[i] > 0.0 && result_.force[i] / df[i] < length) {
          length = result_.force[i] / df[i];
          blocking = i;
        }
      }
      result_.force -= length * df;
      ++result_.pivots;
      if (blocking >= 0) {
        release(blocking);
      } else {
        result_.force[d] = 0.0;
      }
    }
  }

  // Newton's correction of a_C = 0 for A itself, the factor being that of the regularised matrix:
  // each round divides what is left of a_C by about 1e6.
  void refine() {
    for (int round = 0;; ++round) {
      result_.acceleration = a_matrix_ * result_.force + b_;
      result_.residual =
          complementarity_residual(a_matrix_, b_, result_.force, result_.acceleration, term_size_);
      if (round == k_refinements || result_.residual <= k_solved || clamped_.empty()) return;
      Eigen::VectorXd left(factor_.size());
      for (std::size_t k = 0; k < clamped_.size(); ++k) {
        left[static_cast<Eigen::Index>(k)] = result_.acceleration[clamped_[k]];
      }
      const Eigen::VectorXd correction = factor_.backward(factor_.forward(left));
      for (std::size_t k = 0; k < clamped_.size(); ++k) {
        double& force = result_.force[clamped_[k]];
        force = std::max(0.0, force - correction[static_cast<Eigen::Index>(k)]);
      }
    }
  }

  const SparseMatrix& a_matrix_;
  const Eigen::VectorXd& b_;
  double term_size_;
  Eigen::VectorXd unregular_, diagonal_;
  ClampedFactor factor_;
  std::vector<Eigen::Index> clamped_;  // order of the factor's rows
  std::vector<Set> in_;
  std::vector<Eigen::Index> place_;  // row in the factor, or -1
  double tolerance_;
  int cap_;
  Eigen::VectorXd forward_;
  double pivot_ = 0.0;
  QpResult result_;
};

}  // namespace

double complementarity_residual(const SparseMatrix& a_matrix, const Eigen::VectorXd& b,
                                const Eigen::VectorXd& force, const Eigen::VectorXd& acceleration,
                                double term_size) {
  const Eigen::VectorXd scaled = a_matrix.diagonal().cwiseProduct(force);
  double worst = 0.0;
  for (Eigen::Index i = 0; i < b.size(); ++i) {
    const double violation = std::abs(std::min(scaled[i], acceleration[i]));
    if (!(violation < k_infinite) || std::isnan(scaled[i])) return k_infinite;
    worst = std::max(worst, violation);
  }
  const double scale = scale_of(b, term_size);
  return scale > 0.0 ? worst / scale : worst;
}

QpResult qp_solve(const SparseMatrix& a_matrix, const Eigen::VectorXd& b, double term_size) {
  if (b.size() == 0) return {};
  if (!b.allFinite()) {
    return {.force = Eigen::VectorXd::Zero(b.size()),
            .acceleration = b,
            .residual = k_infinite,
            .failed = true};
  }
  QpResult plain = Dantzig(a_matrix, b, term_size, 0.0).solve();
  if (!plain.failed && plain.residual <= k_accepted) return plain;
  QpResult regular = Dantzig(a_matrix, b, term_size, k_regular).solve();
  QpResult& better = regular.residual < plain.residual ? regular : plain;
  const int pivots = plain.pivots + regular.pivots;
  const int zero_steps = plain.zero_steps + regular.zero_steps;
  better.pivots = pivots;
  better.zero_steps = zero_steps;
  better.retried = true;
  better.failed = !(better.residual <= k_usable);
  return std::move(better);
}

}  // namespace ourengine::baraff
