#include "experiments/hunt/cause.hpp"

#include <fmt/format.h>

#include <array>
#include <set>

namespace brickbench::hunt {
namespace {

// brick_length_m and brick_height_m are sizes, spin_x_radps and spin_y_radps one spin.
std::string kind_of(std::string name) {
  const bool fall = name.starts_with("drop_");
  for (const std::string_view edge : {"_length_m", "_thickness_m", "_height_m"}) {
    if (!fall && name.ends_with(edge)) return name.substr(0, name.size() - edge.size()) + "_size";
  }
  for (const std::string_view axis : {"_x", "_y", "_z"}) {
    const auto at = name.find(axis);
    if (at == std::string::npos) continue;
    const bool ends = at + axis.size() == name.size() || name[at + axis.size()] == '_';
    if (ends) return name.erase(at, axis.size());
  }
  return name;
}

}  // namespace

std::string needed(const Trial& shrunk) {
  std::set<std::string> kinds;
  for (const auto& [name, value] : shrunk.parameters) kinds.insert(kind_of(name));
  for (const auto& [name, value] : shrunk.knobs) kinds.insert("knob " + name);
  if (kinds.empty()) return "nothing";
  return fmt::format("{}", fmt::join(kinds, ", "));
}

std::string cause_key(std::string_view oracle, const Trial& shrunk) {
  return fmt::format("{} | {} | {} | {}", oracle, shrunk.engine.label(), shrunk.scene,
                     needed(shrunk));
}

double burden(const Trial& trial, const Catalogues& catalogues) {
  const auto scene = scene_of(trial, catalogues);
  const double bodies = scene ? static_cast<double>(scene->world.bodies.size()) : 0.0;
  return 100.0 * bodies + 10.0 * static_cast<double>(trial.parameters.size() + trial.knobs.size()) +
         static_cast<double>(trial.steps) / (static_cast<double>(trial.steps) + 1.0);
}

}  // namespace brickbench::hunt
