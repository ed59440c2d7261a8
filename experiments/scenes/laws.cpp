#include "experiments/scenes/laws.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace brickbench {
namespace {

const InputValue& law_part(const InputValue& table, const char* what, const char* key) {
  const InputValue* value = table.find(key);
  if (value == nullptr) reject(table.at, fmt::format("{} needs the key '{}'", what, key));
  return *value;
}

ContactLaw law_of(const InputValue& table, const char* what, const Scope& scope) {
  const InputValue& friction = law_part(table, what, "friction");
  const InputValue& restitution = law_part(table, what, "restitution");
  const ContactLaw law{Quantity(friction, "friction", scope).in(scope),
                       Quantity(restitution, "restitution", scope).in(scope)};
  if (law.friction < 0.0) {
    reject(friction.at, fmt::format("friction = {} must be at least 0", law.friction));
  }
  if (!(law.restitution >= 0.0 && law.restitution <= 1.0)) {
    reject(restitution.at, fmt::format("restitution = {} must lie in 0 .. 1", law.restitution));
  }
  return law;
}

int surface_of(const InputValue& value, const SceneOrigins& origins) {
  const std::string& name = filled_text(value, "surfaces");
  const auto found = origins.surfaces.find(name);
  if (found != origins.surfaces.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [surface, index] : origins.surfaces) known.push_back(surface);
  reject(value.at, fmt::format("no body has the surface '{}'{}", name, known_names(name, known)));
}

PairLaw pair_of(const InputValue& entry, const Scope& scope, const SceneOrigins& origins) {
  expect(entry, "pair", ValueKind::table);
  reject_unknown(entry, "a pair", {"surfaces", "friction", "restitution"});
  const InputValue& surfaces = law_part(entry, "a pair", "surfaces");
  expect(surfaces, "surfaces", ValueKind::array);
  if (surfaces.items.size() != 2) {
    reject(surfaces.at, fmt::format("surfaces has two names, not {}", surfaces.items.size()));
  }
  PairLaw pair;
  pair.surface_a = surface_of(surfaces.items[0], origins);
  pair.surface_b = surface_of(surfaces.items[1], origins);
  pair.law = law_of(entry, "a pair", scope);
  return pair;
}

}  // namespace

void set_laws(const InputValue& file, const Scope& scope, const SceneOrigins& origins,
              World& world) {
  if (const InputValue* law = file.find("law")) {
    expect(*law, "law", ValueKind::table);
    reject_unknown(*law, "law", {"friction", "restitution"});
    world.law = law_of(*law, "law", scope);
  } else if (world.bodies.size() > 1) {
    reject({file.at.file, 0, 0},
           "a scene of several bodies needs the table [law]: friction and "
           "restitution of all pairs");
  }
  const InputValue* pairs = file.find("pair");
  if (pairs == nullptr) return;
  if (pairs->kind != ValueKind::array) {
    reject(pairs->at, "pair must be an array of tables: write [[pair]]");
  }
  for (const InputValue& entry : pairs->items) {
    const PairLaw pair = pair_of(entry, scope, origins);
    const auto surfaces = std::minmax(pair.surface_a, pair.surface_b);
    const bool known = std::ranges::any_of(world.exceptions, [&](const PairLaw& other) {
      return std::minmax(other.surface_a, other.surface_b) == surfaces;
    });
    if (known) reject(entry.at, "the law of these two surfaces is given twice");
    world.exceptions.push_back(pair);
  }
}

}  // namespace brickbench
