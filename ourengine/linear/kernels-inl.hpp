// Per-target vocabulary of the SIMD kernels: included once per instruction set (Highway).
#if defined(OURENGINE_CONTACT_KERNELS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef OURENGINE_CONTACT_KERNELS_INL_HPP
#undef OURENGINE_CONTACT_KERNELS_INL_HPP
#else
#define OURENGINE_CONTACT_KERNELS_INL_HPP
#endif

#include <hwy/highway.h>

#include <cstddef>

#include "ourengine/linear/kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace ourengine::linear::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Six rows of a block, in one, two, three or six vectors. Each lane is its own sum and every
// product is fused into its sum on AVX2 and AVX-512 alike, so that those two give the same bits.
constexpr std::size_t kLanes = HWY_MAX_BYTES >= 64 ? 8 : HWY_MAX_BYTES / 8;
using D = hn::FixedTag<double, kLanes>;
using V = hn::Vec<D>;
constexpr std::size_t kBlock = kBlockSize;

HWY_INLINE std::size_t at(int i) { return static_cast<std::size_t>(i); }

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

// Rows of one contact towards one body, weighted: scaled[8 k ..] = sum_l D_kl row_l.
template <int kComponents>
HWY_INLINE void scale_rows(const double* rows, const double* d, std::size_t n, std::size_t i,
                           double* scaled) {
  const D tag;
  for (std::size_t part = 0; part < 6; part += kLanes) {
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
      hn::Store(s1, tag, scaled + 8 + part);
      hn::Store(s2, tag, scaled + 16 + part);
    }
  }
}

}  // namespace ourengine::linear::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
