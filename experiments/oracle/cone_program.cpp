#include "experiments/oracle/cone_program.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <array>
#include <cmath>
#include <limits>

namespace brickbench::gate {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Wrench6x3 = Eigen::Matrix<double, 6, 3>;

// One contact as the solver sees it: columns of A for body a and b, in the contact's own axes
// (normal, two tangents), angular rows divided by the radius of gyration.
struct Column {
  std::array<std::size_t, 2> body;
  std::array<Wrench6x3, 2> a;
  Eigen::Matrix3d axes;
  double friction;
};

Eigen::Matrix3d contact_axes(const Eigen::Vector3d& normal) {
  Eigen::Matrix3d axes;
  axes.col(0) = normal;
  axes.col(1) = normal.unitOrthogonal();
  axes.col(2) = normal.cross(axes.col(1));
  return axes;
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& r) {
  Eigen::Matrix3d matrix;
  matrix << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  return matrix;
}

Wrench6x3 column_of(const Eigen::Matrix3d& axes, const Eigen::Vector3d& arm, double gyration,
                    double sign) {
  Wrench6x3 column;
  column.topRows<3>() = sign * axes;
  column.bottomRows<3>() = sign / gyration * (cross_matrix(arm) * axes);
  return column;
}

std::vector<Column> columns_of(const ConeProblem& problem) {
  std::vector<Column> columns;
  for (const ConeContact& contact : problem.contacts) {
    Column column;
    column.body = {contact.body_a, contact.body_b};
    column.axes = contact_axes(contact.normal);
    column.friction = contact.friction;
    const std::array<const Eigen::Vector3d*, 2> arms = {&contact.arm_a_m, &contact.arm_b_m};
    for (std::size_t side = 0; side < 2; ++side) {
      const std::size_t body = column.body[side];
      column.a[side].setZero();
      if (body == ConeContact::none) continue;
      column.a[side] =
          column_of(column.axes, *arms[side], problem.gyration_m[body], side == 0 ? -1.0 : 1.0);
    }
    columns.push_back(column);
  }
  return columns;
}

Eigen::VectorXd right_side(const ConeProblem& problem) {
  Eigen::VectorXd b(6 * static_cast<Eigen::Index>(problem.linear_ns.size()));
  for (std::size_t i = 0; i < problem.linear_ns.size(); ++i) {
    const auto at = 6 * static_cast<Eigen::Index>(i);
    b.segment<3>(at) = problem.linear_ns[i];
    b.segment<3>(at + 3) = problem.angular_nms[i] / problem.gyration_m[i];
  }
  return b;
}

// -log of the cone's defining function: gradient and Hessian at (n, t). Without friction only n
// counts, and the tangents are left out of the problem by an infinite curvature.
struct Barrier {
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inverse_hessian = Eigen::Matrix3d::Zero();
};

Barrier barrier(const Eigen::Vector3d& x, double mu) {
  Barrier result;
  if (mu == 0.0) {
    result.gradient.x() = -1.0 / x.x();
    result.inverse_hessian(0, 0) = x.x() * x.x();
    return result;
  }
  // f = mu^2 n^2 - |t|^2 = x.J x; the inverse Hessian of -log f is x x^T - f/2 J^-1.
  const double f = (mu * x.x() - x.tail<2>().norm()) * (mu * x.x() + x.tail<2>().norm());
  const Eigen::Vector3d j(mu * mu, -1.0, -1.0);
  result.gradient = -2.0 / f * j.cwiseProduct(x);
  result.inverse_hessian = x * x.transpose();
  result.inverse_hessian.diagonal() -= 0.5 * f * j.cwiseInverse();
  return result;
}

// The longest step <= 1 along d that keeps x within the cone, less a margin.
double step_inside(const Eigen::Vector3d& x, const Eigen::Vector3d& d, double mu) {
  double step = 1.0;
  const auto inside = [&](double s) {
    const Eigen::Vector3d y = x + s * d;
    return mu == 0.0 ? y.x() > 0.0 : y.x() > 0.0 && mu * y.x() > y.tail<2>().norm();
  };
  while (!inside(step) && step > 1e-12) step *= 0.8;
  return step;
}

class BarrierSolver {
 public:
  explicit BarrierSolver(const ConeProblem& problem)
      : columns_(columns_of(problem)), b_(right_side(problem)), scale_(b_.norm()) {
    b_ /= scale_;
    for (const Column& column : columns_) {
      (void)column;
      x_.push_back(Eigen::Vector3d(1.0 / static_cast<double>(columns_.size()), 0.0, 0.0));
    }
  }

