// SIMD sweep over soft contacts. soft_sweep_scalar.cpp is the same, lane by lane, in plain words.
#include "ourengine/fast/soft_batch.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ourengine/fast/soft_sweep.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

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
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vector minus(const Vector& a, const Vector& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE void add(Vector& a, const Vector& b, V scale) {
  a.x = hn::Add(a.x, hn::Mul(b.x, scale));
  a.y = hn::Add(a.y, hn::Mul(b.y, scale));
  a.z = hn::Add(a.z, hn::Mul(b.z, scale));
}

struct Pair {
  Vector linear_a, angular_a, linear_b, angular_b;
};

// Eight (or fewer) bodies' vectors, turned into one vector register per component.
HWY_INLINE void gather_side(const SoftVector* from, const std::int32_t* body, Vector& linear,
                            Vector& angular) {
  const hn::RebindToSigned<D> di;
  const auto index = hn::ShiftLeft<3>(hn::LoadU(di, body));
  const float* base = from->data();
  linear = {hn::GatherIndex(D(), base, index), hn::GatherIndex(D(), base + 1, index),
            hn::GatherIndex(D(), base + 2, index)};
  angular = {hn::GatherIndex(D(), base + 4, index), hn::GatherIndex(D(), base + 5, index),
             hn::GatherIndex(D(), base + 6, index)};
}

HWY_INLINE Pair gather(const SoftVector* from, const SoftBatch& batch, std::size_t i) {
  Pair pair;
  gather_side(from, batch.body_a.data() + i, pair.linear_a, pair.angular_a);
  gather_side(from, batch.body_b.data() + i, pair.linear_b, pair.angular_b);
  return pair;
}

HWY_INLINE void scatter_side(SoftVector* to, const std::int32_t* body, std::int32_t rest,
                             const Vector& linear, const Vector& angular) {
  constexpr std::size_t n = hn::MaxLanes(D());
  HWY_ALIGN float part[6][n];
  hn::Store(linear.x, D(), part[0]);
  hn::Store(linear.y, D(), part[1]);
  hn::Store(linear.z, D(), part[2]);
  hn::Store(angular.x, D(), part[3]);
  hn::Store(angular.y, D(), part[4]);
  hn::Store(angular.z, D(), part[5]);
  for (std::size_t k = 0; k < hn::Lanes(D()); ++k) {
    if (body[k] == rest) continue;
    SoftVector& v = to[body[k]];
    v[0] = part[0][k];
    v[1] = part[1][k];
    v[2] = part[2][k];
    v[4] = part[3][k];
    v[5] = part[4][k];
    v[6] = part[5][k];
  }
}

HWY_INLINE V turning(const SoftRow& row, std::size_t i, const Pair& v) {
  return hn::Sub(dot(load(row.arm_b, i), v.angular_b), dot(load(row.arm_a, i), v.angular_a));
}

HWY_INLINE void turn(const SoftRow& row, std::size_t i, V impulse, Pair& v) {
  add(v.angular_a, load(row.turn_a, i), hn::Neg(impulse));
  add(v.angular_b, load(row.turn_b, i), impulse);
}

HWY_INLINE V normals(SoftBatch& batch, std::size_t i, const SoftStep& step, bool biased,
                     const Pair& moved, Pair& v) {
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
  const V shift = dot(n, minus(moved.linear_b, moved.linear_a));
  V applied = zero;
  V sum = zero;
  for (int p = 0; p < batch.points; ++p) {
    SoftPoint& point = batch.point[static_cast<std::size_t>(p)];
    const V gap = hn::Add(hn::Add(load(point.gap, i), shift), turning(point.row, i, moved));
    const V speed = hn::Add(approach, turning(point.row, i, v));
    const auto open = hn::Gt(gap, zero);
    const V pushed = biased ? hn::Max(hn::Mul(rate, gap), push) : zero;
    const V bias = hn::IfThenElse(open, hn::Mul(gap, inverse_step), pushed);
    const V mass_scale = hn::IfThenElse(open, hn::Set(d, 1.0F), soft_mass);
    const V impulse_scale = hn::IfThenElse(open, zero, soft_impulse);
    const V old = load(point.impulse, i);
    const V wanted =
        hn::Add(hn::Mul(hn::Mul(load(point.mass, i), mass_scale), hn::Add(speed, bias)),
                hn::Mul(impulse_scale, old));
    const V next = hn::Max(hn::Sub(old, wanted), zero);
    const V impulse = hn::Sub(next, old);
    store(next, point.impulse, i);
    store(hn::Max(load(point.max_impulse, i), next), point.max_impulse, i);
    approach = hn::Add(approach, hn::Mul(impulse, inverse_mass));
    applied = hn::Add(applied, impulse);
    sum = hn::Add(sum, next);
    turn(point.row, i, impulse, v);
  }
  add(v.linear_a, n, hn::Neg(hn::Mul(applied, inverse_mass_a)));
  add(v.linear_b, n, hn::Mul(applied, inverse_mass_b));
  return sum;
}

HWY_INLINE void tangents(SoftBatch& batch, std::size_t i, V limit, Pair& v) {
  const Vector t1 = load(batch.tangent[0], i);
  const Vector t2 = load(batch.tangent[1], i);
  const Vector relative = minus(v.linear_b, v.linear_a);
  const V u1 = hn::Add(dot(t1, relative), turning(batch.friction_row[0], i, v));
  const V u2 = hn::Add(dot(t2, relative), turning(batch.friction_row[1], i, v));
  const V old1 = load(batch.friction_impulse[0], i);
  const V old2 = load(batch.friction_impulse[1], i);
  const V mass_12 = load(batch.friction_mass_12, i);
  V next1 =
      hn::Sub(old1, hn::Add(hn::Mul(load(batch.friction_mass_11, i), u1), hn::Mul(mass_12, u2)));
  V next2 =
      hn::Sub(old2, hn::Add(hn::Mul(mass_12, u1), hn::Mul(load(batch.friction_mass_22, i), u2)));
  const V length = hn::Sqrt(hn::Add(hn::Mul(next1, next1), hn::Mul(next2, next2)));
  const auto slips = hn::Gt(length, limit);
  const V scale = hn::IfThenElse(slips, hn::Div(limit, length), hn::Set(D(), 1.0F));
  next1 = hn::Mul(next1, scale);
  next2 = hn::Mul(next2, scale);
  store(next1, batch.friction_impulse[0], i);
  store(next2, batch.friction_impulse[1], i);
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

HWY_INLINE void twist(SoftBatch& batch, std::size_t i, V limit, Pair& v) {
  const V spin = dot(load(batch.normal, i), minus(v.angular_b, v.angular_a));
  const V bound = hn::Mul(limit, load(batch.twist_arm, i));
  const V old = load(batch.twist_impulse, i);
  const V wanted = hn::Sub(old, hn::Mul(load(batch.twist_mass, i), spin));
  const V next = hn::Max(hn::Min(wanted, bound), hn::Neg(bound));
  store(next, batch.twist_impulse, i);
  add(v.angular_a, load(batch.twist_a, i), hn::Neg(hn::Sub(next, old)));
  add(v.angular_b, load(batch.twist_b, i), hn::Sub(next, old));
}

void sweep(SoftBatch* batches, std::size_t count, const SoftStep& step, bool biased,
           SoftVector* velocity, const SoftVector* moved, std::int32_t rest) {
  for (SoftBatch* batch = batches; batch != batches + count; ++batch) {
    for (std::size_t i = 0; i < k_lanes; i += hn::Lanes(D())) {
      Pair v = gather(velocity, *batch, i);
      const Pair shift = gather(moved, *batch, i);
      const V load_ns = normals(*batch, i, step, biased, shift, v);
      const V limit = hn::Mul(load(batch->friction, i), load_ns);
      tangents(*batch, i, limit, v);
      twist(*batch, i, limit, v);
      scatter_side(velocity, batch->body_a.data() + i, rest, v.linear_a, v.angular_a);
      scatter_side(velocity, batch->body_b.data() + i, rest, v.linear_b, v.angular_b);
    }
  }
}

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
    for (std::size_t i = 0; i < k_lanes; i += hn::Lanes(D())) prepare_lanes(*batch, i, inertia);
}

HWY_INLINE void push_row(const SoftBatch& batch, std::size_t i, const Vector& direction,
                         const SoftRow& row, V impulse, Pair& v) {
  add(v.linear_a, direction, hn::Neg(hn::Mul(impulse, load(batch.inverse_mass_a, i))));
  add(v.linear_b, direction, hn::Mul(impulse, load(batch.inverse_mass_b, i)));
  turn(row, i, impulse, v);
}

void push(const SoftBatch* batches, std::size_t count, SoftVector* change, std::int32_t rest) {
  for (const SoftBatch* batch = batches; batch != batches + count; ++batch) {
    for (std::size_t i = 0; i < k_lanes; i += hn::Lanes(D())) {
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
HWY_EXPORT(sweep);
HWY_EXPORT(prepare);
HWY_EXPORT(push);

void soft_prepare(std::span<SoftBatch> batches, std::span<const SoftInertia> inertia) {
  HWY_DYNAMIC_DISPATCH(prepare)(batches.data(), batches.size(), inertia.data());
}

void soft_push(std::span<const SoftBatch> batches, std::span<SoftVector> change) {
  HWY_DYNAMIC_DISPATCH(push)
  (batches.data(), batches.size(), change.data(), static_cast<std::int32_t>(change.size()) - 1);
}

void soft_sweep(std::span<SoftBatch> batches, const SoftStep& step, bool biased,
                std::span<SoftVector> velocity, std::span<const SoftVector> moved) {
  HWY_DYNAMIC_DISPATCH(sweep)
  (batches.data(), batches.size(), step, biased, velocity.data(), moved.data(),
   static_cast<std::int32_t>(velocity.size()) - 1);
}

}  // namespace ourengine
#endif
