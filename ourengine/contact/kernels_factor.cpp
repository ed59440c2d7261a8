#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#include "ourengine/contact/kernels.hpp"
#include "ourengine/contact/kernels_simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ourengine/contact/kernels_factor.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway demands.
#include "ourengine/contact/kernels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace ourengine::linear::HWY_NAMESPACE {

// column - left * right^T, one column r of the product.
HWY_INLINE V subtract_product(const Columns& left, const double* right, V column) {
  const D d;
  column = hn::NegMulAdd(left.c0, hn::Set(d, right[0]), column);
  column = hn::NegMulAdd(left.c1, hn::Set(d, right[8]), column);
  column = hn::NegMulAdd(left.c2, hn::Set(d, right[16]), column);
  column = hn::NegMulAdd(left.c3, hn::Set(d, right[24]), column);
  column = hn::NegMulAdd(left.c4, hn::Set(d, right[32]), column);
  return hn::NegMulAdd(left.c5, hn::Set(d, right[40]), column);
}

HWY_INLINE void update_column(const Columns& left, const double* right, double* target, int r) {
  const D d;
  hn::Store(subtract_product(left, right + r, hn::Load(d, target + 8 * r)), d, target + 8 * r);
}

// target -= left * right^T for one block ...
HWY_INLINE void update(const double* left, const double* right, double* target) {
  for (std::size_t part = 0; part < 6; part += kLanes) {
    const Columns a = load_columns(left + part);
    double* t = target + part;
    update_column(a, right, t, 0);
    update_column(a, right, t, 1);
    update_column(a, right, t, 2);
    update_column(a, right, t, 3);
    update_column(a, right, t, 4);
    update_column(a, right, t, 5);
  }
}

HWY_INLINE void update_two_columns(const Columns& left1, const Columns& left2, const double* right,
                                   double* target1, double* target2, int r) {
  update_column(left1, right, target1, r);
  update_column(left2, right, target2, r);
}

// ... and for two consecutive blocks, which share the broadcasts of `right`.
HWY_INLINE void update_two(const double* left, const double* right, double* target1,
                           double* target2) {
  for (std::size_t part = 0; part < 6; part += kLanes) {
    const Columns a = load_columns(left + part), b = load_columns(left + kBlock + part);
    double *t = target1 + part, *u = target2 + part;
    update_two_columns(a, b, right, t, u, 0);
    update_two_columns(a, b, right, t, u, 1);
    update_two_columns(a, b, right, t, u, 2);
    update_two_columns(a, b, right, t, u, 3);
    update_two_columns(a, b, right, t, u, 4);
    update_two_columns(a, b, right, t, u, 5);
  }
}

// Cholesky of the diagonal block, replaced by the inverse of its factor (upper part zero).
HWY_INLINE bool invert_diagonal(double* block) {
  bool positive = true;
  double l[6][6], reciprocal[6], inverse[6][6] = {};
  for (int a = 0; a < 6; ++a) {
    double pivot = block[9 * a];
    for (int k = 0; k < a; ++k) pivot -= l[a][k] * l[a][k];
    if (!(pivot > 0.0)) {
      positive = false;
      pivot = std::numeric_limits<double>::max();
    }
    reciprocal[a] = 1.0 / std::sqrt(pivot);
    for (int b = a + 1; b < 6; ++b) {
      double sum = block[8 * a + b];
      for (int k = 0; k < a; ++k) sum -= l[b][k] * l[a][k];
      l[b][a] = sum * reciprocal[a];
    }
  }
  for (int c = 0; c < 6; ++c) {
    inverse[c][c] = reciprocal[c];
    for (int r = c + 1; r < 6; ++r) {
      double sum = 0.0;
      for (int k = c; k < r; ++k) sum -= l[r][k] * inverse[k][c];
      inverse[r][c] = sum * reciprocal[r];
    }
  }
  for (int c = 0; c < 6; ++c) {
    for (int r = 0; r < 6; ++r) block[8 * c + r] = inverse[r][c];
  }
  return positive;
}

