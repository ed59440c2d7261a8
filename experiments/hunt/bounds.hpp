// What the oracles' bounds are made of: the sizes that a first-order scheme may be off by.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "experiments/hunt/oracles.hpp"

namespace brickbench::hunt {

// Of sums over a step in double precision, relative.
inline constexpr double k_rounding = 1e-12;
// Of momenta: what rounding leaves of a step in engines that count in single precision inside,
// whose velocities are 6e-8 apart.
inline constexpr double k_single_rounding = 1e-6;
// An energy that an iterative solver, stopped early, may be off by; of the largest kinetic energy
// and of the weight at the height of an edge. Stated, not fitted: what is below it is not news.
inline constexpr double k_energy_share = 0.01;

// The fastest that each body's fastest point has been so far.
class Fastest {
 public:
  explicit Fastest(const World& world);
  void see(std::span<const State> states);
  double of(std::size_t body) const { return speeds_mps_[body]; }

 private:
  const World& world_;
  std::vector<double> speeds_mps_;  // (bodies)
};

// J. Events inside a step are seen at its ends: sum of m g h v + m g^2 h^2, with v the fastest so
// far. A bounce that takes place up to a step early or late is off by that much.
double first_order_energy_j(const World& world, const Fastest& fastest, double step_s);
// J, of all moving bodies.
double kinetic_j(const World& world, std::span<const State> states);
// J. Sum of m g times each body's smallest edge.
double edge_energy_j(const World& world);
// J. Potential energy of all moving bodies over that of the lowest point of any.
double height_energy_j(const World& world, std::span<const State> states);

// Depth, m, to which a body sinks into another under its own weight where contacts are springs, for
// each body above it; 0 for engines whose contacts are hard.
double soft_depth_m(const Motion& motion);
// Time, s, that the contact springs of the engine need to stop a body; 0 where they are hard.
double soft_time_s(const Motion& motion);

// Speed, m/s, that is none: positions are rounded, and what pushes out an overlap of a few last
// bits in a step is not faster.
double rounding_speed_mps(const Motion& motion);

// Keeps the candidate whose observed value exceeds the allowed one most.
class Worst {
 public:
  void see(Breach candidate);
  // With its time; nullopt if nothing exceeded what was allowed.
  std::optional<Breach> breach(const Motion& motion) const;

 private:
  std::optional<Breach> worst_;
};

}  // namespace brickbench::hunt
