#include "cli/scene_json.hpp"

#include <algorithm>

#include "adapters/seam/shape.hpp"
#include "cli/json_number.hpp"

namespace brickbench {
namespace {

using SceneJson = nlohmann::ordered_json;

SceneJson vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

SceneJson law_json(const ContactLaw& law) {
  return {{"friction", law.friction}, {"restitution", law.restitution}};
}

SceneJson body_json(const Scene& scene, std::size_t i) {
  const Body& body = scene.world.bodies[i];
  const State& at = body.initial;
  SceneJson json = {{"id", body.name}, {"shape", shape_word(body.shape)}};
  if (!is_half_space(body.shape)) {
    json["size_m"] = vector_json(2.0 * half_extents_m(body.shape));
  }
  json["role"] = role_word(scene, i);
  if (!body.fixed) {
    json["mass_kg"] = body.mass_kg;
    json["inertia_kgm2"] = vector_json(body.inertia_kgm2);
  }
  json["surface"] = body.surface;
  json["position_m"] = vector_json(at.position_m);
  json["quaternion"] = {at.orientation.w(), at.orientation.x(), at.orientation.y(),
                        at.orientation.z()};
  json["velocity_mps"] = vector_json(at.velocity_mps);
  json["angular_velocity_radps"] = vector_json(at.angular_velocity_radps);
  return json;
}

SceneJson touches_json(const World& world) {
  auto array = SceneJson::array();
  for (const Touch& touch : touches_at_start(world)) {
    array.push_back({{"body_a", world.bodies[touch.body_a].name},
                     {"body_b", world.bodies[touch.body_b].name},
                     {"overlap", touch.overlap},
                     {"inside", touch.inside},
                     {"depth_m", touch.depth_m},
                     {"law", law_json(touch.law)}});
  }
  return array;
}

}  // namespace

std::string_view role_word(const Scene& scene, std::size_t i) {
  if (scene.world.bodies[i].fixed) return "fixed";
  if (std::ranges::find(scene.bricks, i) != scene.bricks.end()) return "brick";
  if (std::ranges::find(scene.projectiles, i) != scene.projectiles.end()) return "projectile";
  return "none";
}

double moving_mass_kg(const World& world) {
  double mass_kg = 0.0;
  for (const Body& body : world.bodies) mass_kg += body.fixed ? 0.0 : body.mass_kg;
  return mass_kg;
}

SceneJson scene_json(const Scenario& scenario, const ParameterValues& values, const Scene& scene) {
  const World& world = scene.world;
  auto parameters = SceneJson::object();
  for (const auto& [name, value] : values) {
    std::visit([&, &key = name](const auto& x) { parameters[key] = x; }, value);
  }
  auto bodies = SceneJson::array();
  for (std::size_t i = 0; i < world.bodies.size(); ++i) bodies.push_back(body_json(scene, i));
  auto pairs = SceneJson::array();
  for (const PairLaw& pair : world.exceptions) {
    pairs.push_back({{"surface_a", pair.surface_a},
                     {"surface_b", pair.surface_b},
                     {"law", law_json(pair.law)}});
  }
  return {{"id", scenario.name},
          {"meaning", scenario.meaning},
          {"file", scenario.file},
          {"hash", scenario.hash},
          {"duration_s", scenario.duration_s},
          {"parameters", parameters},
          {"gravity_mps2", vector_json(world.gravity_mps2)},
          {"length_scale_m", scene.length_scale_m},
          {"law", law_json(world.law)},
          {"pairs", pairs},
          {"bodies", bodies},
          {"touches", touches_json(world)},
          {"blows", scene.blows.size()},
          {"forces", scene.pushes.size()},
          {"moving_mass_kg", moving_mass_kg(world)},
          {"longest_step_s", json_number(longest_step_s(scene))}};
}

SceneJson doubts_json(const std::string& scene, const std::vector<Doubt>& found,
                      double longest_step, int exit_code) {
  auto array = SceneJson::array();
  for (const Doubt& doubt : found) {
    array.push_back({{"id", doubt.kind},
                     {"text", doubt.text},
                     {"unit", doubt.unit},
                     {"value", doubt.value},
                     {"limit", doubt.limit},
                     {"bodies", doubt.bodies}});
  }
  return {{"id", scene},
          {"exit_code", exit_code},
          {"longest_step_s", json_number(longest_step)},
          {"doubts", array}};
}

}  // namespace brickbench
