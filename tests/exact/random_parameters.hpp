// Random parameters of a case, near its defaults and inside its ranges.
#pragma once

#include <algorithm>
#include <random>

#include "experiments/exact/cases/exact_case.hpp"

namespace brickbench::exact::testing {

// Every parameter but the times is scaled by a factor in 0.7 .. 1.4 and clipped to its range.
inline ParameterValues random_parameters(const ExactCase& exact_case, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> factor(0.7, 1.4);
  ParameterValues values;
  for (const Parameter& parameter : exact_case.parameters) {
    const double normal = std::get<double>(parameter.default_value);
    const bool time = parameter.name == "step_s" || parameter.name == "duration_s";
    double value = time ? normal : normal * factor(generator);
    if (parameter.kind == ParameterKind::integer) value = std::round(value);
    values[parameter.name] = std::clamp(value, parameter.minimum, parameter.maximum);
  }
  return values;
}

inline ExactCase find_case(std::string_view id) {
  for (ExactCase& exact_case : exact_cases()) {
    if (exact_case.id == id) return exact_case;
  }
  return {};
}

}  // namespace brickbench::exact::testing
