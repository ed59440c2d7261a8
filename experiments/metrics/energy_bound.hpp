// Whether a run has more energy than anything could have given it: docs/metrics.md, section
// blown up.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/metrics/compensated_sum.hpp"
#include "experiments/metrics/metric.hpp"

namespace brickbench {

// Contact, friction and impact only take energy, so that of the bodies that move obeys
//   X = T + U - T(0) - U(0) - W <= 0,   U = -sum m g.x,   W the work of the outer wrenches.
// A sound engine misses this by its scheme's error, which is a share of the energy in play:
//   S = T(0) + |W| + F + M |g| L + M (d / h)^2 / 2
// with |W| the outer work without signs, F the largest sum of m g.(x - x(0)) over the bodies that
// fell, M the mass that moves, L the smallest edge of a brick, and d the deepest overlap of the
// initial states, which an engine may remove within one step h by a velocity of d / h.
// The run has blown up at the first step with X > k_blown_up_share S. Until then the kinetic energy
// is at most (k_blown_up_share + 1) S, so that after the time t no body of mass m is further from
// its start than L + d + t sqrt(2 (k_blown_up_share + 1) S / m), where L + d is what overlaps that
// are moved apart may add: a body beyond that has blown up too, whatever its velocity is said to
// be.
class EnergyBound {
 public:
  struct Excess {
    std::size_t body = 0;     // that gained most since the start, or is too far away
    bool is_too_far = false;  // else there is too much energy
    double found = 0.0;       // X in J, or the distance in m
    double bound = 0.0;       // the most that is no blow-up
  };

  EnergyBound(const Scene& scene, double step_s);
  // Called for step 0 and after every step, with finite states.
  std::optional<Excess> observe(const Sample& sample);
  // The largest X / S so far: at most 0 for a run that makes no energy.
  double largest_share() const { return largest_share_; }

 private:
  double energy_j(std::size_t body, const State& state) const;
  void begin(std::span<const State> states);
  void add_work(const Sample& sample);
  std::optional<Excess> too_far(const Sample& sample, double scale_j) const;

  World world_;
  double step_s_;
  double lift_m_;
  double mass_kg_ = 0.0;  // that moves
  std::vector<State> start_;
  std::vector<State> before_;
  std::vector<double> start_j_;  // (bodies) kinetic and potential
  double depth_m_ = 0.0;         // d
  double fixed_scale_j_ = 0.0;   // the terms of S that do not change
  CompensatedSum work_j_;
  double absolute_work_j_ = 0.0;
  double fallen_j_ = 0.0;
  double largest_share_ = 0.0;
};

// X = S means that as much again as was in play came from nowhere. Schemes of first order, soft
// contact and pushed overlaps are wrong by a share of S; three times S is no error of a scheme.
inline constexpr double k_blown_up_share = 3.0;

}  // namespace brickbench
