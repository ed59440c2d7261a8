// World and its parts as JSON, with the names of adapters/seam/world.hpp. The readers throw Wrong.
#pragma once

#include "adapters/remote/json_reader.hpp"
#include "adapters/seam/simulation.hpp"

namespace brickbench::remote {

Json shape_json(const Shape& shape);
Json world_json(const World& world);

// One of each kind, without sizes.
std::vector<Shape> all_shapes();

Shape to_shape(const JsonValue& value);
World to_world(const JsonValue& value);

}  // namespace brickbench::remote
