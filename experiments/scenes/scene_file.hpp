// Scenes from files: a TOML file as a scenario, with parameters like those of the compiled ones.
// docs/scene.md describes the file.
#pragma once

#include <filesystem>
#include <string>

#include "experiments/input/input.hpp"
#include "experiments/scenarios/scenario.hpp"

namespace brickbench {

// The scenario that the file says, named by the file's stem. Everything in it is known and in
// range, and it makes a scene at its defaults; the reasons of its make() at other values begin with
// file:line:column too.
Checked<Scenario> read_scene(const std::filesystem::path& file);
Checked<Scenario> parse_scene(const std::string& text, const std::filesystem::path& file);

// Whether a name of a scenario means a file: it ends in ".toml".
bool is_scene_file(std::string_view name);

// Bodies overlap by more than this share of the smaller one's greatest half extent, not by
// rounding: what penetration_depth_m() may be off by.
inline constexpr double k_overlap_share = 1e-7;

}  // namespace brickbench
