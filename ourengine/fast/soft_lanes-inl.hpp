// What the SIMD passes over soft contacts share: three-vectors of lanes, and bodies to and from
// them. Included once per processor target by Highway's foreach_target.
#if defined(OURENGINE_SOFT_LANES_INL_HPP_) == defined(HWY_TARGET_TOGGLE)
#ifdef OURENGINE_SOFT_LANES_INL_HPP_
#undef OURENGINE_SOFT_LANES_INL_HPP_
#else
#define OURENGINE_SOFT_LANES_INL_HPP_
#endif

#include <hwy/highway.h>

#include "ourengine/fast/soft_batch.hpp"

HWY_BEFORE_NAMESPACE();
namespace ourengine {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, k_lanes>;
using V = hn::Vec<D>;

struct Vector {
  V x, y, z;
};

HWY_INLINE V load(const Lane& lane, std::size_t i) { return hn::LoadU(D(), lane.data() + i); }
HWY_INLINE Vector load(const Lane3& lane, std::size_t i) {
  return {load(lane[0], i), load(lane[1], i), load(lane[2], i)};
}
HWY_INLINE void store(V value, Lane& lane, std::size_t i) {
  hn::StoreU(value, D(), lane.data() + i);
}

HWY_INLINE V dot(const Vector& a, const Vector& b) {
  return hn::MulAdd(a.z, b.z, hn::MulAdd(a.y, b.y, hn::Mul(a.x, b.x)));
}
HWY_INLINE Vector minus(const Vector& a, const Vector& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE void add(Vector& a, const Vector& b, V scale) {
  a.x = hn::MulAdd(b.x, scale, a.x);
  a.y = hn::MulAdd(b.y, scale, a.y);
  a.z = hn::MulAdd(b.z, scale, a.z);
}

struct Pair {
  Vector linear_a, angular_a, linear_b, angular_b;
};

// Bodies' vectors turned into one vector register per component, and back. Reading whole bodies and
// transposing 4x4 blocks takes a third of the time of gathering components.
constexpr std::size_t k_native = hn::MaxLanes(D());

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE Vector gather_part(const SoftVector* from, const std::int32_t* body,
                              std::size_t offset) {
  const SoftVector& v = from[*body];
  return {hn::Set(D(), v[offset]), hn::Set(D(), v[offset + 1]), hn::Set(D(), v[offset + 2])};
}

HWY_INLINE void scatter_part(SoftVector* to, const std::int32_t* body, std::int32_t rest,
                             const Vector& part, std::size_t offset) {
  if (*body == rest) return;
  to[*body][offset] = hn::GetLane(part.x);
  to[*body][offset + 1] = hn::GetLane(part.y);
  to[*body][offset + 2] = hn::GetLane(part.z);
}

#else

static_assert(k_native == 4 || k_native == 8 || k_native == 16);

// Four floats of body[k], in the next block those of body[k + 4], and so on.
template <typename Block>
HWY_INLINE hn::Vec<Block> load_row(Block d, const SoftVector* from, const std::int32_t* body,
                                   std::size_t k, std::size_t offset) {
  if constexpr (hn::MaxLanes(Block()) == 4) {
    return hn::LoadU(d, from[body[k]].data() + offset);
  } else {
    const hn::Half<Block> half;
    return hn::Combine(d, load_row(half, from, body, k + hn::MaxLanes(half), offset),
                       load_row(half, from, body, k, offset));
  }
}

HWY_INLINE Vector gather_part(const SoftVector* from, const std::int32_t* body,
                              std::size_t offset) {
  const D d;
  const V a = load_row(d, from, body, 0, offset), b = load_row(d, from, body, 1, offset);
  const V c = load_row(d, from, body, 2, offset), e = load_row(d, from, body, 3, offset);
  const V ac = hn::InterleaveLower(d, a, c), be = hn::InterleaveLower(d, b, e);
  return {hn::InterleaveLower(d, ac, be), hn::InterleaveUpper(d, ac, be),
          hn::InterleaveLower(d, hn::InterleaveUpper(d, a, c), hn::InterleaveUpper(d, b, e))};
}

template <typename Block>
HWY_INLINE void store_row(Block d, hn::Vec<Block> row, SoftVector* to, const std::int32_t* body,
                          std::size_t k, std::int32_t rest, std::size_t offset) {
  if constexpr (hn::MaxLanes(Block()) == 4) {
    if (body[k] != rest) hn::StoreU(row, d, to[body[k]].data() + offset);
  } else {
    const hn::Half<Block> half;
    store_row(half, hn::LowerHalf(half, row), to, body, k, rest, offset);
    store_row(half, hn::UpperHalf(half, row), to, body, k + hn::MaxLanes(half), rest, offset);
  }
}

HWY_INLINE void scatter_part(SoftVector* to, const std::int32_t* body, std::int32_t rest,
                             const Vector& part, std::size_t offset) {
  const D d;
  const V zero = hn::Zero(d);
  const V xz = hn::InterleaveLower(d, part.x, part.z), y0 = hn::InterleaveLower(d, part.y, zero);
  store_row(d, hn::InterleaveLower(d, xz, y0), to, body, 0, rest, offset);
  store_row(d, hn::InterleaveUpper(d, xz, y0), to, body, 1, rest, offset);
  const V zx = hn::InterleaveUpper(d, part.x, part.z), y1 = hn::InterleaveUpper(d, part.y, zero);
  store_row(d, hn::InterleaveLower(d, zx, y1), to, body, 2, rest, offset);
  store_row(d, hn::InterleaveUpper(d, zx, y1), to, body, 3, rest, offset);
}

#endif

HWY_INLINE void gather_side(const SoftVector* from, const std::int32_t* body, Vector& linear,
                            Vector& angular) {
  linear = gather_part(from, body, 0);
  angular = gather_part(from, body, 4);
}

HWY_INLINE Pair gather(const SoftVector* from, const SoftBatch& batch, std::size_t i) {
  Pair pair;
  gather_side(from, batch.body_a.data() + i, pair.linear_a, pair.angular_a);
  gather_side(from, batch.body_b.data() + i, pair.linear_b, pair.angular_b);
  return pair;
}

HWY_INLINE void scatter_side(SoftVector* to, const std::int32_t* body, std::int32_t rest,
                             const Vector& linear, const Vector& angular) {
  scatter_part(to, body, rest, linear, 0);
  scatter_part(to, body, rest, angular, 4);
}

HWY_INLINE V turning(const SoftRow& row, std::size_t i, const Pair& v) {
  return hn::Sub(dot(load(row.arm_b, i), v.angular_b), dot(load(row.arm_a, i), v.angular_a));
}

HWY_INLINE void turn(const SoftRow& row, std::size_t i, V impulse, Pair& v) {
  add(v.angular_a, load(row.turn_a, i), hn::Neg(impulse));
  add(v.angular_b, load(row.turn_b, i), impulse);
}

}  // namespace HWY_NAMESPACE
}  // namespace ourengine
HWY_AFTER_NAMESPACE();

#endif
