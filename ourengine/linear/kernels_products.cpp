#include <cstddef>
#include <cstring>

#include "ourengine/linear/kernels.hpp"
#include "ourengine/linear/kernels_simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ourengine/linear/kernels_products.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway demands.
#include "ourengine/linear/kernels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace ourengine::linear::HWY_NAMESPACE {

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

void fill_products(Kernels& kernels) {
  kernels.name = hwy::TargetName(HWY_TARGET);
  kernels.multiply_j = multiply_j;
  kernels.multiply_jt = multiply_jt;
  kernels.assemble_general = assemble_general;
}

}  // namespace ourengine::linear::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ourengine::linear {

HWY_EXPORT(fill_products);

void add_products(Kernels& kernels) { HWY_DYNAMIC_DISPATCH(fill_products)(kernels); }

}  // namespace ourengine::linear
#endif
