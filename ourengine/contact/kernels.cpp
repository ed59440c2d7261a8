#include "ourengine/contact/kernels.hpp"

#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ourengine/contact/kernels.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway demands.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ourengine::linear::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Six rows of a block, in one, two or three vectors; each lane is its own sum, so that AVX2 and
// AVX-512 give the same bits.
constexpr std::size_t kLanes = HWY_MAX_BYTES >= 64 ? 8 : HWY_MAX_BYTES / 8;
using D = hn::FixedTag<double, kLanes>;
using V = hn::Vec<D>;
constexpr std::size_t kBlock = kBlockSize;

HWY_INLINE std::size_t at(int i) { return static_cast<std::size_t>(i); }

// Relative velocity of the contact points of `kLanes` contacts from i on, component c of x, y, z.
HWY_INLINE void relative_velocity(const SystemView& s, const double* v, std::size_t i, V out[3]) {
  const D d;
  const hn::RebindToSigned<D> di;
  const std::size_t n = at(s.stride);
  const auto a = hn::Load(di, s.offset_a + i);
  const auto b = hn::Load(di, s.offset_b + i);
  V arm_a[3], arm_b[3], spin_a[3], spin_b[3];
  for (std::size_t c = 0; c < 3; ++c) {
    out[c] = hn::Sub(hn::GatherIndex(d, v + c, b), hn::GatherIndex(d, v + c, a));
    spin_a[c] = hn::GatherIndex(d, v + 3 + c, a);
    spin_b[c] = hn::GatherIndex(d, v + 3 + c, b);
    arm_a[c] = hn::Load(d, s.geometry + (9 + c) * n + i);
    arm_b[c] = hn::Load(d, s.geometry + (12 + c) * n + i);
  }
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t e = (c + 1) % 3, f = (c + 2) % 3;
    out[c] = hn::MulAdd(spin_b[e], arm_b[f], out[c]);
    out[c] = hn::NegMulAdd(spin_b[f], arm_b[e], out[c]);
    out[c] = hn::NegMulAdd(spin_a[e], arm_a[f], out[c]);
    out[c] = hn::MulAdd(spin_a[f], arm_a[e], out[c]);
  }
}

void multiply_j(const SystemView& s, const double* v, bool with_bias, double* w) {
  const D d;
  const std::size_t n = at(s.stride);
  for (std::size_t i = 0; i < n; i += kLanes) {
    V u[3];
    relative_velocity(s, v, i, u);
    for (std::size_t k = 0; k < at(s.components); ++k) {
      V sum = hn::Zero(d);
      if (with_bias) sum = hn::Load(d, k == 0 ? s.bias + i : s.tangent_bias + (k - 1) * n + i);
      for (std::size_t c = 0; c < 3; ++c)
        sum = hn::MulAdd(hn::Load(d, s.geometry + (3 * k + c) * n + i), u[c], sum);
      hn::Store(sum, d, w + k * n + i);
    }
  }
}

template <int kComponents>
HWY_INLINE void multiply_jt_rows(const SystemView& s, const double* f, double* g) {
  const D d;
  const std::size_t n = at(s.stride);
  for (int p = 0; p < s.pair_count; ++p) {
    const ContactPair& pair = s.pairs[p];
    for (std::size_t part = 0; part < 6; part += kLanes) {
      double* ga = g + kBodyStride * at(pair.body_a) + part;
      double* gb = g + kBodyStride * at(pair.body_b) + part;
      V sum_a = hn::Load(d, ga), sum_b = hn::Load(d, gb);
      const double* row = s.rows + 16 * at(kComponents) * at(pair.begin) + part;
      for (std::size_t i = at(pair.begin); i < at(pair.end); ++i) {
        for (std::size_t k = 0; k < kComponents; ++k, row += 16) {
          const V impulse = hn::Set(d, f[k * n + i]);
          sum_a = hn::MulAdd(impulse, hn::Load(d, row), sum_a);
          sum_b = hn::MulAdd(impulse, hn::Load(d, row + 8), sum_b);
        }
      }
      hn::Store(sum_a, d, ga);
      hn::Store(sum_b, d, gb);
    }
  }
}

void multiply_jt(const SystemView& s, const double* f, double* g) {
  if (s.components == 1)
    multiply_jt_rows<1>(s, f, g);
  else
    multiply_jt_rows<3>(s, f, g);
}

// Six columns of one 6x6 block, `kLanes` rows of them.
struct Columns {
  V c0, c1, c2, c3, c4, c5;
};

HWY_INLINE Columns zero_columns() {
  const V z = hn::Zero(D());
  return {z, z, z, z, z, z};
}

HWY_INLINE Columns load_columns(const double* block) {
  const D d;
  return {hn::Load(d, block),      hn::Load(d, block + 8),  hn::Load(d, block + 16),
          hn::Load(d, block + 24), hn::Load(d, block + 32), hn::Load(d, block + 40)};
}

