// Perturbed starts: many runs of one scene that differ by less than anyone could measure.
#pragma once

#include "adapters/seam/world.hpp"
#include "experiments/run/plan.hpp"

namespace brickbench {

// Adds to the initial state of every body that can move the random numbers of (seed, body index,
// component) and of nothing else: every engine, step and knob gets the same start (common random
// numbers), and a body's start does not depend on how many bodies there are. Seed 0: no change.
void perturb(World& world, const Perturbation& perturbation, std::uint64_t seed);

// The random number itself: zero mean; standard deviation 1 (normal, Box-Muller) or half width 1
// (uniform). `component` 0..11: position, rotation vector, velocity, angular velocity.
double random_component(const std::string& distribution, std::uint64_t seed, std::size_t body,
                        std::size_t component);

}  // namespace brickbench
