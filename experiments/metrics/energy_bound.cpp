#include "experiments/metrics/energy_bound.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/metrics/deepest_overlap.hpp"
#include "experiments/metrics/mechanics.hpp"

namespace brickbench {
namespace {

// Overlaps of the initial states below this share of the smallest edge are rounding.
constexpr double k_rounding_share = 1e-9;

}  // namespace

EnergyBound::EnergyBound(const Scene& scene, double step_s)
    : world_(scene.world), step_s_(step_s), lift_m_(scene.length_scale_m) {
  for (const Body& body : world_.bodies) mass_kg_ += body.fixed ? 0.0 : body.mass_kg;
}

double EnergyBound::energy_j(std::size_t body, const State& state) const {
  const Body& fact = world_.bodies[body];
  return kinetic_energy_j(fact, state) + potential_energy_j(fact, state, world_.gravity_mps2);
}

void EnergyBound::begin(std::span<const State> states) {
  start_.assign(states.begin(), states.end());
  depth_m_ = std::max(DeepestOverlap(world_).find(states).depth_m, k_rounding_share * lift_m_);
  const double push_mps = depth_m_ / step_s_;
  fixed_scale_j_ = mass_kg_ * (world_.gravity_mps2.norm() * lift_m_ + 0.5 * push_mps * push_mps);
  for (std::size_t i = 0; i < states.size(); ++i) {
    const bool fixed = world_.bodies[i].fixed;
    start_j_.push_back(fixed ? 0.0 : energy_j(i, states[i]));
    if (!fixed) fixed_scale_j_ += kinetic_energy_j(world_.bodies[i], states[i]);
  }
}

void EnergyBound::add_work(const Sample& sample) {
  for (std::size_t i = 0; i < sample.wrenches.size(); ++i) {
    if (is_zero(sample.wrenches[i]) || world_.bodies[i].fixed) continue;
    const double of_body_j =
        work_of_step_j(sample.wrenches[i], before_[i], sample.states[i], step_s_);
    work_j_ += of_body_j;
    absolute_work_j_ += std::abs(of_body_j);
  }
}

std::optional<EnergyBound::Excess> EnergyBound::observe(const Sample& sample) {
  if (start_.empty()) {
    begin(sample.states);
    before_ = start_;
    return std::nullopt;
  }
  add_work(sample);
  before_.assign(sample.states.begin(), sample.states.end());
  Excess excess;
  CompensatedSum gained_j;
  double fallen_j = 0.0;
  double most_j = 0.0;
  for (std::size_t i = 0; i < sample.states.size(); ++i) {
    const Body& body = world_.bodies[i];
    if (body.fixed) continue;
    const State& state = sample.states[i];
    const double gain_j = energy_j(i, state) - start_j_[i];
    gained_j += gain_j;
    fallen_j += std::max(0.0, potential_energy_j(body, start_[i], world_.gravity_mps2) -
                                  potential_energy_j(body, state, world_.gravity_mps2));
    if (gain_j > most_j) {
      most_j = gain_j;
      excess.body = i;
    }
  }
  fallen_j_ = std::max(fallen_j_, fallen_j);
  const double scale_j = fixed_scale_j_ + absolute_work_j_ + fallen_j_;
  excess.found = gained_j.value() - work_j_.value();
  excess.bound = k_blown_up_share * scale_j;
  largest_share_ = std::max(largest_share_, excess.found / scale_j);
  // Not a number, where infinities met, is no sound energy either.
  if (!(excess.found <= excess.bound)) return excess;
  return too_far(sample, scale_j);
}

std::optional<EnergyBound::Excess> EnergyBound::too_far(const Sample& sample,
                                                        double scale_j) const {
  for (std::size_t i = 0; i < sample.states.size(); ++i) {
    const Body& body = world_.bodies[i];
    if (body.fixed) continue;
    const double speed_mps = std::sqrt(2.0 * (k_blown_up_share + 1.0) * scale_j / body.mass_kg);
    const double reach_m = lift_m_ + depth_m_ + sample.time_s * speed_mps;
    const double way_m = (sample.states[i].position_m - start_[i].position_m).stableNorm();
    if (!(way_m <= reach_m) || !std::isfinite(reach_m)) return Excess{i, true, way_m, reach_m};
  }
  return std::nullopt;
}

}  // namespace brickbench