HWY_INLINE void add_columns(const Columns& c, double* block) {
  const D d;
  hn::Store(hn::Add(hn::Load(d, block), c.c0), d, block);
  hn::Store(hn::Add(hn::Load(d, block + 8), c.c1), d, block + 8);
  hn::Store(hn::Add(hn::Load(d, block + 16), c.c2), d, block + 16);
  hn::Store(hn::Add(hn::Load(d, block + 24), c.c3), d, block + 24);
  hn::Store(hn::Add(hn::Load(d, block + 32), c.c4), d, block + 32);
  hn::Store(hn::Add(hn::Load(d, block + 40), c.c5), d, block + 40);
}

HWY_INLINE void add_outer(const V left, const double* scaled, Columns& c) {
  const D d;
  c.c0 = hn::MulAdd(left, hn::Set(d, scaled[0]), c.c0);
  c.c1 = hn::MulAdd(left, hn::Set(d, scaled[1]), c.c1);
  c.c2 = hn::MulAdd(left, hn::Set(d, scaled[2]), c.c2);
  c.c3 = hn::MulAdd(left, hn::Set(d, scaled[3]), c.c3);
  c.c4 = hn::MulAdd(left, hn::Set(d, scaled[4]), c.c4);
  c.c5 = hn::MulAdd(left, hn::Set(d, scaled[5]), c.c5);
}

// scaled rows of one contact: scaled[k] = sum_l D_kl row_l, 16 doubles each.
template <int kComponents>
HWY_INLINE void scale_rows(const double* rows, const double* d, std::size_t n, std::size_t i,
                           double* scaled) {
  const D tag;
  for (std::size_t part = 0; part < 16; part += kLanes) {
    if constexpr (kComponents == 1) {
      hn::Store(hn::Mul(hn::Set(tag, d[i]), hn::Load(tag, rows + part)), tag, scaled + part);
    } else {
      const V r0 = hn::Load(tag, rows + part), r1 = hn::Load(tag, rows + 16 + part),
              r2 = hn::Load(tag, rows + 32 + part);
      const V d01 = hn::Set(tag, d[n + i]), d02 = hn::Set(tag, d[2 * n + i]),
              d12 = hn::Set(tag, d[4 * n + i]);
      const V s0 = hn::MulAdd(d02, r2, hn::MulAdd(d01, r1, hn::Mul(hn::Set(tag, d[i]), r0)));
      const V s1 =
          hn::MulAdd(d12, r2, hn::MulAdd(hn::Set(tag, d[3 * n + i]), r1, hn::Mul(d01, r0)));
      const V s2 =
          hn::MulAdd(hn::Set(tag, d[5 * n + i]), r2, hn::MulAdd(d12, r1, hn::Mul(d02, r0)));
      hn::Store(s0, tag, scaled + part);
      hn::Store(s1, tag, scaled + 16 + part);
      hn::Store(s2, tag, scaled + 32 + part);
    }
  }
}

template <int kComponents>
HWY_INLINE void assemble_pair(const SystemView& s, const double* d, const ContactPair& pair,
                              const PairTarget& target, double* blocks) {
  const D tag;
  const std::size_t n = at(s.stride);
  HWY_ALIGN double scaled[16 * kComponents];
  for (std::size_t part = 0; part < 6; part += kLanes) {
    Columns aa = zero_columns(), bb = zero_columns(), ab = zero_columns();
    bool loaded = false;
    for (std::size_t i = at(pair.begin); i < at(pair.end); ++i) {
      const double* rows = s.rows + 16 * at(kComponents) * i;
      if (d[i] == 0.0 && (kComponents == 1 || (d[3 * n + i] == 0.0 && d[5 * n + i] == 0.0)))
        continue;
      loaded = true;
      scale_rows<kComponents>(rows, d, n, i, scaled);
      for (std::size_t k = 0; k < kComponents; ++k) {
        const V left_a = hn::Load(tag, rows + 16 * k + part);
        const V left_b = hn::Load(tag, rows + 16 * k + 8 + part);
        if (target.diagonal_a >= 0) add_outer(left_a, scaled + 16 * k, aa);
        if (target.diagonal_b >= 0) add_outer(left_b, scaled + 16 * k + 8, bb);
        if (target.off_diagonal < 0) continue;
        if (target.a_below)
          add_outer(left_a, scaled + 16 * k + 8, ab);
        else
          add_outer(left_b, scaled + 16 * k, ab);
      }
    }
    if (!loaded) return;
    if (target.diagonal_a >= 0) add_columns(aa, blocks + kBlock * at(target.diagonal_a) + part);
    if (target.diagonal_b >= 0) add_columns(bb, blocks + kBlock * at(target.diagonal_b) + part);
    if (target.off_diagonal >= 0) add_columns(ab, blocks + kBlock * at(target.off_diagonal) + part);
  }
}

