// The entries [[body]] of a scene file.
#pragma once

#include <map>
#include <string>

#include "experiments/input/input.hpp"
#include "experiments/scenarios/scenario.hpp"
#include "experiments/scenes/scope.hpp"

namespace brickbench {

// Where in the file the things of the scene come from, for messages.
struct SceneOrigins {
  std::vector<SourcePosition> bodies;   // (World::bodies)
  std::map<std::string, int> surfaces;  // as Body::surface numbers them, 0 for the unnamed
};

// Appends the bodies of the entries and all their copies to the scene, and to its bricks or
// projectiles. Throws InputError.
void add_bodies(const InputValue& entries, const Scope& scope, Scene& scene, SceneOrigins& origins);

}  // namespace brickbench
