#include "experiments/hunt/bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "adapters/seam/shape.hpp"
#include "experiments/hunt/extent.hpp"
#include "experiments/metrics/mechanics.hpp"

namespace brickbench::hunt {

Fastest::Fastest(const World& world) : world_(world), speeds_mps_(world.bodies.size(), 0.0) {}

void Fastest::see(std::span<const State> states) {
  for (std::size_t i = 0; i < states.size(); ++i) {
    speeds_mps_[i] = std::max(speeds_mps_[i], fastest_point_mps(world_.bodies[i], states[i]));
  }
}

double first_order_energy_j(const World& world, const Fastest& fastest, double step_s) {
  const double fall_mps = world.gravity_mps2.norm() * step_s;
  double sum_j = 0.0;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    if (world.bodies[i].fixed) continue;
    sum_j += world.bodies[i].mass_kg * fall_mps * (fastest.of(i) + fall_mps);
  }
  return sum_j;
}

double kinetic_j(const World& world, std::span<const State> states) {
  double sum_j = 0.0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!world.bodies[i].fixed) sum_j += kinetic_energy_j(world.bodies[i], states[i]);
  }
  return sum_j;
}

double edge_energy_j(const World& world) {
  double sum_j = 0.0;
  for (const Body& body : world.bodies) {
    if (!body.fixed) sum_j += body.mass_kg * world.gravity_mps2.norm() * thinnest_m(body.shape);
  }
  return sum_j;
}

double height_energy_j(const World& world, std::span<const State> states) {
  const double g_mps2 = world.gravity_mps2.norm();
  if (g_mps2 == 0.0) return 0.0;
  const Eigen::Vector3d up = -world.gravity_mps2 / g_mps2;
  double lowest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (world.bodies[i].fixed && !is_half_space(world.bodies[i].shape)) {
      continue;
    }
    lowest_m = std::min(lowest_m, up.dot(states[i].position_m) - reach_m(world.bodies[i].shape));
  }
  double sum_j = 0.0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (world.bodies[i].fixed) continue;
    sum_j += world.bodies[i].mass_kg * g_mps2 * (up.dot(states[i].position_m) - lowest_m);
  }
  return sum_j;
}

double soft_time_s(const Motion& motion) {
  if (!motion.scheme || !motion.scheme->compliant()) return 0.0;
  const CompliantContact& contact = *motion.scheme->compliant();
  const double least_s = contact.time_constant_at_least_two_steps ? 2.0 * motion.step_s : 0.0;
  return std::max(contact.time_constant_s, least_s);
}

double rounding_speed_mps(const Motion& motion) {
  constexpr double k_last_bits = 8.0;
  double largest_m = 0.0;
  for (std::size_t i = 0; i < motion.states.front().size(); ++i) {
    const Body& body = motion.scene.world.bodies[i];
    if (body.fixed) continue;
    largest_m = std::max(
        largest_m, motion.states.front()[i].position_m.cwiseAbs().maxCoeff() + reach_m(body.shape));
  }
  return k_last_bits * std::numeric_limits<double>::epsilon() * largest_m / motion.step_s;
}

double soft_depth_m(const Motion& motion) {
  const double time_s = soft_time_s(motion);
  return motion.scene.world.gravity_mps2.norm() * time_s * time_s;
}

void Worst::see(Breach candidate) {
  if (!(candidate.observed > candidate.allowed)) return;
  if (worst_ && worst_->excess() >= candidate.excess()) return;
  worst_ = std::move(candidate);
}

std::optional<Breach> Worst::breach(const Motion& motion) const {
  std::optional<Breach> found = worst_;
  if (found) found->time_s = static_cast<double>(found->step) * motion.step_s;
  return found;
}

}  // namespace brickbench::hunt