  // The residual, normalised.
  Eigen::VectorXd residual(const std::vector<Eigen::Vector3d>& x) const {
    Eigen::VectorXd r = b_;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      for (std::size_t side = 0; side < 2; ++side) {
        const std::size_t body = columns_[i].body[side];
        if (body == ConeContact::none) continue;
        r.segment<6>(6 * static_cast<Eigen::Index>(body)) -= columns_[i].a[side] * x[i];
      }
    }
    return r;
  }

  Eigen::Vector3d transposed(std::size_t i, const Eigen::VectorXd& r) const {
    Eigen::Vector3d y = Eigen::Vector3d::Zero();
    for (std::size_t side = 0; side < 2; ++side) {
      const std::size_t body = columns_[i].body[side];
      if (body == ConeContact::none) continue;
      y += columns_[i].a[side].transpose() * r.segment<6>(6 * static_cast<Eigen::Index>(body));
    }
    return y;
  }

  // b.r / |r| if r lies in the polar cone, else 0; normalised.
  double lower_bound(const Eigen::VectorXd& r) const {
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const Eigen::Vector3d y = transposed(i, r);
      // (n, t) is polar to |t| <= mu n where n + mu |t| <= 0.
      if (y.x() + columns_[i].friction * y.tail<2>().norm() > 0.0) return 0.0;
    }
    return std::max(0.0, b_.dot(r) / r.norm());
  }

  // One Newton step of  |b - A x|^2 / 2 + kappa sum barrier  ; returns the length of the step
  // taken, 0 if none helps.
  double newton(double kappa) {
    std::vector<Barrier> barriers;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      barriers.push_back(barrier(x_[i], columns_[i].friction));
    }
    factorise(barriers, kappa);
    if (cholesky_.info() != Eigen::Success) return 0.0;
    // (A^T A + kappa H) d = g with g = A^T r - kappa grad, by the matrix inversion lemma:
    // d = D g - D A^T (I + A D A^T)^-1 A D g with D = H^-1 / kappa.
    const Eigen::VectorXd r = residual(x_);
    std::vector<Eigen::Vector3d> dg(columns_.size());
    Eigen::VectorXd adg = Eigen::VectorXd::Zero(b_.size());
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const Eigen::Vector3d g = transposed(i, r) - kappa * barriers[i].gradient;
      dg[i] = barriers[i].inverse_hessian * g / kappa;
      for (std::size_t side = 0; side < 2; ++side) {
        const std::size_t body = columns_[i].body[side];
        if (body == ConeContact::none) continue;
        adg.segment<6>(6 * static_cast<Eigen::Index>(body)) += columns_[i].a[side] * dg[i];
      }
    }
    const Eigen::VectorXd z = cholesky_.solve(adg);
    double step = 1.0;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      dg[i] -= barriers[i].inverse_hessian * transposed(i, z) / kappa;
      step = std::min(step, step_inside(x_[i], dg[i], columns_[i].friction));
    }
    return search(dg, step, kappa);
  }

  const std::vector<Eigen::Vector3d>& x() const { return x_; }
  const std::vector<Column>& columns() const { return columns_; }
  double scale() const { return scale_; }
  double barrier_parameter() const { return 2.0 * static_cast<double>(columns_.size()); }

 private:
  void factorise(const std::vector<Barrier>& barriers, double kappa) {
    std::vector<Eigen::Triplet<double>> entries;
    for (Eigen::Index k = 0; k < b_.size(); ++k) entries.emplace_back(k, k, 1.0);
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const Column& column = columns_[i];
      for (std::size_t p = 0; p < 2; ++p) {
        for (std::size_t q = 0; q < 2; ++q) {
          if (column.body[p] == ConeContact::none || column.body[q] == ConeContact::none) continue;
          const Eigen::Matrix<double, 6, 6> block =
              column.a[p] * barriers[i].inverse_hessian * column.a[q].transpose() / kappa;
          for (Eigen::Index u = 0; u < 6; ++u) {
            for (Eigen::Index v = 0; v < 6; ++v) {
              entries.emplace_back(6 * static_cast<Eigen::Index>(column.body[p]) + u,
                                   6 * static_cast<Eigen::Index>(column.body[q]) + v, block(u, v));
            }
          }
        }
      }
    }
    matrix_.resize(b_.size(), b_.size());
    matrix_.setFromTriplets(entries.begin(), entries.end());
    if (!analysed_) cholesky_.analyzePattern(matrix_);
    analysed_ = true;
    cholesky_.factorize(matrix_);
  }

  double merit(const std::vector<Eigen::Vector3d>& x, double kappa) const {
    double sum = 0.5 * residual(x).squaredNorm();
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double mu = columns_[i].friction;
      const double t = x[i].tail<2>().norm();
      const double f = mu == 0.0 ? x[i].x() : (mu * x[i].x() - t) * (mu * x[i].x() + t);
      if (!(f > 0.0) || !(x[i].x() > 0.0)) return std::numeric_limits<double>::infinity();
      sum -= kappa * std::log(f);
    }
    return sum;
  }

  double search(const std::vector<Eigen::Vector3d>& direction, double step, double kappa) {
    const double before = merit(x_, kappa);
    std::vector<Eigen::Vector3d> next = x_;
    for (; step > 1e-10; step *= 0.5) {
      for (std::size_t i = 0; i < x_.size(); ++i) next[i] = x_[i] + step * direction[i];
      if (merit(next, kappa) < before) {
        x_ = std::move(next);
        return step;
      }
    }
    return 0.0;
  }

  std::vector<Column> columns_;
  Eigen::VectorXd b_;
  double scale_;
  std::vector<Eigen::Vector3d> x_;
  Eigen::SparseMatrix<double> matrix_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> cholesky_;
  bool analysed_ = false;
};

