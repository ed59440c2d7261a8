// A scene as a scene file.
#pragma once

#include <string>

#include "experiments/scenarios/scenario.hpp"

namespace brickbench {

// What stands at the head of the file.
struct SceneHead {
  std::string title;    // not empty
  std::string comment;  // one line; may be empty
  double duration_s = 1.0;
};

// The file: every body by itself with all its numbers, without parameters. Read back it gives the
// same scene to the bit, but for the numbering of surfaces that no law tells apart. Fault::invalid
// for what a file cannot say: two bodies of one name, bricks or projectiles that are not in the
// order of the bodies.
Expected<std::string> scene_text(const Scene& scene, const SceneHead& head);

}  // namespace brickbench
