// The scalar twin of soft_sweep.cpp: the algorithm, one manifold at a time.
#include <algorithm>
#include <cmath>

#include "ourengine/fast/soft_batch.hpp"

namespace ourengine {
namespace {

using Vector = std::array<float, 3>;

float dot(const Vector& a, const Vector& b) {
  return std::fma(a[2], b[2], std::fma(a[1], b[1], a[0] * b[0]));
}
Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
void add(Vector& a, const Vector& b, float scale) {
  for (std::size_t k = 0; k < 3; ++k) a[k] = std::fma(b[k], scale, a[k]);
}
Vector lane(const Lane3& lanes, std::size_t i) { return {lanes[0][i], lanes[1][i], lanes[2][i]}; }
Vector linear(const SoftVector& v) { return {v[0], v[1], v[2]}; }
Vector angular(const SoftVector& v) { return {v[4], v[5], v[6]}; }

struct Pair {
  Vector linear_a, angular_a, linear_b, angular_b;
};

Pair gather(std::span<const SoftVector> from, std::int32_t a, std::int32_t b) {
  const SoftVector& va = from[static_cast<std::size_t>(a)];
  const SoftVector& vb = from[static_cast<std::size_t>(b)];
  return {linear(va), angular(va), linear(vb), angular(vb)};
}

void scatter(SoftVector& to, const Vector& linear, const Vector& angular) {
  to = {linear[0], linear[1], linear[2], 0.0F, angular[0], angular[1], angular[2], 0.0F};
}

float turning(const SoftRow& row, std::size_t i, const Pair& v) {
  return dot(lane(row.arm_b, i), v.angular_b) - dot(lane(row.arm_a, i), v.angular_a);
}

void turn(const SoftRow& row, std::size_t i, float impulse, Pair& v) {
  add(v.angular_a, lane(row.turn_a, i), -impulse);
  add(v.angular_b, lane(row.turn_b, i), impulse);
}

// Returns the sum of the normal impulses.
float normals(SoftBatch& batch, std::size_t i, const SoftStep& step, bool biased, const Pair& moved,
              Pair& v) {
  const Vector n = lane(batch.normal, i);
  const float inverse_mass = batch.inverse_mass_a[i] + batch.inverse_mass_b[i];
  const float inverse_step = 1.0F / step.step_s;
  float approach = dot(n, minus(v.linear_b, v.linear_a));
  const float shift = dot(n, minus(moved.linear_b, moved.linear_a));
  float applied = 0.0F;
  float sum = 0.0F;
  for (int p = 0; p < batch.points; ++p) {
    SoftPoint& point = batch.point[static_cast<std::size_t>(p)];
    if (!biased) point.gap_now[i] = (point.gap[i] + shift) + turning(point.row, i, moved);
    const float gap = point.gap_now[i];
    const float speed = approach + turning(point.row, i, v);
    float bias = gap * inverse_step;
    float mass_scale = 1.0F;
    float impulse_scale = 0.0F;
    if (!(gap > 0.0F)) {
      bias = biased ? std::max(step.bias_rate_hz * gap, -step.push_limit_mps) : 0.0F;
      mass_scale = biased ? step.mass_scale : 1.0F;
      impulse_scale = biased ? step.impulse_scale : 0.0F;
    }
    const float wanted =
        std::fma(point.mass[i] * mass_scale, speed + bias, impulse_scale * point.impulse[i]);
    const float next = std::max(point.impulse[i] - wanted, 0.0F);
    const float impulse = next - point.impulse[i];
    point.impulse[i] = next;
    point.max_impulse[i] = std::max(point.max_impulse[i], next);
    if (!biased) point.total[i] = std::fma(next, step.counted, point.total[i]);
    approach = std::fma(impulse, inverse_mass, approach);
    applied = applied + impulse;
    sum = sum + next;
    turn(point.row, i, impulse, v);
  }
  add(v.linear_a, n, -(applied * batch.inverse_mass_a[i]));
  add(v.linear_b, n, applied * batch.inverse_mass_b[i]);
  return sum;
}

float length(float x, float y) { return std::sqrt(std::fma(x, x, y * y)); }

void tangents(SoftBatch& batch, std::size_t i, const SoftStep& step, float load, bool biased,
              Pair& v) {
  const Vector t1 = lane(batch.tangent[0], i);
  const Vector t2 = lane(batch.tangent[1], i);
  const Vector relative = minus(v.linear_b, v.linear_a);
  const float u1 = dot(t1, relative) + turning(batch.friction_row[0], i, v);
  const float u2 = dot(t2, relative) + turning(batch.friction_row[1], i, v);
  const float old1 = batch.friction_impulse[0][i];
  const float old2 = batch.friction_impulse[1][i];
  const float mass_11 = batch.friction_mass_11[i];
  const float mass_12 = batch.friction_mass_12[i];
  const float mass_22 = batch.friction_mass_22[i];
  float next1 = old1 - std::fma(mass_11, u1, mass_12 * u2);
  float next2 = old2 - std::fma(mass_22, u2, mass_12 * u1);
  const float limit = batch.friction[i] * load;
  if (length(next1, next2) > limit) {
    const float spread = length(0.5F * (mass_11 - mass_22), mass_12);
    const float mass = 0.5F * (mass_11 + mass_22) - spread;
    next1 = old1 - mass * u1;
    next2 = old2 - mass * u2;
    const float far = length(next1, next2);
    const float scale = far > limit ? limit / far : 1.0F;
    next1 = next1 * scale;
    next2 = next2 * scale;
  }
  batch.friction_impulse[0][i] = next1;
  batch.friction_impulse[1][i] = next2;
  if (!biased) {
    batch.friction_total[0][i] = std::fma(next1, step.counted, batch.friction_total[0][i]);
    batch.friction_total[1][i] = std::fma(next2, step.counted, batch.friction_total[1][i]);
  }
  const float d1 = next1 - old1;
  const float d2 = next2 - old2;
  add(v.linear_a, t1, -(d1 * batch.inverse_mass_a[i]));
  add(v.linear_a, t2, -(d2 * batch.inverse_mass_a[i]));
  add(v.linear_b, t1, d1 * batch.inverse_mass_b[i]);
  add(v.linear_b, t2, d2 * batch.inverse_mass_b[i]);
  turn(batch.friction_row[0], i, d1, v);
  turn(batch.friction_row[1], i, d2, v);
}

void twist(SoftBatch& batch, std::size_t i, const SoftStep& step, float load, bool biased,
           Pair& v) {
  const float spin = dot(lane(batch.normal, i), minus(v.angular_b, v.angular_a));
  const float limit = (batch.friction[i] * load) * batch.twist_arm[i];
  const float old = batch.twist_impulse[i];
  const float next = std::max(std::min(old - batch.twist_mass[i] * spin, limit), -limit);
  batch.twist_impulse[i] = next;
  if (!biased) batch.twist_total[i] = std::fma(next, step.counted, batch.twist_total[i]);
  add(v.angular_a, lane(batch.twist_a, i), -(next - old));
  add(v.angular_b, lane(batch.twist_b, i), next - old);
}

}  // namespace

void soft_sweep_scalar(std::span<SoftBatch> batches, const SoftStep& step, bool biased,
                       std::span<SoftVector> velocity, std::span<const SoftVector> moved) {
  const auto rest = static_cast<std::int32_t>(velocity.size()) - 1;
  for (SoftBatch& batch : batches) {
    for (std::size_t i = 0; i < k_lanes; ++i) {
      const std::int32_t a = batch.body_a[i];
      const std::int32_t b = batch.body_b[i];
      Pair v = gather(velocity, a, b);
      const float load = normals(batch, i, step, biased, gather(moved, a, b), v);
      tangents(batch, i, step, load, biased, v);
      twist(batch, i, step, load, biased, v);
      if (a != rest) scatter(velocity[static_cast<std::size_t>(a)], v.linear_a, v.angular_a);
      if (b != rest) scatter(velocity[static_cast<std::size_t>(b)], v.linear_b, v.angular_b);
    }
  }
}

}  // namespace ourengine
