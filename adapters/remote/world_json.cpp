#include "adapters/remote/world_json.hpp"

#include <limits>
#include <utility>

#include "adapters/seam/shape.hpp"

namespace brickbench::remote {
namespace {

constexpr std::size_t k_most_bodies = 1'000'000;
constexpr std::size_t k_most_name_bytes = 1000;
constexpr int k_most_surface = std::numeric_limits<int>::max();

Json law_json(const ContactLaw& law) {
  return {{"friction", law.friction}, {"restitution", law.restitution}};
}

Json state_json(const State& state) {
  const Eigen::Quaterniond& q = state.orientation;
  return {{"position_m", vector_json(state.position_m)},
          {"orientation", {q.w(), q.x(), q.y(), q.z()}},
          {"velocity_mps", vector_json(state.velocity_mps)},
          {"angular_velocity_radps", vector_json(state.angular_velocity_radps)}};
}

Json body_json(const Body& body) {
  return {{"name", body.name},
          {"shape", shape_json(body.shape)},
          {"fixed", body.fixed},
          {"mass_kg", body.mass_kg},
          {"inertia_kgm2", vector_json(body.inertia_kgm2)},
          {"surface", body.surface},
          {"initial", state_json(body.initial)}};
}

ContactLaw to_law(const JsonValue& value) {
  value.only({"friction", "restitution"});
  return {value.at("friction").number(), value.at("restitution").number()};
}

State to_state(const JsonValue& value) {
  value.only({"position_m", "orientation", "velocity_mps", "angular_velocity_radps"});
  State state;
  state.position_m = value.at("position_m").vector();
  const auto q = value.at("orientation").items(4);
  if (q.size() != 4) value.at("orientation").wrong("four numbers w, x, y, z");
  state.orientation = {q[0].number(), q[1].number(), q[2].number(), q[3].number()};
  state.velocity_mps = value.at("velocity_mps").vector();
  state.angular_velocity_radps = value.at("angular_velocity_radps").vector();
  return state;
}

Body to_body(const JsonValue& value) {
  value.only({"name", "shape", "fixed", "mass_kg", "inertia_kgm2", "surface", "initial"});
  Body body;
  body.name = value.at("name").any_text(k_most_name_bytes);
  body.shape = to_shape(value.at("shape"));
  body.fixed = value.at("fixed").boolean();
  body.mass_kg = value.at("mass_kg").number();
  body.inertia_kgm2 = value.at("inertia_kgm2").vector();
  body.surface = value.at("surface").whole(-k_most_surface, k_most_surface);
  body.initial = to_state(value.at("initial"));
  return body;
}

// Of the kind of the sample.
Shape read_like(const Shape& sample, const JsonValue& value) {
  return by_shape(
      sample,
      [&](const BoxShape&) -> Shape {
        value.only({"kind", "half_extents_m"});
        return BoxShape{value.at("half_extents_m").vector()};
      },
      [&](const SphereShape&) -> Shape {
        value.only({"kind", "radius_m"});
        return SphereShape{value.at("radius_m").number()};
      },
      [&](const PlaneShape&) -> Shape {
        value.only({"kind"});
        return PlaneShape{};
      });
}

}  // namespace

Json shape_json(const Shape& shape) {
  Json json = {{"kind", shape_word(shape)}};
  by_shape(
      shape, [&](const BoxShape& box) { json["half_extents_m"] = vector_json(box.half_extents_m); },
      [&](const SphereShape& ball) { json["radius_m"] = ball.radius_m; }, [](const PlaneShape&) {});
  return json;
}

Json world_json(const World& world) {
  auto bodies = Json::array();
  for (const Body& body : world.bodies) bodies.push_back(body_json(body));
  auto exceptions = Json::array();
  for (const PairLaw& pair : world.exceptions) {
    exceptions.push_back({{"surface_a", pair.surface_a},
                          {"surface_b", pair.surface_b},
                          {"law", law_json(pair.law)}});
  }
  return {{"gravity_mps2", vector_json(world.gravity_mps2)},
          {"law", law_json(world.law)},
          {"exceptions", exceptions},
          {"bodies", bodies}};
}

std::vector<Shape> all_shapes() {
  return []<std::size_t... i>(std::index_sequence<i...>) {
    return std::vector<Shape>{Shape(std::in_place_index<i>)...};
  }
  (std::make_index_sequence<std::variant_size_v<Shape>>());
}

Shape to_shape(const JsonValue& value) {
  const std::string kind = value.at("kind").any_text(k_most_name_bytes);
  std::string known;
  for (const Shape& sample : all_shapes()) {
    known += (known.empty() ? "" : ", ") + std::string(shape_word(sample));
    if (shape_word(sample) == kind) return read_like(sample, value);
  }
  value.at("kind").wrong("one of " + known);
}

World to_world(const JsonValue& value) {
  value.only({"gravity_mps2", "law", "exceptions", "bodies"});
  World world;
  world.gravity_mps2 = value.at("gravity_mps2").vector();
  world.law = to_law(value.at("law"));
  for (const JsonValue& pair : value.at("exceptions").items(k_most_bodies)) {
    pair.only({"surface_a", "surface_b", "law"});
    world.exceptions.push_back({pair.at("surface_a").whole(-k_most_surface, k_most_surface),
                                pair.at("surface_b").whole(-k_most_surface, k_most_surface),
                                to_law(pair.at("law"))});
  }
  for (const JsonValue& body : value.at("bodies").items(k_most_bodies)) {
    world.bodies.push_back(to_body(body));
  }
  return world;
}

}  // namespace brickbench::remote
