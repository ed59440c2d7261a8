// The catalogue of exact cases as JSON.
#pragma once

#include <nlohmann/json.hpp>

namespace brickbench {

// An array of objects, each with an id.
nlohmann::ordered_json cases_json();

}  // namespace brickbench
