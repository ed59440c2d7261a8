#include "experiments/exact/schemes/fall_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brickbench::exact {
namespace {

using Eigen::Vector3d;

constexpr double k_never_s = std::numeric_limits<double>::infinity();

struct Meeting {
  double time_s = k_never_s;
  double speed_mps = 0.0;
};

// gap + v t + a t^2 / 2 falls to zero; what overlaps and does not sink deeper starts at zero.
Meeting meeting(const FreeGap& gap, double left_s) {
  const double v = gap.velocity_mps, a = gap.acceleration_mps2;
  const double above_m = std::max(0.0, gap.gap_m);
  if (above_m == 0.0 && v <= 0.0) return {0.0, -v};
  const double square = v * v - 2.0 * a * above_m;
  if (square < 0.0) return {};
  const double speed_mps = std::sqrt(square);
  const double time_s = v < 0.0 ? 2.0 * above_m / (speed_mps - v) : -(v + speed_mps) / a;
  return time_s >= 0.0 && time_s <= left_s ? Meeting{time_s, speed_mps} : Meeting{};
}

bool bounces(const ImpulseContact& law, const ExactRun& run, const FreeGap& gap,
             const Meeting& met) {
  const double slowest_mps =
      std::max(law.restitution_threshold_mps,
               law.restitution_threshold_steps * run.step_s * run.world.gravity_mps2.norm());
  return gap.restitution > 0.0 && met.time_s < k_never_s && met.speed_mps > slowest_mps;
}

}  // namespace

FreeGap free_gap(const World& world, std::span<const Wrench> wrenches, const PointContact& contact,
                 std::span<const State> states) {
  FreeGap gap{.gap_m = contact.gap_m};
  gap.restitution = contact_law(world, contact.body_a, contact.body_b).restitution;
  const auto add = [&](std::size_t i, double sign) {
    const Body& body = world.bodies[i];
    if (body.fixed) {
      gap.with_fixed = true;
      return;
    }
    const Vector3d arm_m = contact.position_m - states[i].position_m;
    Vector3d velocity_mps = states[i].velocity_mps;
    if (!contact.central) velocity_mps += states[i].angular_velocity_radps.cross(arm_m);
    const double fall_mps2 = contact.normal.dot(world.gravity_mps2);
    gap.velocity_mps += sign * contact.normal.dot(velocity_mps);
    gap.acceleration_mps2 +=
        sign * (fall_mps2 + contact.normal.dot(wrenches[i].force_n) / body.mass_kg);
    gap.lag_mps2 += sign * fall_mps2;
  };
  add(contact.body_a, -1.0);
  add(contact.body_b, 1.0);
  if (!gap.with_fixed) gap.lag_mps2 = 0.0;
  return gap;
}

FreeFall free_fall(const ImpulseContact& law, const ExactRun& run, std::span<const Wrench> wrenches,
                   const std::vector<PointContact>& contacts, std::span<const State> states) {
  FreeFall fall;
  if (!law.bounces_before_touch) return fall;
  double bounce_s = k_never_s;
  double other_s = k_never_s;
  for (const PointContact& contact : contacts) {
    const FreeGap gap = free_gap(run.world, wrenches, contact, states);
    const Meeting met = meeting(gap, run.step_s);
    if (bounces(law, run, gap, met)) {
      bounce_s = std::min(bounce_s, met.time_s);
    } else if (met.time_s < k_never_s) {
      if (gap.with_fixed) return fall;
      if (met.speed_mps > 0.0) other_s = std::min(other_s, met.time_s);
    }
  }
  fall.falls = true;
  if (bounce_s < run.step_s && bounce_s <= other_s) fall.flight_s = bounce_s;
  return fall;
}

FallingTarget falling_target(const ImpulseContact& law, const ExactRun& run, const FreeGap& gap,
                             double left_s) {
  const double depth_m = std::max(0.0, -gap.gap_m);
  const double closing_m = std::max(0.0, gap.gap_m) - law.error_reduction * depth_m -
                           0.5 * left_s * left_s * gap.lag_mps2;
  const double closing_mps = std::min(-closing_m / left_s, law.max_correction_mps);
  const Meeting met = meeting(gap, left_s);
  if (!bounces(law, run, gap, met)) return {closing_mps, gap.with_fixed};
  const double rebound_mps =
      gap.restitution * met.speed_mps + (left_s - met.time_s) * gap.acceleration_mps2;
  if (!(rebound_mps > 0.0)) return {closing_mps, gap.with_fixed};
  return {std::max(closing_mps, rebound_mps), false};
}

}  // namespace brickbench::exact