ConeSolution solution_of(const ConeProblem& problem, const BarrierSolver& solver,
                         const std::vector<Eigen::Vector3d>& x) {
  ConeSolution solution;
  const Eigen::VectorXd r = solver.residual(x) * solver.scale();
  solution.residual_ns = r.norm();
  for (std::size_t i = 0; i < x.size(); ++i) {
    solution.impulses_ns.push_back(solver.columns()[i].axes * x[i] * solver.scale());
  }
  for (std::size_t body = 0; body < problem.linear_ns.size(); ++body) {
    const auto at = 6 * static_cast<Eigen::Index>(body);
    solution.linear_residual_ns.emplace_back(r.segment<3>(at));
    solution.angular_residual_nms.emplace_back(r.segment<3>(at + 3) * problem.gyration_m[body]);
  }
  return solution;
}

ConeSolution nothing_explained(const ConeProblem& problem) {
  ConeSolution solution;
  solution.residual_ns = right_side(problem).norm();
  solution.bound_ns = problem.contacts.empty() ? solution.residual_ns : 0.0;
  solution.impulses_ns.resize(problem.contacts.size(), Eigen::Vector3d::Zero());
  solution.linear_residual_ns = problem.linear_ns;
  solution.angular_residual_nms = problem.angular_nms;
  return solution;
}

}  // namespace

