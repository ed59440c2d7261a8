// Drawings: parameters of a case at random over its stated domain.
#pragma once

#include <cstdint>

#include "experiments/exact/cases/exact_case.hpp"

namespace brickbench::exact {

// Digits of a drawn value: short enough to be typed, and as good as any for the arithmetic.
inline constexpr int k_drawn_digits = 3;
// Bodies times steps of a drawn run; what bounds its cost.
inline constexpr double k_most_body_steps = 8000.0;

// The index-th drawing of the case under a seed; depends on these three alone. One value in six is
// the least that the parameter may have, one the largest; the others are spread evenly, over the
// logarithm where the range spans a decade. Without an own time of the case the duration is half
// to twice the default. The step is such that the run has ten steps or more and no more than the
// cost allows, or the longest of the range; where the case measures time in steps, it is any. The
// drawing may lie outside the domain: exact_case.outside says so.
ParameterValues draw(const ExactCase& exact_case, std::uint64_t seed, std::size_t index);

}  // namespace brickbench::exact
