// The pivoting against an enumeration of all complementary sets, and on walls under random loads.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>
#include <random>

#include "ourengine/baraff/qp_solve.hpp"
#include "ourengine/baraff/resting_contact.hpp"
#include "tests/support/tolerance.hpp"
#include "tests/unit/ourengine/baraff/scenes.hpp"

namespace ourengine::baraff {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;

constexpr Tolerance k_acceleration{"acceleration", 1e-12, 7.6e-14,
                                   "rounding times the condition of the sets chosen"};
constexpr Tolerance k_solve_residual{"complementarity", 1e-12, 9.5e-14,
                                     "1140 contacts; accelerations recomputed from the forces"};
constexpr Tolerance k_eigenvalue{"negative_eigenvalue", 4e-15, 2.5e-16,
                                 "rounding errors of the largest eigenvalue"};

class RandomVectors {
 public:
  double number() { return normal_(engine_); }
  Eigen::VectorXd vector(Eigen::Index n) {
    Eigen::VectorXd v(n);
    for (double& entry : v) entry = number();
    return v;
  }

 private:
  std::mt19937_64 engine_{11};
  std::normal_distribution<double> normal_;
};

// a = A f + b of the first set C with A_CC f_C = -b_C, f_C >= 0 and a >= 0. f may not be unique
// where A is singular; a is. Empty if no set passes.
Eigen::VectorXd enumerated_acceleration(const Eigen::MatrixXd& a_matrix, const Eigen::VectorXd& b) {
  const double tolerance = 1e-9 * b.cwiseAbs().maxCoeff();
  for (unsigned set = 0; set < (1U << b.size()); ++set) {
    std::vector<int> c;
    for (int i = 0; i < b.size(); ++i) {
      if ((set >> i) & 1U) c.push_back(i);
    }
    Eigen::VectorXd f = Eigen::VectorXd::Zero(b.size());
    if (!c.empty()) {
      const Eigen::MatrixXd a_cc = a_matrix(c, c);
      Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor;
      factor.setThreshold(1e-10);
      const Eigen::VectorXd right = -b(c);
      const Eigen::VectorXd loaded = factor.compute(a_cc).solve(right);
      f(c) = loaded;
    }
    const Eigen::VectorXd a = a_matrix * f + b;
    const double off = c.empty() ? 0.0 : a(c).cwiseAbs().maxCoeff();
    if (f.minCoeff() >= -tolerance && a.minCoeff() >= -tolerance && off <= tolerance) return a;
  }
  return {};
}

// J J^T with `rank` columns; every third row of J repeats the one before it if `repeat`.
Eigen::MatrixXd rows(RandomVectors& random, int n, int rank, bool repeat) {
  Eigen::MatrixXd j = random.vector(n * rank).reshaped(n, rank);
  for (int r = 1; repeat && r < n; r += 3) j.row(r) = j.row(r - 1);
  return j;
}

TEST(QpSolve, AccelerationsAreThoseOfTheEnumeration) {
  RandomVectors random;
  Worst worst;
  int loaded = 0;
  for (int i = 0; i < 400; ++i) {
    const int n = 2 + i % 7;
    const Eigen::MatrixXd j = rows(random, n, i % 2 == 0 ? n : 1 + n / 2, i % 4 == 1);
    const Eigen::MatrixXd a_matrix = j * j.transpose();
    const Eigen::VectorXd b = j * random.vector(j.cols());
    const Eigen::VectorXd expected = enumerated_acceleration(a_matrix, b);
    ASSERT_EQ(expected.size(), n) << "no complementary set in case " << i;
    const QpResult solved = qp_solve(a_matrix.sparseView(), b);
    ASSERT_FALSE(solved.failed) << "case " << i;
    loaded += solved.force.maxCoeff() > 0.0 ? 1 : 0;
    worst.see((solved.acceleration - expected).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff(),
              "case " + std::to_string(i));
  }
  EXPECT_GT(loaded, 300);
  EXPECT_TRUE(worst.within(k_acceleration));
}

struct Wall {
  std::vector<RigidBody> bodies;
  std::vector<Collision> contacts;
  SparseMatrix a_matrix;
};

Wall wall_problem(int size) {
  Wall wall;
  wall.bodies = testing::wall(size);
  find_collisions(wall.bodies, 1e-6, wall.contacts);
  wall.a_matrix = compute_a_matrix(wall.bodies, wall.contacts);
  return wall;
}

TEST(RestingContact, AOfAWallIsSymmetricAndPositiveSemidefinite) {
  const Wall wall = wall_problem(4);
  const Eigen::MatrixXd a_matrix = wall.a_matrix;
  EXPECT_EQ((a_matrix - a_matrix.transpose()).cwiseAbs().maxCoeff(), 0.0);
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a_matrix).eigenvalues();
  const double largest = eigenvalues.maxCoeff();
  Worst worst;
  worst.see(std::min(0.0, eigenvalues.minCoeff()) / largest, "smallest");
  EXPECT_TRUE(worst.within(k_eigenvalue));
  // More contacts than the 6 freedoms of each brick leave at least the difference singular.
  const auto singular = (eigenvalues.array() < 1e-10 * largest).count();
  EXPECT_GE(singular, a_matrix.rows() - 6 * static_cast<Eigen::Index>(wall.bodies.size() - 1));
}

