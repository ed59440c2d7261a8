#include "experiments/scenarios/scenario.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "adapters/seam/unit.hpp"
#include "experiments/scenarios/nearest_name.hpp"

namespace brickbench {
namespace {

Expected<void> check_word(const Scenario& scenario, const Parameter& parameter,
                          const ParameterValue& value) {
  const auto* text = std::get_if<std::string>(&value);
  if (text == nullptr) {
    return fail(
        Fault::invalid,
        fmt::format("{}: {} is a word, one of {}; it got the number {}", scenario.name,
                    parameter.name, fmt::join(parameter.choices, ", "), std::get<double>(value)));
  }
  if (std::ranges::find(parameter.choices, *text) == parameter.choices.end()) {
    return fail(
        Fault::invalid,
        fmt::format("{}: {} has no choice '{}'; did you mean '{}'? It has {}", scenario.name,
                    parameter.name, *text, nearest_name(*text, parameter.choices),
                    fmt::join(parameter.choices, ", ")));
  }
  return {};
}

Expected<void> check_number(const Scenario& scenario, const Parameter& parameter,
                            const ParameterValue& value) {
  const auto* x = std::get_if<double>(&value);
  if (x == nullptr) {
    return fail(Fault::invalid,
                fmt::format("{}: {} is a number; it got the word '{}'", scenario.name,
                            parameter.name, std::get<std::string>(value)));
  }
  const bool whole = parameter.kind != ParameterKind::number;
  if (!(*x >= parameter.minimum && *x <= parameter.maximum) || (whole && *x != std::round(*x))) {
    return fail(Fault::invalid,
                fmt::format("{}: {} = {}{} must be {} in {} .. {}", scenario.name, parameter.name,
                            *x, unit_suffix(parameter.unit), whole ? "a whole number" : "a number",
                            parameter.minimum, parameter.maximum));
  }
  return {};
}

}  // namespace

double number(const ParameterValues& values, std::string_view name) {
  return std::get<double>(values.find(name)->second);
}

const std::string& word(const ParameterValues& values, std::string_view name) {
  return std::get<std::string>(values.find(name)->second);
}

Expected<ParameterValues> complete(const Scenario& scenario, const ParameterValues& given) {
  ParameterValues values;
  std::vector<std::string> known;
  for (const Parameter& parameter : scenario.parameters) {
    values.emplace(parameter.name, parameter.default_value);
    known.push_back(parameter.name);
  }
  for (const auto& [name, value] : given) {
    const auto parameter = std::ranges::find(scenario.parameters, name, &Parameter::name);
    if (parameter == scenario.parameters.end()) {
      return fail(Fault::invalid, fmt::format("{} has no parameter '{}'; did you mean '{}'?",
                                              scenario.name, name, nearest_name(name, known)));
    }
    const bool is_word = parameter->kind == ParameterKind::choice;
    const auto fits = is_word ? check_word(scenario, *parameter, value)
                              : check_number(scenario, *parameter, value);
    if (!fits) return tl::unexpected(fits.error());
    values.insert_or_assign(name, value);
  }
  return values;
}

Expected<Scene> build(const Scenario& scenario, const ParameterValues& given) {
  const auto values = complete(scenario, given);
  if (!values) return tl::unexpected(values.error());
  auto scene = scenario.make(*values);
  if (!scene) {
    return fail(scene.error().fault, fmt::format("{}: {}", scenario.name, scene.error().reason));
  }
  if (const auto valid = validate(scene->world); !valid) return tl::unexpected(valid.error());
  return scene;
}

}  // namespace brickbench
