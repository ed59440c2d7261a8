#include "experiments/scenes/scene_file.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>

#include "adapters/seam/shape.hpp"
#include "experiments/metrics/deepest_overlap.hpp"
#include "experiments/record/file.hpp"
#include "experiments/scenes/bodies.hpp"
#include "experiments/scenes/laws.hpp"
#include "experiments/scenes/outer_loads.hpp"
#include "experiments/scenes/parameters.hpp"
#include "experiments/scenes/scene_facts.hpp"

namespace brickbench {
namespace {

const std::vector<std::string> k_scene_keys = {
    "title",  "duration_s", "gravity_mps2", "length_scale_m", "overlaps", "parameters",
    "define", "law",        "pair",         "body",           "blow",     "force"};

const InputValue& scene_part(const InputValue& file, const char* key) {
  const InputValue* value = file.find(key);
  if (value == nullptr) {
    reject({file.at.file, 0, 0}, fmt::format("a scene needs the key '{}'", key));
  }
  return *value;
}

bool overlaps_allowed(const InputValue& file) {
  const InputValue* value = file.find("overlaps");
  if (value == nullptr) return false;
  const std::string& word = filled_text(*value, "overlaps");
  if (word != "allowed" && word != "refused") {
    reject(value->at, fmt::format("overlaps is no such word: '{}'{}", word,
                                  known_names(word, {"allowed", "refused"})));
  }
  return word == "allowed";
}

// Each body by itself, so that a complaint points at its entry.
void check_bodies(const World& world, const SceneOrigins& origins) {
  World alone;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    alone.bodies = {world.bodies[i]};
    if (const auto valid = validate(alone); !valid) {
      reject(origins.bodies[i], valid.error().reason);
    }
  }
}

// The pair that overlaps most, if any does by more than rounding. Looking at all pairs is dear, so
// that they are only looked at where the deepest overlap is too deep for the smallest body.
std::optional<Touch> deepest_overlap(const World& world) {
  std::vector<State> states;
  double smallest_m = std::numeric_limits<double>::infinity();
  for (const Body& body : world.bodies) {
    states.push_back(body.initial);
    smallest_m = std::min(smallest_m, half_extents_m(body.shape).maxCoeff());
  }
  const double depth_m = DeepestOverlap(world).find(states).depth_m;
  if (!(depth_m > k_overlap_share * smallest_m)) return std::nullopt;
  std::optional<Touch> deepest;
  for (const Touch& touch : touches_at_start(world)) {
    if (!touch.overlap || (deepest && deepest->depth_m >= touch.depth_m)) continue;
    deepest = touch;
  }
  return deepest;
}

void check_overlaps(const World& world, const SceneOrigins& origins) {
  const auto deepest = deepest_overlap(world);
  if (!deepest) return;
  reject(origins.bodies[deepest->body_b],
         fmt::format("'{}' and '{}' overlap by {:.4g} m at the start; a scene that means it says "
                     "overlaps = \"allowed\"",
                     world.bodies[deepest->body_a].name, world.bodies[deepest->body_b].name,
                     deepest->depth_m));
}

void set_length_scale(const InputValue& file, const Scope& scope, Scene& scene) {
  double thinnest_m = 0.0;
  for (const Body& body : scene.world.bodies) {
    if (body.fixed) continue;
    const double thickness = thickness_m(body.shape);
    thinnest_m = thinnest_m == 0.0 ? thickness : std::min(thinnest_m, thickness);
  }
  if (thinnest_m == 0.0) reject({file.at.file, 0, 0}, "no body of the scene can move");
  scene.length_scale_m = thinnest_m;
  if (const auto scale = quantity_of(file, "length_scale_m", scope)) {
    scene.length_scale_m = scale->in(scope);
    if (!(scene.length_scale_m > 0.0)) {
      reject(file.find("length_scale_m")->at,
             fmt::format("length_scale_m = {} must be positive", scene.length_scale_m));
    }
  }
}

// The whole file at these values (complete); throws InputError.
Scene scene_of(const InputValue& file, const std::vector<Parameter>& parameters,
               const ParameterValues& values) {
  static const InputValue k_none;
  const InputValue* table = file.find("parameters");
  Scope scope = scope_of(parameters, values, table == nullptr ? k_none : *table);
  if (const InputValue* define = file.find("define")) {
    for (const Entry& entry : expect(*define, "define", ValueKind::table).entries) {
      const double value = Quantity(entry.value, entry.name, scope).in(scope);
      scope.add(entry.name, value, entry.at);
    }
  }
  Scene scene;
  SceneOrigins origins;
  if (const auto gravity = vector_of(file, "gravity_mps2", scope)) {
    scene.world.gravity_mps2 = gravity->in(scope);
  }
  const bool may_overlap = overlaps_allowed(file);
  add_bodies(scene_part(file, "body"), scope, scene, origins);
  set_length_scale(file, scope, scene);
  set_laws(file, scope, origins, scene.world);
  check_bodies(scene.world, origins);
  if (!may_overlap && scene.world.bodies.size() > 1) check_overlaps(scene.world, origins);
  add_outer_loads(file, scope, scene);
  return scene;
}

// What the make function of the scenario holds on to.
struct SceneSource {
  InputValue file;
  std::vector<Parameter> parameters;
};

Scenario scenario_of_file(InputValue file) {
  reject_unknown(file, "a scene", k_scene_keys);
  auto source = std::make_shared<SceneSource>();
  Scenario scenario;
  scenario.meaning = filled_text(scene_part(file, "title"), "title");
  scenario.duration_s = positive_number(scene_part(file, "duration_s"), "duration_s");
  if (const InputValue* table = file.find("parameters")) {
    scenario.parameters = scene_parameters(*table);
  }
  source->file = std::move(file);
  source->parameters = scenario.parameters;
  ParameterValues defaults;
  for (const Parameter& parameter : scenario.parameters) {
    defaults.emplace(parameter.name, parameter.default_value);
  }
  scene_of(source->file, source->parameters, defaults);
  scenario.make = [source](const ParameterValues& values) -> Expected<Scene> {
    try {
      return scene_of(source->file, source->parameters, values);
    } catch (const InputError& error) {
      return fail(Fault::invalid, error.text());
    }
  };
  return scenario;
}

std::string hash_text(std::string_view bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace

bool is_scene_file(std::string_view name) { return name.ends_with(".toml"); }

Checked<Scenario> parse_scene(const std::string& text, const std::filesystem::path& file) {
  auto tree = parse_toml(text, file.string());
  if (!tree) return tl::unexpected(tree.error());
  try {
    check_name(file.stem().string(), {file.string(), 0, 0});
    Scenario scenario = scenario_of_file(std::move(*tree));
    scenario.name = file.stem().string();
    scenario.file = file.string();
    scenario.text = text;
    scenario.hash = hash_text(text);
    return scenario;
  } catch (const InputError& error) {
    return tl::unexpected(error);
  }
}

Checked<Scenario> read_scene(const std::filesystem::path& file) {
  const auto text = read_file(file);
  if (!text) return file_error(file.string(), text.error().reason);
  return parse_scene(*text, file);
}

}  // namespace brickbench
