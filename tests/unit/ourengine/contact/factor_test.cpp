// The block factorisations and products against dense Eigen, for both implementations.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "ourengine/contact/system.hpp"
#include "ourengine/linear/block_cholesky.hpp"
#include "ourengine/linear/block_lu.hpp"
#include "tests/support/contact_walls.hpp"
#include "tests/support/tolerance.hpp"
#include "tests/unit/ourengine/contact/small_problems.hpp"

namespace brickbench::testing {
namespace {

using ourengine::AlignedDoubles;
using ourengine::BlockCholesky;
using ourengine::BlockLu;
using ourengine::ContactSystem;
using ourengine::Kernels;
using ourengine::SymbolicCache;

constexpr Tolerance kProducts{"J v and J^T f against dense products", 2e-14, 2.7e-15,
                              "rounding of a dozen terms of size 1"};
constexpr Tolerance kSolve{"block solve against dense LU", 5e-12, 6.9e-13,
                           "condition number of H (some 1e2) times rounding"};

constexpr Tolerance kEquation{"H x - b", 1e-12, 6e-14, "rounding of H, whose entries are some 1e2"};

struct Dense {
  Eigen::MatrixXd j, mass;
};

std::size_t at(int i) { return static_cast<std::size_t>(i); }

Dense dense(const ContactSystem& system) {
  const auto& view = system.view();
  Dense d{Eigen::MatrixXd::Zero(system.components() * system.contacts(), 6 * system.bodies()),
          Eigen::MatrixXd::Zero(6 * system.bodies(), 6 * system.bodies())};
  for (int i = 0; i < system.contacts(); ++i) {
    for (int k = 0; k < system.components(); ++k) {
      const int row = system.components() * i + k;
      const double* entries = view.rows + 16 * at(row);
      for (int c = 0; c < 6; ++c) {
        const int a = static_cast<int>(view.offset_a[i] / 8),
                  b = static_cast<int>(view.offset_b[i] / 8);
        if (a < system.bodies()) d.j(row, 6 * a + c) += entries[c];
        if (b < system.bodies()) d.j(row, 6 * b + c) += entries[8 + c];
      }
    }
  }
  for (int body = 0; body < system.bodies(); ++body) {
    for (int r = 0; r < 6; ++r) {
      for (int c = 0; c < 6; ++c)
        d.mass(6 * body + r, 6 * body + c) = view.mass[48 * at(body) + at(8 * c + r)];
    }
  }
  return d;
}

class Factor : public ::testing::TestWithParam<const Kernels*> {
 protected:
  const Kernels& kernels() const { return *GetParam(); }

  AlignedDoubles body_vector(const ContactSystem& system) {
    AlignedDoubles x(system.body_doubles(), 0.0);
    for (int i = 0; i < system.bodies(); ++i) {
      for (int c = 0; c < 6; ++c) x[at(8 * i + c)] = normal_(random_);
    }
    return x;
  }
  static Eigen::VectorXd packed(const ContactSystem& system, const AlignedDoubles& x) {
    Eigen::VectorXd y(6 * system.bodies());
    for (int i = 0; i < system.bodies(); ++i) {
      for (int c = 0; c < 6; ++c) y[6 * i + c] = x[at(8 * i + c)];
    }
    return y;
  }

