#include "experiments/run/perturb.hpp"

#include <xxhash.h>

#include <array>
#include <cmath>
#include <numbers>

namespace brickbench {
namespace {

// Uniform in (0, 1): 53 bits of a hash of the counters, centred in their cell, so never 0 or 1.
double uniform01(std::uint64_t seed, std::size_t body, std::size_t component, std::uint64_t draw) {
  const std::array<std::uint64_t, 4> counters = {seed, body, component, draw};
  const std::uint64_t hash = XXH3_64bits(counters.data(), sizeof counters);
  return (static_cast<double>(hash >> 12) + 0.5) * 0x1p-52;
}

Eigen::Vector3d random_vector(const Perturbation& p, std::uint64_t seed, std::size_t body,
                              std::size_t first) {
  return {random_component(p.distribution, seed, body, first),
          random_component(p.distribution, seed, body, first + 1),
          random_component(p.distribution, seed, body, first + 2)};
}

}  // namespace

double random_component(const std::string& distribution, std::uint64_t seed, std::size_t body,
                        std::size_t component) {
  const double u = uniform01(seed, body, component, 0);
  if (distribution == "uniform") return 2.0 * u - 1.0;
  const double v = uniform01(seed, body, component, 1);
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
}

void perturb(World& world, const Perturbation& p, std::uint64_t seed) {
  if (seed == 0) return;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    if (world.bodies[i].fixed) continue;
    State& state = world.bodies[i].initial;
    state.position_m += p.position_m * random_vector(p, seed, i, 0);
    state.velocity_mps += p.velocity_mps * random_vector(p, seed, i, 6);
    state.angular_velocity_radps += p.angular_velocity_radps * random_vector(p, seed, i, 9);
    const Eigen::Vector3d rotation = p.angle_rad * random_vector(p, seed, i, 3);
    const double angle_rad = rotation.norm();
    if (angle_rad == 0.0) continue;
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle_rad, rotation / angle_rad));
    state.orientation = (turn * state.orientation).normalized();
  }
}

}  // namespace brickbench