// Gravity and random forces and torques on all bricks, from a gentle push to several weights.
TEST(QpSolve, NeverCyclesOnWallsUnderRandomLoads) {
  RandomVectors random;
  Worst worst;
  int zero_steps = 0;
  int pivots = 0;
  for (const int size : {2, 3, 4, 5}) {
    Wall wall = wall_problem(size);
    for (int i = 0; i < 1000; ++i) {
      const double share = std::pow(10.0, -6.0 + 7.0 * (i % 100) / 99.0);
      for (RigidBody& body : wall.bodies) {
        const double weight_n = 9.81 * body.mass_kg;
        body.force_n = weight_n * (share * random.vector(3) - Eigen::Vector3d::UnitZ());
        body.torque_nm = 0.1 * weight_n * share * random.vector(3);
      }
      const Eigen::VectorXd b = compute_b_vector(wall.bodies, wall.contacts);
      const QpResult solved = qp_solve(wall.a_matrix, b);
      const std::string where = std::to_string(size) + ", load " + std::to_string(i);
      ASSERT_FALSE(solved.retried || solved.failed) << where;
      worst.see(solved.residual, where);
      zero_steps += solved.zero_steps;
      pivots += solved.pivots;
    }
  }
  EXPECT_LT(zero_steps, pivots / 100);
  EXPECT_TRUE(worst.within(k_solve_residual));
}

// 1140 contacts, of which at most 660 can be independent.
TEST(QpSolve, TenByTenWallTakesFewPivots) {
  Wall wall = wall_problem(10);
  for (RigidBody& body : wall.bodies) body.force_n = {0.0, 0.0, -9.81 * body.mass_kg};
  const QpResult solved = qp_solve(wall.a_matrix, compute_b_vector(wall.bodies, wall.contacts));
  EXPECT_FALSE(solved.retried);
  EXPECT_LT(solved.pivots, static_cast<int>(wall.contacts.size()));
  Worst worst;
  worst.see(solved.residual, "10x10");
  EXPECT_TRUE(worst.within(k_solve_residual));
}

TEST(QpSolve, SaysThatItFailedWhereAnInputIsNotFinite) {
  SparseMatrix one(1, 1);
  one.coeffRef(0, 0) = 1.0;
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    EXPECT_TRUE(qp_solve(one, Eigen::VectorXd::Constant(1, bad)).failed) << bad;
  }
}

}  // namespace
}  // namespace ourengine::baraff
