// The scalar twins of soft_prepare() and soft_push(): one manifold at a time, the same sums.
#include <cmath>

#include "ourengine/fast/soft_batch.hpp"

namespace ourengine {
namespace {

using Vector = std::array<float, 3>;

float dot(const Vector& a, const Vector& b) {
  return std::fma(a[2], b[2], std::fma(a[1], b[1], a[0] * b[0]));
}
Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vector times(const Vector& a, float scale) { return {a[0] * scale, a[1] * scale, a[2] * scale}; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
void add(Vector& a, const Vector& b, float scale) {
  for (std::size_t k = 0; k < 3; ++k) a[k] = std::fma(b[k], scale, a[k]);
}
Vector lane(const Lane3& lanes, std::size_t i) { return {lanes[0][i], lanes[1][i], lanes[2][i]}; }
void put(Lane3& lanes, std::size_t i, const Vector& v) {
  for (std::size_t k = 0; k < 3; ++k) lanes[k][i] = v[k];
}
float inverse(float x) { return x > 0.0F ? 1.0F / x : 0.0F; }

Vector turn(const SoftInertia& inertia, const Vector& v) {
  return {dot({inertia[0], inertia[1], inertia[2]}, v),
          dot({inertia[1], inertia[3], inertia[4]}, v),
          dot({inertia[2], inertia[4], inertia[5]}, v)};
}

struct Sides {
  SoftInertia a, b;
};

float make_row(SoftRow& row, std::size_t i, const Sides& sides, const Vector& lever_a,
               const Vector& lever_b, const Vector& direction) {
  const Vector arm_a = cross(lever_a, direction);
  const Vector arm_b = cross(lever_b, direction);
  const Vector turn_a = turn(sides.a, arm_a);
  const Vector turn_b = turn(sides.b, arm_b);
  put(row.arm_a, i, arm_a);
  put(row.arm_b, i, arm_b);
  put(row.turn_a, i, turn_a);
  put(row.turn_b, i, turn_b);
  return (sides.a[6] + sides.b[6]) + (dot(arm_a, turn_a) + dot(arm_b, turn_b));
}

void make_tangents(SoftBatch& batch, std::size_t i, const Vector& n) {
  const float x = std::abs(n[0]), y = std::abs(n[1]), z = std::abs(n[2]);
  Vector t = {n[1], -n[0], 0.0F};
  if (x <= y && x <= z) {
    t = {0.0F, n[2], -n[1]};
  } else if (y <= z) {
    t = {-n[2], 0.0F, n[0]};
  }
  t = times(t, inverse(std::sqrt(dot(t, t))));
  put(batch.tangent[0], i, t);
  put(batch.tangent[1], i, cross(n, t));
}

void prepare_friction(SoftBatch& batch, std::size_t i, const Sides& sides, const Vector& centre_a,
                      const Vector& centre_b) {
  const Vector t1 = lane(batch.tangent[0], i);
  const Vector t2 = lane(batch.tangent[1], i);
  SoftRow& row1 = batch.friction_row[0];
  SoftRow& row2 = batch.friction_row[1];
  const float k11 = make_row(row1, i, sides, centre_a, centre_b, t1);
  const float k22 = make_row(row2, i, sides, centre_a, centre_b, t2);
  const float k12 = dot(lane(row1.arm_a, i), lane(row2.turn_a, i)) +
                    dot(lane(row1.arm_b, i), lane(row2.turn_b, i));
  const float scale = inverse(k11 * k22 - k12 * k12);
  batch.friction_mass_11[i] = k22 * scale;
  batch.friction_mass_22[i] = k11 * scale;
  batch.friction_mass_12[i] = -(k12 * scale);
  const Vector carried = lane(batch.carried_friction, i);
  batch.friction_impulse[0][i] = dot(t1, carried);
  batch.friction_impulse[1][i] = dot(t2, carried);
  const Vector n = lane(batch.normal, i);
  const Vector twist_a = turn(sides.a, n);
  const Vector twist_b = turn(sides.b, n);
  put(batch.twist_a, i, twist_a);
  put(batch.twist_b, i, twist_b);
  batch.twist_mass[i] = inverse(dot(n, twist_a) + dot(n, twist_b));
}

void prepare_lane(SoftBatch& batch, std::size_t i, const Sides& sides) {
  batch.inverse_mass_a[i] = sides.a[6];
  batch.inverse_mass_b[i] = sides.b[6];
  const Vector n = lane(batch.normal, i);
  make_tangents(batch, i, n);
  Vector centre_a{}, centre_b{};
  float count = 0.0F;
  for (std::size_t p = 0; p < static_cast<std::size_t>(batch.points); ++p) {
    const SoftPoint& point = batch.point[p];
    add(centre_a, lane(point.row.arm_a, i), point.mass[i]);
    add(centre_b, lane(point.row.arm_b, i), point.mass[i]);
    count = count + point.mass[i];
  }
  const float share = inverse(count);
  centre_a = times(centre_a, share);
  centre_b = times(centre_b, share);
  float distances = 0.0F;
  for (std::size_t p = 0; p < static_cast<std::size_t>(batch.points); ++p) {
    SoftPoint& point = batch.point[p];
    const float present = point.mass[i];
    const Vector lever_a = lane(point.row.arm_a, i);
    const Vector lever_b = lane(point.row.arm_b, i);
    const Vector off = minus(lever_a, centre_a);
    distances = distances + present * std::sqrt(dot(off, off));
    point.mass[i] = present * inverse(make_row(point.row, i, sides, lever_a, lever_b, n));
  }
  batch.twist_arm[i] = distances * share;
  prepare_friction(batch, i, sides, centre_a, centre_b);
}

void push(const SoftBatch& batch, std::size_t i, const Vector& direction, const SoftRow& row,
          float impulse, std::array<Vector, 4>& v) {
  add(v[0], direction, -(impulse * batch.inverse_mass_a[i]));
  add(v[2], direction, impulse * batch.inverse_mass_b[i]);
  add(v[1], lane(row.turn_a, i), -impulse);
  add(v[3], lane(row.turn_b, i), impulse);
}

}  // namespace

void soft_prepare_scalar(std::span<SoftBatch> batches, std::span<const SoftInertia> inertia) {
  for (SoftBatch& batch : batches) {
    for (std::size_t i = 0; i < k_lanes; ++i) {
      prepare_lane(batch, i,
                   {inertia[static_cast<std::size_t>(batch.body_a[i])],
                    inertia[static_cast<std::size_t>(batch.body_b[i])]});
    }
  }
}

void soft_push_scalar(std::span<const SoftBatch> batches, std::span<SoftVector> change) {
  const auto rest = static_cast<std::int32_t>(change.size()) - 1;
  for (const SoftBatch& batch : batches) {
    for (std::size_t i = 0; i < k_lanes; ++i) {
      const std::int32_t a = batch.body_a[i];
      const std::int32_t b = batch.body_b[i];
      SoftVector& on_a = change[static_cast<std::size_t>(a)];
      SoftVector& on_b = change[static_cast<std::size_t>(b)];
      std::array<Vector, 4> v = {{{on_a[0], on_a[1], on_a[2]},
                                  {on_a[4], on_a[5], on_a[6]},
                                  {on_b[0], on_b[1], on_b[2]},
                                  {on_b[4], on_b[5], on_b[6]}}};
      for (std::size_t p = 0; p < static_cast<std::size_t>(batch.points); ++p)
        push(batch, i, lane(batch.normal, i), batch.point[p].row, batch.point[p].impulse[i], v);
      for (std::size_t k = 0; k < 2; ++k) {
        push(batch, i, lane(batch.tangent[k], i), batch.friction_row[k],
             batch.friction_impulse[k][i], v);
      }
      add(v[1], lane(batch.twist_a, i), -batch.twist_impulse[i]);
      add(v[3], lane(batch.twist_b, i), batch.twist_impulse[i]);
      if (a != rest) on_a = {v[0][0], v[0][1], v[0][2], 0.0F, v[1][0], v[1][1], v[1][2], 0.0F};
      if (b != rest) on_b = {v[2][0], v[2][1], v[2][2], 0.0F, v[3][0], v[3][1], v[3][2], 0.0F};
    }
  }
}

}  // namespace ourengine
