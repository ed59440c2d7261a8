// Numbers for JSON, which knows neither infinity nor NaN: those, and what is not there, are null.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace brickbench {

inline nlohmann::ordered_json json_number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}
inline nlohmann::ordered_json json_number(const std::optional<double>& value) {
  return value ? json_number(*value) : nlohmann::ordered_json(nullptr);
}

}  // namespace brickbench
