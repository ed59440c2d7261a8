// What acts on a scene of a file from outside: the entries [[blow]] and [[force]].
#pragma once

#include "experiments/input/input.hpp"
#include "experiments/scenarios/scenario.hpp"
#include "experiments/scenes/scope.hpp"

namespace brickbench {

// `file` is the whole file, whose bodies the scene has. Throws InputError.
void add_outer_loads(const InputValue& file, const Scope& scope, Scene& scene);

}  // namespace brickbench
