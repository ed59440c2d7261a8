#include "cli/validate_scenes.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/complain.hpp"
#include "cli/json_number.hpp"
#include "cli/verbs.hpp"
#include "experiments/exact/validation/metamorphic.hpp"
#include "experiments/exact/validation/stable_step.hpp"
#include "experiments/run/scene_choice.hpp"

namespace brickbench {
namespace {

using Json = nlohmann::ordered_json;

// All compiled scenes, or the one of that name, compiled or of a file; none after a complaint.
std::vector<SceneChoice> scenes_named(const Catalogues& catalogues, const std::string& name) {
  std::vector<SceneChoice> scenes;
  if (name == "all") {
    for (const Scenario& scenario : catalogues.scenarios) scenes.push_back({&scenario, nullptr});
    return scenes;
  }
  auto choice = choose_scene(name, "scene " + name, catalogues);
  if (choice)
    scenes.push_back(std::move(*choice));
  else
    complain(choice.error().text(), k_exit_bad_input);
  return scenes;
}

Json symmetry_json(const exact::MetamorphicResult& result, const EngineVariant& engine,
                   const std::string& scene) {
  auto growth = Json::array();
  for (const exact::GrowthSample& sample : result.growth) {
    growth.push_back(
        {{"time_s", sample.time_s}, {"difference_m", json_number(sample.difference_m)}});
  }
  return {{"id", engine.label() + ':' + scene + ':' + result.symmetry},
          {"scene", scene},
          {"outcome", result.outcome},
          {"reason", result.reason},
          {"rate_per_s", json_number(result.rate_per_s)},
          {"growth", growth}};
}

}  // namespace

int compare_symmetries(const std::vector<EngineVariant>& engines, const Catalogues& catalogues,
                       const std::string& scene_name, const ParameterValues& given, bool json) {
  constexpr double k_step_s = 0.002, k_time_s = 1.0;
  const auto steps = static_cast<std::size_t>(k_time_s / k_step_s);
  const auto scenes = scenes_named(catalogues, scene_name);
  if (scenes.empty()) return k_exit_bad_input;
  auto results = Json::array();
  if (!json) {
    fmt::print("{:<14} {:<18} {:<22} {:>12} {:>12} {:>10}\n", "scene", "engine", "image",
               "after 1/16", "at the end", "rate 1/s");
  }
  for (const SceneChoice& choice : scenes) {
    const Scenario* scenario = choice.scenario;
    const auto scene = build(*scenario, given);
    if (!scene) return complain(scene.error());
    for (const EngineVariant& engine : engines) {
      Settings settings;
      settings.step_s = k_step_s;
      settings.variant = engine.variant;
      for (const exact::Symmetry& symmetry : exact::symmetries()) {
        const auto result = exact::compare_image(*find_adapter(catalogues, engine.engine), settings,
                                                 *scene, symmetry, steps);
        if (json) {
          results.push_back(symmetry_json(result, engine, scenario->name));
          continue;
        }
        fmt::print("{:<14} {:<18} {:<22} ", scenario->name, engine.label(), symmetry.name);
        if (result.outcome != "ok") {
          fmt::print("{}: {}\n", result.outcome, result.reason);
        } else {
          fmt::print("{:>12.3g} {:>12.3g} {:>10.3g}\n", result.growth.front().difference_m,
                     result.growth.back().difference_m, result.rate_per_s);
        }
      }
    }
  }
  if (json) fmt::print("{}\n", results.dump(2));
  return k_exit_fine;
}

int search_stable_steps(const std::vector<EngineVariant>& engines, const Catalogues& catalogues,
                        const std::string& scene_name, bool json) {
  const auto scenes = scenes_named(catalogues, scene_name);
  if (scenes.empty()) return k_exit_bad_input;
  auto results = Json::array();
  if (!json) {
    fmt::print("{:<14} {:<18} {:>12} {:>14}  what happens then\n", "scene", "engine", "stable s",
               "not stable s");
  }
  for (const SceneChoice& choice : scenes) {
    const Scenario* scenario = choice.scenario;
    const Scene scene = build(*scenario, {}).value();
    exact::StableStepSearch search;
    search.drift_limit_m = exact::quarter_of_smallest_m(scene.world);
    for (const EngineVariant& engine : engines) {
      Settings settings;
      settings.variant = engine.variant;
      const auto result = exact::largest_stable_step(*find_adapter(catalogues, engine.engine),
                                                     settings, scene, search);
      if (json) {
        results.push_back({{"id", engine.label() + ':' + scenario->name},
                           {"scene", scenario->name},
                           {"outcome", result.outcome},
                           {"reason", result.reason},
                           {"drift_limit_m", search.drift_limit_m},
                           {"stable_s", json_number(result.stable_s)},
                           {"unstable_s", json_number(result.unstable_s)},
                           {"failure", result.failure}});
      } else if (result.outcome != "ok") {
        fmt::print("{:<14} {:<18} {}: {}\n", scenario->name, engine.label(), result.outcome,
                   result.reason);
      } else {
        fmt::print("{:<14} {:<18} {:>12} {:>14}  {}\n", scenario->name, engine.label(),
                   result.stable_s > 0.0 ? fmt::format("{:.4g}", result.stable_s) : "none",
                   result.unstable_s > 0.0 ? fmt::format("{:.4g}", result.unstable_s) : "none",
                   result.failure);
      }
    }
  }
  if (json) fmt::print("{}\n", results.dump(2));
  return k_exit_fine;
}

}  // namespace brickbench
