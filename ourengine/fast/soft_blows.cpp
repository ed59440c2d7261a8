#include "ourengine/fast/soft_blows.hpp"

#include <algorithm>

namespace ourengine {
namespace {

std::span<const SoftPoint> points_of(const SoftBatch& batch) {
  return std::span(batch.point).first(static_cast<std::size_t>(batch.points));
}

float load_at(const SoftBatch& batch, const SoftPoint& point, std::size_t i) {
  return std::min(point.impulse[i], 2.0F * point.carried[i] + batch.weight[i]);
}

// By lane: the largest impulse of a point beyond its load.
Lane blows_of(const SoftBatch& batch) {
  Lane beyond{};
  for (const SoftPoint& point : points_of(batch)) {
    for (std::size_t i = 0; i < k_lanes; ++i) {
      beyond[i] =
          std::max(beyond[i], point.impulse[i] - (2.0F * point.carried[i] + batch.weight[i]));
    }
  }
  return beyond;
}

void add_turn(SoftVector& velocity, const Lane3& turn, std::size_t i, float impulse) {
  for (std::size_t k = 0; k < 3; ++k) velocity[4 + k] += impulse * turn[k][i];
}

void add_shift(SoftVector& velocity, const Lane3& direction, std::size_t i, float change_mps) {
  for (std::size_t k = 0; k < 3; ++k) velocity[k] += change_mps * direction[k][i];
}

void push_back(const SoftBatch& batch, std::size_t i, const Lane3& direction, const SoftRow& row,
               float impulse, SoftVector& a, SoftVector& b) {
  add_shift(a, direction, i, -(impulse * batch.inverse_mass_a[i]));
  add_shift(b, direction, i, impulse * batch.inverse_mass_b[i]);
  add_turn(a, row.turn_a, i, -impulse);
  add_turn(b, row.turn_b, i, impulse);
}

// What is fixed has no inverse mass or inertia: its velocity stays zero.
void drop_lane(SoftBatch& batch, std::size_t i, SoftVector& a, SoftVector& b) {
  float all = 0.0F, kept = 0.0F;
  for (SoftPoint& point : std::span(batch.point).first(static_cast<std::size_t>(batch.points))) {
    const float load = load_at(batch, point, i);
    push_back(batch, i, batch.normal, point.row, point.impulse[i] - load, a, b);
    all += point.impulse[i];
    kept += load;
    point.impulse[i] = load;
  }
  const float share = 1.0F - kept / all;
  for (std::size_t k = 0; k < 2; ++k) {
    const float dropped = share * batch.friction_impulse[k][i];
    push_back(batch, i, batch.tangent[k], batch.friction_row[k], dropped, a, b);
    batch.friction_impulse[k][i] -= dropped;
  }
  const float dropped = share * batch.twist_impulse[i];
  add_turn(a, batch.twist_a, i, -dropped);
  add_turn(b, batch.twist_b, i, dropped);
  batch.twist_impulse[i] -= dropped;
}

}  // namespace

bool soft_has_blow(std::span<const SoftBatch> batches) {
  return std::ranges::any_of(batches, [](const SoftBatch& batch) {
    return std::ranges::any_of(blows_of(batch), [](float beyond) { return beyond > 0.0F; });
  });
}

void soft_drop_blows(std::span<SoftBatch> batches, std::span<SoftVector> free_velocity) {
  for (SoftBatch& batch : batches) {
    const Lane beyond = blows_of(batch);
    for (std::size_t i = 0; i < k_lanes; ++i) {
      if (!(beyond[i] > 0.0F)) continue;
      drop_lane(batch, i, free_velocity[static_cast<std::size_t>(batch.body_a[i])],
                free_velocity[static_cast<std::size_t>(batch.body_b[i])]);
    }
    for (SoftPoint& point : std::span(batch.point).first(static_cast<std::size_t>(batch.points))) {
      point.carried = point.impulse;
    }
  }
}

}  // namespace ourengine