// block <- block * inverse^T, with the lower-triangular inverse of the diagonal factor.
HWY_INLINE void scale_block(const double* inverse, double* block) {
  const D d;
  for (std::size_t part = 0; part < 6; part += kLanes) {
    const Columns a = load_columns(block + part);
    const V column[6] = {a.c0, a.c1, a.c2, a.c3, a.c4, a.c5};
    for (std::size_t r = 0; r < 6; ++r) {
      V sum = hn::Mul(column[0], hn::Set(d, inverse[r]));
      for (std::size_t k = 1; k <= r; ++k)
        sum = hn::MulAdd(column[k], hn::Set(d, inverse[8 * k + r]), sum);
      hn::Store(sum, d, block + 8 * r + part);
    }
  }
}

bool factor(const BlockPattern& pattern, int* block_of_row, double* blocks) {
  bool positive = true;
  const int* column_begin = pattern.column_begin.data();
  const int* row = pattern.row.data();
  for (int j = 0; j < pattern.columns; ++j) {
    const int begin = column_begin[j], end = column_begin[j + 1];
    for (int q = begin; q < end; ++q) block_of_row[row[q]] = q;
    for (int t = pattern.row_begin[at(j)]; t < pattern.row_begin[at(j + 1)]; ++t) {
      int q = pattern.row_block[at(t)];
      const double* right = blocks + kBlock * at(q);
      const int last = column_begin[pattern.row_column[at(t)] + 1];
      for (; q + 1 < last; q += 2) {
        update_two(blocks + kBlock * at(q), right, blocks + kBlock * at(block_of_row[row[q]]),
                   blocks + kBlock * at(block_of_row[row[q + 1]]));
      }
      if (q < last) {
        update(blocks + kBlock * at(q), right, blocks + kBlock * at(block_of_row[row[q]]));
      }
    }
    double* diagonal = blocks + kBlock * at(begin);
    positive = invert_diagonal(diagonal) && positive;
    for (int q = begin + 1; q < end; ++q) scale_block(diagonal, blocks + kBlock * at(q));
  }
  return positive;
}

HWY_INLINE void solve_forward(const BlockPattern& pattern, const double* blocks, double* x) {
  const D d;
  for (int j = 0; j < pattern.columns; ++j) {
    const int begin = pattern.column_begin[at(j)], end = pattern.column_begin[at(j + 1)];
    const double* inverse = blocks + kBlock * at(begin);
    double* own = x + kBodyStride * at(j);
    double y[6];
    std::memcpy(y, own, sizeof y);
    for (std::size_t part = 0; part < 6; part += kLanes) {
      V sum = hn::Mul(hn::Load(d, inverse + part), hn::Set(d, y[0]));
      for (std::size_t k = 1; k < 6; ++k)
        sum = hn::MulAdd(hn::Load(d, inverse + 8 * k + part), hn::Set(d, y[k]), sum);
      hn::Store(sum, d, own + part);
    }
    for (int q = begin + 1; q < end; ++q) {
      double* other = x + kBodyStride * at(pattern.row[at(q)]);
      for (std::size_t part = 0; part < 6; part += kLanes) {
        const Columns a = load_columns(blocks + kBlock * at(q) + part);
        V sum = hn::Load(d, other + part);
        sum = hn::NegMulAdd(a.c0, hn::Set(d, own[0]), sum);
        sum = hn::NegMulAdd(a.c1, hn::Set(d, own[1]), sum);
        sum = hn::NegMulAdd(a.c2, hn::Set(d, own[2]), sum);
        sum = hn::NegMulAdd(a.c3, hn::Set(d, own[3]), sum);
        sum = hn::NegMulAdd(a.c4, hn::Set(d, own[4]), sum);
        sum = hn::NegMulAdd(a.c5, hn::Set(d, own[5]), sum);
        hn::Store(sum, d, other + part);
      }
    }
  }
}

