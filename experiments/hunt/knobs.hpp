// Knobs of a trial, within the ranges that the adapter states.
#pragma once

#include <cstdint>

#include "experiments/hunt/trial.hpp"

namespace brickbench::hunt {

// Turns none in most trials, else one of the engine's knobs: within a factor of ten of its default,
// or an end of its range where that is near. Depends on seed, case and engine alone.
void draw_knob(Trial& trial, const Catalogues& catalogues, std::uint64_t seed,
               std::uint64_t case_number);

}  // namespace brickbench::hunt
