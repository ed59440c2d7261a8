// Draw: case number k of a hunt, from the seed and k alone.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "experiments/hunt/trial.hpp"

namespace brickbench::hunt {

// A case must be done in a moment: what a draw may cost at most.
struct DrawLimits {
  std::size_t bodies = 40;      // moving ones
  double body_steps = 12000.0;  // steps * bodies^1.3: the contacts of a heap grow faster than it
  std::size_t most_steps = 2000;
  std::size_t fewest_steps = 20;
};

// The scene, step and number of steps of case `number`; engine and knobs are left empty. nullopt
// where a hundred draws in a row made no scene within the limits. Parameters stay at their default
// with a probability of its own for each case; else they are 0, 1, an end of the range, or spread
// over the range: by decades where it spans many, about the default or over the whole of it.
std::optional<Trial> draw_scene(const std::vector<Scenario>& scenarios, std::uint64_t seed,
                                std::uint64_t number, const DrawLimits& limits = {});

// The same for one of these exact cases (ids): each parameter but the times is its default times a
// factor in 0.7 .. 1.4, or an end of that, within its range.
Trial draw_case(const std::vector<std::string>& cases, std::uint64_t seed, std::uint64_t number);

}  // namespace brickbench::hunt