// lanes[8 c ..]: lane sums of (block column c) . x over the blocks below the diagonal of column j.
HWY_INLINE void sum_transposed(const BlockPattern& pattern, const double* blocks, const double* x,
                               int j, double* lanes) {
  const D d;
  for (std::size_t part = 0; part < 6; part += kLanes) {
    Columns sum = zero_columns();
    for (int q = pattern.column_begin[at(j)] + 1; q < pattern.column_begin[at(j + 1)]; ++q) {
      const Columns a = load_columns(blocks + kBlock * at(q) + part);
      const V other = hn::Load(d, x + kBodyStride * at(pattern.row[at(q)]) + part);
      sum.c0 = hn::MulAdd(a.c0, other, sum.c0);
      sum.c1 = hn::MulAdd(a.c1, other, sum.c1);
      sum.c2 = hn::MulAdd(a.c2, other, sum.c2);
      sum.c3 = hn::MulAdd(a.c3, other, sum.c3);
      sum.c4 = hn::MulAdd(a.c4, other, sum.c4);
      sum.c5 = hn::MulAdd(a.c5, other, sum.c5);
    }
    hn::Store(sum.c0, d, lanes + part);
    hn::Store(sum.c1, d, lanes + 8 + part);
    hn::Store(sum.c2, d, lanes + 16 + part);
    hn::Store(sum.c3, d, lanes + 24 + part);
    hn::Store(sum.c4, d, lanes + 32 + part);
    hn::Store(sum.c5, d, lanes + 40 + part);
  }
}

HWY_INLINE double sum_of_lanes(const double* l) {
  return ((l[0] + l[1]) + (l[2] + l[3])) + (l[4] + l[5]);
}

HWY_INLINE void solve_backward(const BlockPattern& pattern, const double* blocks, double* x) {
  HWY_ALIGN double lanes[kBlockSize];
  for (int j = pattern.columns - 1; j >= 0; --j) {
    double* own = x + kBodyStride * at(j);
    sum_transposed(pattern, blocks, x, j, lanes);
    double y[6];
    for (std::size_t c = 0; c < 6; ++c) y[c] = own[c] - sum_of_lanes(lanes + 8 * c);
    const double* inverse = blocks + kBlock * at(pattern.column_begin[at(j)]);
    for (std::size_t c = 0; c < 6; ++c) {
      double sum = 0.0;
      for (std::size_t r = c; r < 6; ++r) sum += inverse[8 * c + r] * y[r];
      own[c] = sum;
    }
  }
}

void solve(const BlockPattern& pattern, const double* blocks, double* x) {
  solve_forward(pattern, blocks, x);
  solve_backward(pattern, blocks, x);
}

// block <- block * diagonal, both general.
HWY_INLINE void multiply_block(const double* diagonal, double* block) {
  const D d;
  for (std::size_t part = 0; part < 6; part += kLanes) {
    const Columns a = load_columns(block + part);
    for (std::size_t c = 0; c < 6; ++c) {
      const double* right = diagonal + 8 * c;
      V sum = hn::Mul(a.c0, hn::Set(d, right[0]));
      sum = hn::MulAdd(a.c1, hn::Set(d, right[1]), sum);
      sum = hn::MulAdd(a.c2, hn::Set(d, right[2]), sum);
      sum = hn::MulAdd(a.c3, hn::Set(d, right[3]), sum);
      sum = hn::MulAdd(a.c4, hn::Set(d, right[4]), sum);
      sum = hn::MulAdd(a.c5, hn::Set(d, right[5]), sum);
      hn::Store(sum, d, block + 8 * c + part);
    }
  }
}

