#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#include "ourengine/linear/kernels.hpp"
#include "ourengine/linear/kernels_simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ourengine/linear/kernels_lu.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway demands.
#include "ourengine/linear/kernels-inl.hpp"

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
