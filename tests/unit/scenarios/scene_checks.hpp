// Helpers of the scenes' tests: an overlap check of their own, and a textual image of a scene.
#pragma once

#include <string>
#include <vector>

#include "experiments/scenarios/scenario.hpp"

namespace brickbench::testing {

// Greatest overlap (m, <= 0 if none) between any two bodies of the initial state, at least one of
// which can move, from the separations along face normals and edge directions; `where` names the
// pair. A sphere counts as the box around it. An upper bound for boxes that are not parallel.
double deepest_overlap_m(const World& world, std::string& where);

// Every number of the scene as text: two scenes are equal if and only if their images are.
std::string image(const Scene& scene);

// The scenario of that name; fails the test if there is none.
Scenario scenario_named(const std::string& name);

// The scene, or a failed test with the reason.
Scene built(const std::string& scenario, const ParameterValues& values = {});

// The reason of the refusal, or "" with a failed test if the scene was built.
std::string refusal(const std::string& scenario, const ParameterValues& values);

double kinetic_energy_j(const World& world);
double potential_energy_j(const World& world);
double moving_mass_kg(const World& world);

}  // namespace brickbench::testing