ConeSolution solve(const ConeProblem& problem, double gap_ns) {
  constexpr double shrink = 0.1;
  constexpr double smallest_kappa = 1e-18;  // of |b|^2: the square of what doubles resolve
  constexpr int newton_steps = 12;
  ConeSolution best = nothing_explained(problem);
  if (problem.contacts.empty() || best.residual_ns == 0.0) return best;
  BarrierSolver solver(problem);
  double bound = 0.0;
  int iterations = 0;
  for (double kappa = 1e-2 / solver.barrier_parameter(); kappa > smallest_kappa; kappa *= shrink) {
    for (int step = 0; step < newton_steps; ++step) {
      ++iterations;
      const double length = solver.newton(kappa);
      const Eigen::VectorXd r = solver.residual(solver.x());
      const double lower = solver.lower_bound(r) * solver.scale();
      const bool better = r.norm() * solver.scale() < best.residual_ns || lower > bound;
      if (better) {
        bound = std::max(bound, lower);
        if (r.norm() * solver.scale() <= best.residual_ns || lower >= bound) {
          best = solution_of(problem, solver, solver.x());
        }
      }
      best.bound_ns = bound;
      best.iterations = iterations;
      // Centred (r is polar to the cone) or at a standstill: the next, smaller kappa.
      if (length == 0.0 || (length == 1.0 && lower > 0.0)) break;
    }
    if (best.residual_ns - best.bound_ns <= gap_ns) break;
  }
  return best;
}

ConeBounds certify(const ConeProblem& problem, const ConeSolution& solution) {
  constexpr double rounding = 1e-12;
  std::vector<Eigen::Vector3d> p = problem.linear_ns;
  std::vector<Eigen::Vector3d> l = problem.angular_nms;
  bool admissible = true;
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const ConeContact& contact = problem.contacts[i];
    const Eigen::Vector3d& impulse = solution.impulses_ns[i];
    const double normal = impulse.dot(contact.normal);
    const double slip = (impulse - normal * contact.normal).norm();
    if (normal < 0.0 || slip > contact.friction * normal + rounding * impulse.norm()) {
      admissible = false;
    }
    if (contact.body_a != ConeContact::none) {
      p[contact.body_a] += impulse;
      l[contact.body_a] += contact.arm_a_m.cross(impulse);
    }
    if (contact.body_b != ConeContact::none) {
      p[contact.body_b] -= impulse;
      l[contact.body_b] -= contact.arm_b_m.cross(impulse);
    }
  }
  double square = 0.0;
  double work = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double g2 = problem.gyration_m[i] * problem.gyration_m[i];
    square += p[i].squaredNorm() + l[i].squaredNorm() / g2;
    work += p[i].dot(problem.linear_ns[i]) + l[i].dot(problem.angular_nms[i]) / g2;
  }
  bool polar = square > 0.0;
  const auto velocity = [&](std::size_t body, const Eigen::Vector3d& arm) -> Eigen::Vector3d {
    if (body == ConeContact::none) return Eigen::Vector3d::Zero();
    const double g2 = problem.gyration_m[body] * problem.gyration_m[body];
    return p[body] + (l[body] / g2).cross(arm);
  };
  for (const ConeContact& contact : problem.contacts) {
    const Eigen::Vector3d v =
        velocity(contact.body_b, contact.arm_b_m) - velocity(contact.body_a, contact.arm_a_m);
    const double normal = v.dot(contact.normal);
    const double slip = (v - normal * contact.normal).norm();
    if (normal + contact.friction * slip > 0.0) polar = false;
  }
  ConeBounds bounds;
  bounds.upper_ns = admissible ? std::sqrt(square) : std::numeric_limits<double>::infinity();
  bounds.lower_ns = polar ? std::max(0.0, work / std::sqrt(square)) : 0.0;
  return bounds;
}

}  // namespace brickbench::gate
