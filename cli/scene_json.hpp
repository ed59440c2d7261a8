// A scene, and what is suspicious about it, as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/scenes/scene_facts.hpp"

namespace brickbench {

// "brick", "projectile", "" or "fixed": what body `i` is in the scene.
std::string_view role_word(const Scene& scene, std::size_t i);

// kg; of all bodies that can move.
double moving_mass_kg(const World& world);

nlohmann::ordered_json scene_json(const Scenario& scenario, const ParameterValues& values,
                                  const Scene& scene);
nlohmann::ordered_json doubts_json(const std::string& scene, const std::vector<Doubt>& found,
                                   double longest_step, int exit_code);

}  // namespace brickbench