// Updates with a descendant column: target -= left * right^T for its blocks from q to `last`.
HWY_INLINE void update_from(const BlockPattern& pattern, const int* block_of_row,
                            const double* left, const double* right, double* target, int q,
                            int last) {
  const int* row = pattern.row.data();
  for (; q + 1 < last; q += 2) {
    update_two(left + kBlock * at(q), right, target + kBlock * at(block_of_row[row[q]]),
               target + kBlock * at(block_of_row[row[q + 1]]));
  }
  if (q < last) update(left + kBlock * at(q), right, target + kBlock * at(block_of_row[row[q]]));
}

bool factor_general(const BlockPattern& pattern, int* block_of_row, double* lower, double* upper) {
  bool regular = true;
  for (int j = 0; j < pattern.columns; ++j) {
    const int begin = pattern.column_begin[at(j)], end = pattern.column_begin[at(j + 1)];
    for (int q = begin; q < end; ++q) block_of_row[pattern.row[at(q)]] = q;
    for (int t = pattern.row_begin[at(j)]; t < pattern.row_begin[at(j + 1)]; ++t) {
      const int q = pattern.row_block[at(t)];
      const int last = pattern.column_begin[at(pattern.row_column[at(t)] + 1)];
      const double *l = lower + kBlock * at(q), *u = upper + kBlock * at(q);
      update_from(pattern, block_of_row, lower, u, lower, q, last);
      update_from(pattern, block_of_row, upper, l, upper, q + 1, last);
    }
    double* diagonal = lower + kBlock * at(begin);
    regular = invert_general_block(diagonal) && regular;
    for (int q = begin + 1; q < end; ++q) multiply_block(diagonal, lower + kBlock * at(q));
  }
  return regular;
}

// target -= block * x
HWY_INLINE void subtract_block_vector(const double* block, const double* x, double* target) {
  const D d;
  for (std::size_t part = 0; part < 6; part += kLanes) {
    const Columns a = load_columns(block + part);
    V sum = hn::Load(d, target + part);
    sum = hn::NegMulAdd(a.c0, hn::Set(d, x[0]), sum);
    sum = hn::NegMulAdd(a.c1, hn::Set(d, x[1]), sum);
    sum = hn::NegMulAdd(a.c2, hn::Set(d, x[2]), sum);
    sum = hn::NegMulAdd(a.c3, hn::Set(d, x[3]), sum);
    sum = hn::NegMulAdd(a.c4, hn::Set(d, x[4]), sum);
    sum = hn::NegMulAdd(a.c5, hn::Set(d, x[5]), sum);
    hn::Store(sum, d, target + part);
  }
}

void solve_general(const BlockPattern& pattern, const double* lower, const double* upper,
                   double* x) {
  for (int j = 0; j < pattern.columns; ++j) {
    for (int q = pattern.column_begin[at(j)] + 1; q < pattern.column_begin[at(j + 1)]; ++q) {
      subtract_block_vector(lower + kBlock * at(q), x + kBodyStride * at(j),
                            x + kBodyStride * at(pattern.row[at(q)]));
    }
  }
  HWY_ALIGN double lanes[kBlockSize];
  HWY_ALIGN double y[kBodyStride];
  for (int j = pattern.columns - 1; j >= 0; --j) {
    double* own = x + kBodyStride * at(j);
    sum_transposed(pattern, upper, x, j, lanes);
    for (std::size_t c = 0; c < 6; ++c) y[c] = -(own[c] - sum_of_lanes(lanes + 8 * c));
    std::memset(own, 0, kBodyStride * sizeof(double));
    subtract_block_vector(lower + kBlock * at(pattern.column_begin[at(j)]), y, own);
  }
}

void fill_factorisations(Kernels& kernels) {
  kernels.factor = factor;
  kernels.solve = solve;
  kernels.factor_general = factor_general;
  kernels.solve_general = solve_general;
}

}  // namespace ourengine::linear::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ourengine::linear {

HWY_EXPORT(fill_factorisations);

void add_factorisations(Kernels& kernels) { HWY_DYNAMIC_DISPATCH(fill_factorisations)(kernels); }

}  // namespace ourengine::linear
#endif