void assemble(const SystemView& s, const double* d, const PairTarget* targets,
              const BlockPattern& pattern, double* blocks) {
  std::memset(blocks, 0, kBlock * pattern.row.size() * sizeof(double));
  for (int j = 0; j < s.bodies; ++j) {
    std::memcpy(blocks + kBlock * at(pattern.column_begin[at(j)]), s.mass + kBlock * at(j),
                kBlock * sizeof(double));
  }
  for (int p = 0; p < s.pair_count; ++p) {
    if (s.components == 1)
      assemble_pair<1>(s, d, s.pairs[p], targets[p], blocks);
    else
      assemble_pair<3>(s, d, s.pairs[p], targets[p], blocks);
  }
}

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

// scaled[k] = sum_l D_kl row_l for weights that are not symmetric.
HWY_INLINE void scale_rows_general(const double* rows, const double* d, std::size_t n,
                                   std::size_t i, double* scaled) {
  const D tag;
  for (std::size_t part = 0; part < 16; part += kLanes) {
    const V r0 = hn::Load(tag, rows + part), r1 = hn::Load(tag, rows + 16 + part),
            r2 = hn::Load(tag, rows + 32 + part);
    for (std::size_t k = 0; k < 3; ++k) {
      V sum = hn::Mul(hn::Set(tag, d[3 * k * n + i]), r0);
      sum = hn::MulAdd(hn::Set(tag, d[(3 * k + 1) * n + i]), r1, sum);
      sum = hn::MulAdd(hn::Set(tag, d[(3 * k + 2) * n + i]), r2, sum);
      hn::Store(sum, tag, scaled + 16 * k + part);
    }
  }
}

HWY_INLINE void assemble_pair_general(const SystemView& s, const double* d, const ContactPair& pair,
                                      const PairTarget& target, double* lower, double* upper) {
  const D tag;
  const std::size_t n = at(s.stride);
  HWY_ALIGN double scaled[48];
  for (std::size_t part = 0; part < 6; part += kLanes) {
    Columns aa = zero_columns(), bb = aa, below = aa, right = aa;
    for (std::size_t i = at(pair.begin); i < at(pair.end); ++i) {
      if (d[i] == 0.0 && d[4 * n + i] == 0.0 && d[8 * n + i] == 0.0) continue;
      const double* rows = s.rows + 48 * i;
      scale_rows_general(rows, d, n, i, scaled);
      for (std::size_t k = 0; k < 3; ++k) {
        const double *row_a = rows + 16 * k, *row_b = row_a + 8;
        const double *scaled_a = scaled + 16 * k, *scaled_b = scaled_a + 8;
        if (target.diagonal_a >= 0) add_outer(hn::Load(tag, row_a + part), scaled_a, aa);
        if (target.diagonal_b >= 0) add_outer(hn::Load(tag, row_b + part), scaled_b, bb);
        if (target.off_diagonal < 0) continue;
        if (target.a_below) {
          add_outer(hn::Load(tag, row_a + part), scaled_b, below);
          add_outer(hn::Load(tag, scaled_a + part), row_b, right);
        } else {
          add_outer(hn::Load(tag, row_b + part), scaled_a, below);
          add_outer(hn::Load(tag, scaled_b + part), row_a, right);
        }
      }
    }
    if (target.diagonal_a >= 0) add_columns(aa, lower + kBlock * at(target.diagonal_a) + part);
    if (target.diagonal_b >= 0) add_columns(bb, lower + kBlock * at(target.diagonal_b) + part);
    if (target.off_diagonal < 0) continue;
    add_columns(below, lower + kBlock * at(target.off_diagonal) + part);
    add_columns(right, upper + kBlock * at(target.off_diagonal) + part);
  }
}

void assemble_general(const SystemView& s, const double* d, const PairTarget* targets,
                      const BlockPattern& pattern, double* lower, double* upper) {
  std::memset(lower, 0, kBlock * pattern.row.size() * sizeof(double));
  std::memset(upper, 0, kBlock * pattern.row.size() * sizeof(double));
  for (int j = 0; j < s.bodies; ++j) {
    std::memcpy(lower + kBlock * at(pattern.column_begin[at(j)]), s.mass + kBlock * at(j),
                kBlock * sizeof(double));
  }
  for (int p = 0; p < s.pair_count; ++p)
    assemble_pair_general(s, d, s.pairs[p], targets[p], lower, upper);
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

Kernels kernels() {
  return {hwy::TargetName(HWY_TARGET),
          multiply_j,
          multiply_jt,
          assemble,
          factor,
          solve,
          assemble_general,
          factor_general,
          solve_general};
}

}  // namespace ourengine::linear::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ourengine {

namespace linear {
HWY_EXPORT(kernels);
Kernels best() { return HWY_DYNAMIC_DISPATCH(kernels)(); }
}  // namespace linear

const Kernels& simd_kernels() {
  static const Kernels chosen = linear::best();
  return chosen;
}

}  // namespace ourengine
#endif
