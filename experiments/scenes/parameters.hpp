// The table `parameters` of a scene file.
#pragma once

#include <vector>

#include "experiments/input/input.hpp"
#include "experiments/scenarios/scenario.hpp"
#include "experiments/scenes/scope.hpp"

namespace brickbench {

// In the order of the file; throws InputError.
std::vector<Parameter> scene_parameters(const InputValue& table);

// The names that the parameters give to formulas, at these values (complete): numbers and truths
// (0 or 1) by their own names; of a word `bond` with the choices running and stack the two numbers
// bond_running and bond_stack, one of which is 1. `table` is that of the file. Throws InputError.
Scope scope_of(const std::vector<Parameter>& parameters, const ParameterValues& values,
               const InputValue& table);

}  // namespace brickbench
