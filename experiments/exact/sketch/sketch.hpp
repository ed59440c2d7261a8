// A drawing of a case's start, made from its world alone: what stands where, how it moves, what
// pulls.
#pragma once

#include <string>

#include "experiments/exact/cases/exact_case.hpp"

namespace brickbench::exact {

// The run's bodies at their start as SVG, seen along the axis in which least happens: velocities
// and spins as arrows, gravity, the applied force half-way through the run, the centre's exact path
// where the case has a closed form, a scale bar, sizes, masses and laws. The background is
// transparent and the strokes are of middle tone, for light pages and dark ones.
std::string sketch_svg(const ExactCase& exact_case, const ExactRun& run);

// The start of a scene that is no case, the same way; forces are those that its bodies would feel
// half-way through duration_s if nothing turned.
std::string sketch_svg(const std::string& title, double duration_s, const Scene& scene);

}  // namespace brickbench::exact
