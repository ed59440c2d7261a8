#include "tests/determinism/fingerprint.hpp"

#include <fmt/core.h>

#include <functional>

namespace brickbench::testing {
namespace {

constexpr double k_step_s = 0.001;
constexpr int k_steps = 200;

std::uint64_t hash_run(Simulation& simulation, std::size_t bodies, std::string& what) {
  std::vector<State> states(bodies);
  std::uint64_t hash = 0;
  for (int k = 1; k <= k_steps; ++k) {
    if (const auto stepped = simulation.step(); !stepped) {
      what += fmt::format(", failed at step {}: {}", k, stepped.error().reason);
      return hash ^ std::hash<std::string>{}(stepped.error().reason);
    }
    simulation.read(states);
    hash = hash_states(states, hash);
  }
  return hash;
}

}  // namespace

World hit_wall(double friction) {
  const BoxShape brick{{0.1, 0.05, 0.05}};
  World world;
  world.law.friction = friction;
  State state;
  state.position_m = {0, 0, -1};
  world.bodies.push_back(fixed_body("floor", BoxShape{{5, 5, 1}}, state));
  for (int course = 0; course < 3; ++course) {
    for (int column = 0; column < 3; ++column) {
      state.position_m = {0.2 * (column - 1), 0.0, 0.05 + 0.1 * course};
      world.bodies.push_back(
          solid_body(fmt::format("brick {} {}", course, column), brick, 2000.0, state));
    }
  }
  state.position_m = {0.03, -0.15, 0.16};
  world.bodies.push_back(solid_body("thrown", brick, 2000.0, state));
  world.bodies.back().initial.velocity_mps = {0, 8, 0};
  world.bodies.back().initial.angular_velocity_radps = {1, 2, 3};
  return world;
}

std::uint64_t fingerprint(const Adapter& adapter, const std::string& variant, const World& world,
                          std::string& what) {
  Settings settings;
  settings.step_s = k_step_s;
  settings.variant = variant;
  auto simulation = build(adapter, world, settings);
  what = simulation ? "ran" : simulation.error().reason;
  return simulation ? hash_run(**simulation, world.bodies.size(), what) : 0;
}

std::uint64_t wall_fingerprint(const Adapter& adapter, const std::string& variant,
                               std::string& what) {
  const std::uint64_t hash = fingerprint(adapter, variant, hit_wall(0.5), what);
  if (hash != 0) return hash;
  const std::string refusal = what;
  const std::uint64_t smooth = fingerprint(adapter, variant, hit_wall(0.0), what);
  what = fmt::format("without friction: {}; with friction: {}", what, refusal);
  return smooth;
}

}  // namespace brickbench::testing
