// Images: a scene and its mirrored, turned or shifted image move alike: docs/hunt.md, section
// image.
#pragma once

#include "adapters/seam/adapter.hpp"
#include "experiments/hunt/oracles.hpp"

namespace brickbench::hunt {

// Runs the images, and the scene twice more from starts that differ in the seventh digit: what
// these do to the motion, an image may do ten times. Scenes of one or two moving bodies without
// blows and pushes; nullopt for others.
std::optional<Breach> image_breach(const Adapter& adapter, const Settings& settings,
                                   const Motion& motion);

}  // namespace brickbench::hunt
