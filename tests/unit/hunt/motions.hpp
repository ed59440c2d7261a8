// Motions made by hand: what an engine could have answered.
#pragma once

#include <functional>

#include "experiments/hunt/motion.hpp"

namespace brickbench::hunt::testing {

inline Scheme semi_implicit() {
  Scheme scheme;
  scheme.contact = ImpulseContact{};
  return scheme;
}

// One body, box or ball, on its own or above the ground.
inline Scene one_body(const Shape& shape, const State& initial, bool ground, ContactLaw law) {
  Scene scene;
  scene.world.law = law;
  if (ground) scene.world.bodies.push_back(ground_plane());
  scene.world.bodies.push_back(solid_body("brick", shape, 1000.0, initial));
  scene.length_scale_m = 0.1;
  return scene;
}

// The states that `advance` makes of the ones before, step after step; without wrenches.
inline Motion motion_of(const Scene& scene, double step_s, std::size_t steps,
                        const std::function<void(std::vector<State>&, std::size_t)>& advance) {
  Motion motion;
  motion.scene = scene;
  motion.step_s = step_s;
  motion.scheme = semi_implicit();
  std::vector<State> states;
  for (const Body& body : scene.world.bodies) states.push_back(body.initial);
  motion.states.push_back(states);
  for (std::size_t step = 1; step <= steps; ++step) {
    advance(states, step);
    motion.states.push_back(states);
    motion.wrenches.emplace_back(states.size());
  }
  return motion;
}

}  // namespace brickbench::hunt::testing
