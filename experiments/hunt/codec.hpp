// Trials, verdicts and findings as JSON, and back.
#pragma once

#include <nlohmann/json.hpp>

#include "experiments/hunt/shrink.hpp"

namespace brickbench::hunt {

using Json = nlohmann::ordered_json;

Json to_json(const Trial& trial);
Json to_json(const Breach& breach);
Json to_json(const Verdict& verdict);
Json to_json(const Shrunk& shrunk);

// Throw nlohmann::json::exception where something is missing or of another type.
Trial trial_of(const Json& json);
Verdict verdict_of(const Json& json);
Shrunk shrunk_of(const Json& json);

}  // namespace brickbench::hunt
