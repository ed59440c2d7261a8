// The laws of contact of a scene file: the table [law] and the entries [[pair]].
#pragma once

#include "experiments/scenes/bodies.hpp"

namespace brickbench {

// Sets World::law and World::exceptions; `file` is the whole file, whose bodies the scene has.
// Throws InputError.
void set_laws(const InputValue& file, const Scope& scope, const SceneOrigins& origins,
              World& world);

}  // namespace brickbench