  std::mt19937 random_{7};
  std::normal_distribution<double> normal_;
};

ContactProblem wall(double friction) { return make_wall({3, 4, WallState::kImpact, friction}); }

TEST_P(Factor, ProductsWithTheJacobian) {
  Worst worst;
  for (const int components : {1, 3}) {
    SymbolicCache cache;
    const ContactSystem system(wall(0.5), components, cache);
    const Dense d = dense(system);
    const AlignedDoubles v = body_vector(system);
    AlignedDoubles w(system.rows());
    kernels().multiply_j(system.view(), v.data(), false, w.data());
    const Eigen::VectorXd expected = d.j * packed(system, v);
    AlignedDoubles f(system.rows(), 0.0), g(system.body_doubles(), 0.0);
    Eigen::VectorXd dense_f(expected.size());
    for (int i = 0; i < system.contacts(); ++i) {
      for (int k = 0; k < components; ++k) {
        const std::size_t slot = at(k) * system.stride() + at(i);
        worst.see(w[slot] - expected[components * i + k], "J v");
        dense_f[components * i + k] = f[slot] = normal_(random_);
      }
    }
    kernels().multiply_jt(system.view(), f.data(), g.data());
    worst.see((packed(system, g) - d.j.transpose() * dense_f).cwiseAbs().maxCoeff(), "J^T f");
  }
  EXPECT_TRUE(worst.within(kProducts));
}

TEST_P(Factor, CholeskyAgainstDense) {
  Worst worst;
  for (const int components : {1, 3}) {
    SymbolicCache cache;
    const ContactSystem system(wall(0.5), components, cache);
    const Dense d = dense(system);
    AlignedDoubles weights((components == 1 ? 1 : 6) * system.stride(), 0.0);
    Eigen::MatrixXd h = d.mass;
    for (int i = 0; i < system.contacts(); ++i) {
      if (i % 5 == 0) continue;  // contacts without weight
      Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(
          components, components, [&](Eigen::Index, Eigen::Index) { return normal_(random_); });
      const Eigen::MatrixXd weight = root * root.transpose();
      const auto rows = d.j.middleRows(components * i, components);
      h += rows.transpose() * weight * rows;
      int slot = 0;
      for (int k = 0; k < components; ++k) {
        for (int l = k; l < components; ++l)
          weights[at(slot++) * system.stride() + at(i)] = weight(k, l);
      }
    }
    BlockCholesky cholesky(kernels());
    ASSERT_TRUE(cholesky.factor(system.view(), system.fronts(), weights));
    AlignedDoubles x = body_vector(system);
    const Eigen::VectorXd expected = h.partialPivLu().solve(packed(system, x));
    cholesky.solve(x);
    worst.see((packed(system, x) - expected).cwiseAbs().maxCoeff(),
              std::to_string(components) + " components");
  }
  EXPECT_TRUE(worst.within(kSolve));
}

// H x = b on walls large enough for fronts of many columns, deep trees and nested dissection.
TEST_P(Factor, CholeskySolvesLargeWalls) {
  Worst worst;
  for (const int size : {14, 32}) {
    if (size > 14 && &kernels() == &ourengine::scalar_kernels()) continue;  // takes seconds
    SymbolicCache cache;
    const ContactSystem system(make_wall({size, size, WallState::kImpact}), 1, cache);
    AlignedDoubles weights(system.stride(), 0.0);
    for (int i = 0; i < system.contacts(); ++i) weights[at(i)] = std::exp(normal_(random_));
    BlockCholesky cholesky(kernels());
    ASSERT_TRUE(cholesky.factor(system.view(), system.fronts(), weights));
    const AlignedDoubles b = body_vector(system);
    AlignedDoubles x = b, product, w(system.rows());
    cholesky.solve(x);
    system.multiply_mass(x, product);
    kernels().multiply_j(system.view(), x.data(), false, w.data());
    for (int i = 0; i < system.contacts(); ++i) w[at(i)] *= weights[at(i)];
    kernels().multiply_jt(system.view(), w.data(), product.data());
    worst.see((packed(system, product) - packed(system, b)).cwiseAbs().maxCoeff(),
              std::to_string(size) + " courses");
  }
  EXPECT_TRUE(worst.within(kEquation));
}

TEST_P(Factor, LuAgainstDense) {
  SymbolicCache cache;
  const ContactSystem system(wall(0.5), 3, cache);
  const Dense d = dense(system);
  AlignedDoubles weights(9 * system.stride(), 0.0);
  Eigen::MatrixXd h = d.mass;
  for (int i = 0; i < system.contacts(); ++i) {
    Eigen::Matrix3d weight = 3.0 * Eigen::Matrix3d::Identity();
    for (int k = 0; k < 9; ++k) weight(k / 3, k % 3) += normal_(random_);
    const auto rows = d.j.middleRows(3 * i, 3);
    h += rows.transpose() * weight * rows;
    for (int k = 0; k < 9; ++k) weights[at(k) * system.stride() + at(i)] = weight(k / 3, k % 3);
  }
  BlockLu lu(kernels());
  ASSERT_TRUE(lu.factor(system.view(), system.targets(), system.symbolic().pattern, weights));
  AlignedDoubles x = body_vector(system);
  const Eigen::VectorXd expected = h.partialPivLu().solve(packed(system, x));
  lu.solve(x);
  Worst worst;
  worst.see((packed(system, x) - expected).cwiseAbs().maxCoeff(), "LU");
  EXPECT_TRUE(worst.within(kSolve));
}

// H = M + J^T D J with a large negative weight is not positive definite.
TEST_P(Factor, CholeskyReportsAnIndefiniteMatrix) {
  SymbolicCache cache;
  const ContactSystem system(wall(0.0), 1, cache);
  AlignedDoubles weights(system.stride(), 0.0);
  weights[0] = -1e4;
  BlockCholesky cholesky(kernels());
  EXPECT_FALSE(cholesky.factor(system.view(), system.fronts(), weights));
}

INSTANTIATE_TEST_SUITE_P(
    Both, Factor, ::testing::Values(&ourengine::simd_kernels(), &ourengine::scalar_kernels()),
    [](const auto& info) {
      return std::string(info.param == &ourengine::scalar_kernels() ? "scalar" : "simd");
    });

// Every body has one place, and both orderings (minimum degree, nested dissection) keep the fill of
// a wall's factor near the O(n log n) of planar graphs, far below the n^2 / 2 of a full factor.
TEST(Ordering, PermutesAndKeepsFillLow) {
  for (const int size : {12, 32}) {
    SymbolicCache cache;
    const ContactSystem system(make_wall({size, size}), 1, cache);
    std::vector<int> position = system.symbolic().position;
    const int bodies = static_cast<int>(position.size());
    std::sort(position.begin(), position.end());
    for (int i = 0; i < bodies; ++i) ASSERT_EQ(position[at(i)], i);
    const double blocks = static_cast<double>(system.symbolic().pattern.row.size());
    EXPECT_LT(blocks, 2.0 * bodies * std::log2(bodies)) << bodies;
  }
}

// Fronts cover the factor of the single columns, with few zeros, and each row of a front that is
// not eliminated there has its place in the parent.
TEST(Ordering, FrontsHoldTheFactor) {
  SymbolicCache cache;
  const ContactSystem system(make_wall({20, 20}), 1, cache);
  const auto& pattern = system.symbolic().pattern;
  const auto& fronts = system.symbolic().fronts;
  std::size_t stored = 0;
  for (const auto& front : fronts.front) {
    const int* row = fronts.row.data() + front.row_begin;
    for (int c = 0; c < front.columns; ++c) {
      stored += at(front.rows - c);
      const int begin = pattern.column_begin[at(front.first + c)];
      const int end = pattern.column_begin[at(front.first + c + 1)];
      ASSERT_TRUE(std::includes(row + c, row + front.rows, pattern.row.begin() + begin,
                                pattern.row.begin() + end))
          << front.first + c;
    }
    int placed = 0;
    for (int q = front.run_begin; q < front.run_end; ++q) placed += fronts.run[at(q)].length;
    ASSERT_EQ(placed, front.rows - front.columns) << front.first;
  }
  EXPECT_LT(static_cast<double>(stored), 1.15 * static_cast<double>(pattern.row.size()));
}

TEST(Ordering, AnUnchangedGraphIsAnalysedOnce) {
  SymbolicCache cache;
  const ContactSystem first(make_wall({4, 4, WallState::kRest, 0.0, true, 1}), 1, cache);
  const ContactSystem second(make_wall({4, 4, WallState::kRest, 0.0, true, 2}), 1, cache);
  EXPECT_EQ(cache.analyses(), 1);
  const ContactSystem third(make_wall({4, 5}), 1, cache);
  EXPECT_EQ(cache.analyses(), 2);
}

}  // namespace
}  // namespace brickbench::testing
