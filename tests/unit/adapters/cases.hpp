// Small worlds and a runner for the tests of single engines.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "adapters/seam/adapter.hpp"

namespace brickbench::testing {

inline constexpr double k_g_mps2 = 9.81;
inline constexpr double k_density_kgpm3 = 2000.0;

inline State at(double x, double y, double z) {
  State state;
  state.position_m = {x, y, z};
  return state;
}

inline Body brick(State initial, Eigen::Vector3d half_extents_m = {0.1, 0.05, 0.05}) {
  return solid_body("brick", BoxShape{half_extents_m}, k_density_kgpm3, initial);
}

inline Body floor_box() { return fixed_body("floor", BoxShape{{50.0, 50.0, 1.0}}, at(0, 0, -1)); }

// Builds; a refusal fails the test.
inline std::unique_ptr<Simulation> make(const Adapter& adapter, const World& world,
                                        const Settings& settings) {
  auto built = build(adapter, world, settings);
  if (!built) {
    ADD_FAILURE() << adapter.name << "/" << settings.variant << ": " << built.error().reason;
    return nullptr;
  }
  return std::move(*built);
}

inline std::vector<State> states_of(const Simulation& simulation, const World& world) {
  std::vector<State> states(world.bodies.size());
  simulation.read(states);
  return states;
}

inline void run(Simulation& simulation, int steps) {
  for (int i = 0; i < steps; ++i) {
    const auto done = simulation.step();
    ASSERT_TRUE(done) << "step " << i << ": " << done.error().reason;
  }
}

}  // namespace brickbench::testing
