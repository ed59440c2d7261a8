// SIMD preparation of soft contacts. soft_prepare_scalar.cpp is the same, lane by lane.
#include "ourengine/fast/soft_batch.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ourengine/fast/soft_prepare.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "ourengine/fast/soft_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace ourengine {
namespace HWY_NAMESPACE {

HWY_INLINE Vector cross(const Vector& a, const Vector& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE void store(const Vector& value, Lane3& lanes, std::size_t i) {
  store(value.x, lanes[0], i);
  store(value.y, lanes[1], i);
  store(value.z, lanes[2], i);
}
// 1 / x where x > 0, else 0.
HWY_INLINE V inverse(V x) {
  const V zero = hn::Zero(D());
  return hn::IfThenElse(hn::Gt(x, zero), hn::Div(hn::Set(D(), 1.0F), x), zero);
}

struct Inertia {
  V xx, xy, xz, yy, yz, zz, inverse_mass;
  HWY_INLINE Vector operator*(const Vector& v) const {
    return {dot({xx, xy, xz}, v), dot({xy, yy, yz}, v), dot({xz, yz, zz}, v)};
  }
};

HWY_INLINE Inertia gather_inertia(const SoftInertia* from, const std::int32_t* body) {
  const hn::RebindToSigned<D> di;
  const auto index = hn::ShiftLeft<3>(hn::LoadU(di, body));
  const float* base = from->data();
  const auto part = [&](int k) HWY_ATTR { return hn::GatherIndex(D(), base + k, index); };
  return {part(0), part(1), part(2), part(3), part(4), part(5), part(6)};
}

struct Sides {
  Inertia a, b;
};

// Fills the row of `direction` at the levers; returns its effective inverse mass.
HWY_INLINE V make_row(SoftRow& row, std::size_t i, const Sides& sides, const Vector& lever_a,
                      const Vector& lever_b, const Vector& direction) {
  const Vector arm_a = cross(lever_a, direction);
  const Vector arm_b = cross(lever_b, direction);
  const Vector turn_a = sides.a * arm_a;
  const Vector turn_b = sides.b * arm_b;
  store(arm_a, row.arm_a, i);
  store(arm_b, row.arm_b, i);
  store(turn_a, row.turn_a, i);
  store(turn_b, row.turn_b, i);
  return hn::Add(hn::Add(sides.a.inverse_mass, sides.b.inverse_mass),
                 hn::Add(dot(arm_a, turn_a), dot(arm_b, turn_b)));
}

// Normal times the axis it has least of, at unit length, and the third.
HWY_INLINE void make_tangents(SoftBatch& batch, std::size_t i, const Vector& n) {
  const V zero = hn::Zero(D());
  const V x = hn::Abs(n.x), y = hn::Abs(n.y), z = hn::Abs(n.z);
  const auto along_x = hn::And(hn::Le(x, y), hn::Le(x, z));
  const auto along_y = hn::AndNot(along_x, hn::Le(y, z));
  Vector t = {hn::IfThenElse(along_x, zero, hn::IfThenElse(along_y, hn::Neg(n.z), n.y)),
              hn::IfThenElse(along_x, n.z, hn::IfThenElse(along_y, zero, hn::Neg(n.x))),
              hn::IfThenElse(along_x, hn::Neg(n.y), hn::IfThenElse(along_y, n.x, zero))};
  const V scale = inverse(hn::Sqrt(dot(t, t)));
  t = {hn::Mul(t.x, scale), hn::Mul(t.y, scale), hn::Mul(t.z, scale)};
  store(t, batch.tangent[0], i);
  store(cross(n, t), batch.tangent[1], i);
}

// Friction and twist act where the points have their centre.
HWY_INLINE void prepare_friction(SoftBatch& batch, std::size_t i, const Sides& sides,
                                 const Vector& centre_a, const Vector& centre_b) {
  const Vector t1 = load(batch.tangent[0], i);
  const Vector t2 = load(batch.tangent[1], i);
  SoftRow& row1 = batch.friction_row[0];
  SoftRow& row2 = batch.friction_row[1];
  const V k11 = make_row(row1, i, sides, centre_a, centre_b, t1);
  const V k22 = make_row(row2, i, sides, centre_a, centre_b, t2);
  const V k12 = hn::Add(dot(load(row1.arm_a, i), load(row2.turn_a, i)),
                        dot(load(row1.arm_b, i), load(row2.turn_b, i)));
  const V scale = inverse(hn::Sub(hn::Mul(k11, k22), hn::Mul(k12, k12)));
  store(hn::Mul(k22, scale), batch.friction_mass_11, i);
  store(hn::Mul(k11, scale), batch.friction_mass_22, i);
  store(hn::Neg(hn::Mul(k12, scale)), batch.friction_mass_12, i);
  const Vector carried = load(batch.carried_friction, i);
  store(dot(t1, carried), batch.friction_impulse[0], i);
  store(dot(t2, carried), batch.friction_impulse[1], i);
  const Vector n = load(batch.normal, i);
  const Vector twist_a = sides.a * n;
  const Vector twist_b = sides.b * n;
  store(twist_a, batch.twist_a, i);
  store(twist_b, batch.twist_b, i);
  store(inverse(hn::Add(dot(n, twist_a), dot(n, twist_b))), batch.twist_mass, i);
}

HWY_INLINE void prepare_lanes(SoftBatch& batch, std::size_t i, const SoftInertia* inertia) {
  const V zero = hn::Zero(D());
  const Sides sides = {gather_inertia(inertia, batch.body_a.data() + i),
                       gather_inertia(inertia, batch.body_b.data() + i)};
  store(sides.a.inverse_mass, batch.inverse_mass_a, i);
  store(sides.b.inverse_mass, batch.inverse_mass_b, i);
  const Vector n = load(batch.normal, i);
  make_tangents(batch, i, n);
  Vector sum_a = {zero, zero, zero}, sum_b = sum_a;
  V count = zero;
  for (int p = 0; p < batch.points; ++p) {
    const SoftPoint& point = batch.point[static_cast<std::size_t>(p)];
    const V present = load(point.mass, i);
    add(sum_a, load(point.row.arm_a, i), present);
    add(sum_b, load(point.row.arm_b, i), present);
    count = hn::Add(count, present);
  }
  const V share = inverse(count);
  const Vector centre_a = {hn::Mul(sum_a.x, share), hn::Mul(sum_a.y, share),
                           hn::Mul(sum_a.z, share)};
  const Vector centre_b = {hn::Mul(sum_b.x, share), hn::Mul(sum_b.y, share),
                           hn::Mul(sum_b.z, share)};
  V distances = zero;
  for (int p = 0; p < batch.points; ++p) {
    SoftPoint& point = batch.point[static_cast<std::size_t>(p)];
    const V present = load(point.mass, i);
    const Vector lever_a = load(point.row.arm_a, i);
    const Vector lever_b = load(point.row.arm_b, i);
    const Vector off = minus(lever_a, centre_a);
    distances = hn::Add(distances, hn::Mul(present, hn::Sqrt(dot(off, off))));
    const V inverse_mass = make_row(point.row, i, sides, lever_a, lever_b, n);
    store(hn::Mul(present, inverse(inverse_mass)), point.mass, i);
  }
  store(hn::Mul(distances, share), batch.twist_arm, i);
  prepare_friction(batch, i, sides, centre_a, centre_b);
}

void prepare(SoftBatch* batches, std::size_t count, const SoftInertia* inertia) {
  for (SoftBatch* batch = batches; batch != batches + count; ++batch)
    for (std::size_t i = 0; i < static_cast<std::size_t>(batch->lanes); i += hn::Lanes(D()))
      prepare_lanes(*batch, i, inertia);
}

HWY_INLINE void push_row(const SoftBatch& batch, std::size_t i, const Vector& direction,
                         const SoftRow& row, V impulse, Pair& v) {
  add(v.linear_a, direction, hn::Neg(hn::Mul(impulse, load(batch.inverse_mass_a, i))));
  add(v.linear_b, direction, hn::Mul(impulse, load(batch.inverse_mass_b, i)));
  turn(row, i, impulse, v);
}

void push(const SoftBatch* batches, std::size_t count, SoftVector* change, std::int32_t rest) {
  for (const SoftBatch* batch = batches; batch != batches + count; ++batch) {
    const auto lanes = static_cast<std::size_t>(batch->lanes);
    for (std::size_t i = 0; i < lanes; i += hn::Lanes(D())) {
      Pair v = gather(change, *batch, i);
      const Vector n = load(batch->normal, i);
      for (int p = 0; p < batch->points; ++p) {
        const SoftPoint& point = batch->point[static_cast<std::size_t>(p)];
        push_row(*batch, i, n, point.row, load(point.impulse, i), v);
      }
      for (std::size_t k = 0; k < 2; ++k) {
        push_row(*batch, i, load(batch->tangent[k], i), batch->friction_row[k],
                 load(batch->friction_impulse[k], i), v);
      }
      const V twisting = load(batch->twist_impulse, i);
      add(v.angular_a, load(batch->twist_a, i), hn::Neg(twisting));
      add(v.angular_b, load(batch->twist_b, i), twisting);
      scatter_side(change, batch->body_a.data() + i, rest, v.linear_a, v.angular_a);
      scatter_side(change, batch->body_b.data() + i, rest, v.linear_b, v.angular_b);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace ourengine
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ourengine {
HWY_EXPORT(prepare);
HWY_EXPORT(push);

void soft_prepare(std::span<SoftBatch> batches, std::span<const SoftInertia> inertia) {
  if (!soft_fuses()) return soft_prepare_scalar(batches, inertia);
  HWY_DYNAMIC_DISPATCH(prepare)(batches.data(), batches.size(), inertia.data());
}

void soft_push(std::span<const SoftBatch> batches, std::span<SoftVector> change) {
  if (!soft_fuses()) return soft_push_scalar(batches, change);
  HWY_DYNAMIC_DISPATCH(push)
  (batches.data(), batches.size(), change.data(), static_cast<std::int32_t>(change.size()) - 1);
}

}  // namespace ourengine
#endif
