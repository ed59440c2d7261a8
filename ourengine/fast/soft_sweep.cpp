// SIMD sweep over soft contacts. soft_sweep_scalar.cpp is the same, lane by lane, in plain words.
#include "ourengine/fast/soft_batch.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ourengine/fast/soft_sweep.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "ourengine/fast/soft_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace ourengine {
namespace HWY_NAMESPACE {

// Gap of the point where the bodies are now; kept for the biased sweep, which comes next.
HWY_INLINE V find_gap(const SoftBatch& batch, SoftPoint& point, std::size_t i, const Pair& moved) {
  const V shift = dot(load(batch.normal, i), minus(moved.linear_b, moved.linear_a));
  const V gap = hn::Add(hn::Add(load(point.gap, i), shift), turning(point.row, i, moved));
  store(gap, point.gap_now, i);
  return gap;
}

// What the sub-steps of a step apply is what stands after their last relaxing sweeps.
HWY_INLINE void sum_up(V impulse, const SoftStep& step, Lane& total, std::size_t i) {
  store(hn::MulAdd(impulse, hn::Set(D(), step.counted), load(total, i)), total, i);
}

// Returns the sum of the normal impulses. moved: unused by the biased sweep.
template <bool biased>
HWY_INLINE V normals(SoftBatch& batch, std::size_t i, const SoftStep& step, const Pair& moved,
                     Pair& v) {
  const D d;
  const V zero = hn::Zero(d);
  const Vector n = load(batch.normal, i);
  const V inverse_mass_a = load(batch.inverse_mass_a, i);
  const V inverse_mass_b = load(batch.inverse_mass_b, i);
  const V inverse_mass = hn::Add(inverse_mass_a, inverse_mass_b);
  const V inverse_step = hn::Set(d, 1.0F / step.step_s);
  const V soft_mass = hn::Set(d, biased ? step.mass_scale : 1.0F);
  const V soft_impulse = hn::Set(d, biased ? step.impulse_scale : 0.0F);
  const V rate = hn::Set(d, step.bias_rate_hz);
  const V push = hn::Set(d, -step.push_limit_mps);
  V approach = dot(n, minus(v.linear_b, v.linear_a));
  V applied = zero;
  V sum = zero;
  for (int p = 0; p < batch.points; ++p) {
    SoftPoint& point = batch.point[static_cast<std::size_t>(p)];
    const V gap = biased ? load(point.gap_now, i) : find_gap(batch, point, i, moved);
    const V speed = hn::Add(approach, turning(point.row, i, v));
    const auto open = hn::Gt(gap, zero);
    const V pushed = biased ? hn::Max(hn::Mul(rate, gap), push) : zero;
    const V bias = hn::IfThenElse(open, hn::Mul(gap, inverse_step), pushed);
    const V mass_scale = hn::IfThenElse(open, hn::Set(d, 1.0F), soft_mass);
    const V impulse_scale = hn::IfThenElse(open, zero, soft_impulse);
    const V old = load(point.impulse, i);
    const V wanted = hn::MulAdd(hn::Mul(load(point.mass, i), mass_scale), hn::Add(speed, bias),
                                hn::Mul(impulse_scale, old));
    const V next = hn::Max(hn::Sub(old, wanted), zero);
    const V impulse = hn::Sub(next, old);
    store(next, point.impulse, i);
    store(hn::Max(load(point.max_impulse, i), next), point.max_impulse, i);
    if constexpr (!biased) sum_up(next, step, point.total, i);
    approach = hn::MulAdd(impulse, inverse_mass, approach);
    applied = hn::Add(applied, impulse);
    sum = hn::Add(sum, next);
    turn(point.row, i, impulse, v);
  }
  add(v.linear_a, n, hn::Neg(hn::Mul(applied, inverse_mass_a)));
  add(v.linear_b, n, hn::Mul(applied, inverse_mass_b));
  return sum;
}

HWY_INLINE V length(V x, V y) { return hn::Sqrt(hn::MulAdd(x, x, hn::Mul(y, y))); }

template <bool biased>
HWY_INLINE void tangents(SoftBatch& batch, std::size_t i, const SoftStep& step, V limit, Pair& v) {
  const Vector t1 = load(batch.tangent[0], i);
  const Vector t2 = load(batch.tangent[1], i);
  const Vector relative = minus(v.linear_b, v.linear_a);
  const V u1 = hn::Add(dot(t1, relative), turning(batch.friction_row[0], i, v));
  const V u2 = hn::Add(dot(t2, relative), turning(batch.friction_row[1], i, v));
  const V old1 = load(batch.friction_impulse[0], i);
  const V old2 = load(batch.friction_impulse[1], i);
  const V mass_11 = load(batch.friction_mass_11, i);
  const V mass_12 = load(batch.friction_mass_12, i);
  const V mass_22 = load(batch.friction_mass_22, i);
  const V stop1 = hn::Sub(old1, hn::MulAdd(mass_11, u1, hn::Mul(mass_12, u2)));
  const V stop2 = hn::Sub(old2, hn::MulAdd(mass_22, u2, hn::Mul(mass_12, u1)));
  const auto slips = hn::Gt(length(stop1, stop2), limit);
  // What slips is held against the slip, so the step has one mass: the least of any direction.
  const V half = hn::Set(D(), 0.5F);
  const V spread = length(hn::Mul(half, hn::Sub(mass_11, mass_22)), mass_12);
  const V mass = hn::Sub(hn::Mul(half, hn::Add(mass_11, mass_22)), spread);
  const V slip1 = hn::Sub(old1, hn::Mul(mass, u1));
  const V slip2 = hn::Sub(old2, hn::Mul(mass, u2));
  const V far = length(slip1, slip2);
  const V scale = hn::IfThenElse(hn::Gt(far, limit), hn::Div(limit, far), hn::Set(D(), 1.0F));
  const V next1 = hn::IfThenElse(slips, hn::Mul(slip1, scale), stop1);
  const V next2 = hn::IfThenElse(slips, hn::Mul(slip2, scale), stop2);
  store(next1, batch.friction_impulse[0], i);
  store(next2, batch.friction_impulse[1], i);
  if constexpr (!biased) {
    sum_up(next1, step, batch.friction_total[0], i);
    sum_up(next2, step, batch.friction_total[1], i);
  }
  const V d1 = hn::Sub(next1, old1);
  const V d2 = hn::Sub(next2, old2);
  const V inverse_mass_a = load(batch.inverse_mass_a, i);
  const V inverse_mass_b = load(batch.inverse_mass_b, i);
  add(v.linear_a, t1, hn::Neg(hn::Mul(d1, inverse_mass_a)));
  add(v.linear_a, t2, hn::Neg(hn::Mul(d2, inverse_mass_a)));
  add(v.linear_b, t1, hn::Mul(d1, inverse_mass_b));
  add(v.linear_b, t2, hn::Mul(d2, inverse_mass_b));
  turn(batch.friction_row[0], i, d1, v);
  turn(batch.friction_row[1], i, d2, v);
}

template <bool biased>
HWY_INLINE void twist(SoftBatch& batch, std::size_t i, const SoftStep& step, V limit, Pair& v) {
  const V spin = dot(load(batch.normal, i), minus(v.angular_b, v.angular_a));
  const V bound = hn::Mul(limit, load(batch.twist_arm, i));
  const V old = load(batch.twist_impulse, i);
  const V wanted = hn::Sub(old, hn::Mul(load(batch.twist_mass, i), spin));
  const V next = hn::Max(hn::Min(wanted, bound), hn::Neg(bound));
  store(next, batch.twist_impulse, i);
  if constexpr (!biased) sum_up(next, step, batch.twist_total, i);
  add(v.angular_a, load(batch.twist_a, i), hn::Neg(hn::Sub(next, old)));
  add(v.angular_b, load(batch.twist_b, i), hn::Sub(next, old));
}

// Whether some lane carries load or has friction left to give back.
HWY_INLINE bool rubs(const SoftBatch& batch, std::size_t i, V load_ns) {
  const V friction = hn::Max(hn::Abs(load(batch.friction_impulse[0], i)),
                             hn::Abs(load(batch.friction_impulse[1], i)));
  const V any = hn::Max(hn::Max(load_ns, hn::Abs(load(batch.twist_impulse, i))), friction);
  return !hn::AllTrue(D(), hn::Eq(any, hn::Zero(D())));
}

template <bool biased>
HWY_INLINE void sweep_all(SoftBatch* batches, std::size_t count, const SoftStep& step,
                          SoftVector* velocity, const SoftVector* moved, std::int32_t rest) {
  for (SoftBatch* batch = batches; batch != batches + count; ++batch) {
    const auto lanes = static_cast<std::size_t>(batch->lanes);
    for (std::size_t i = 0; i < lanes; i += hn::Lanes(D())) {
      Pair v = gather(velocity, *batch, i);
      const V load_ns = normals<biased>(*batch, i, step, biased ? v : gather(moved, *batch, i), v);
      if (rubs(*batch, i, load_ns)) {
        const V limit = hn::Mul(load(batch->friction, i), load_ns);
        tangents<biased>(*batch, i, step, limit, v);
        twist<biased>(*batch, i, step, limit, v);
      }
      scatter_side(velocity, batch->body_a.data() + i, rest, v.linear_a, v.angular_a);
      scatter_side(velocity, batch->body_b.data() + i, rest, v.linear_b, v.angular_b);
    }
  }
}

void sweep(SoftBatch* batches, std::size_t count, const SoftStep& step, bool biased,
           SoftVector* velocity, const SoftVector* moved, std::int32_t rest) {
  biased ? sweep_all<true>(batches, count, step, velocity, moved, rest)
         : sweep_all<false>(batches, count, step, velocity, moved, rest);
}

// (1 + e)^2 - (1 + 2 e) is e^2, unless the square is rounded first.
bool fuses() {
  const float e = 0x1p-14F;
  const V x = hn::Set(D(), 1.0F + e);
  return hn::GetLane(hn::MulAdd(x, x, hn::Set(D(), -(1.0F + 2.0F * e)))) > 0.0F;
}

}  // namespace HWY_NAMESPACE
}  // namespace ourengine
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ourengine {
HWY_EXPORT(sweep);
HWY_EXPORT(fuses);

bool soft_fuses() { return HWY_DYNAMIC_DISPATCH(fuses)(); }

void soft_sweep(std::span<SoftBatch> batches, const SoftStep& step, bool biased,
                std::span<SoftVector> velocity, std::span<const SoftVector> moved) {
  if (!soft_fuses()) return soft_sweep_scalar(batches, step, biased, velocity, moved);
  HWY_DYNAMIC_DISPATCH(sweep)
  (batches.data(), batches.size(), step, biased, velocity.data(), moved.data(),
   static_cast<std::int32_t>(velocity.size()) - 1);
}

}  // namespace ourengine
#endif
