#include "experiments/hunt/trial.hpp"

#include <fmt/format.h>

#include "experiments/exact/cases/exact_case.hpp"
#include "experiments/run/cell.hpp"

namespace brickbench::hunt {

Settings settings_of(const Trial& trial) {
  return {
      .step_s = trial.step_s, .variant = trial.engine.variant, .knobs = trial.knobs, .threads = 1};
}

std::vector<Parameter> parameters_of(const Trial& trial, const Catalogues& catalogues) {
  if (trial.source == Source::scenario) {
    const Scenario* scenario = find_scenario(catalogues, trial.scene);
    return scenario == nullptr ? std::vector<Parameter>{} : scenario->parameters;
  }
  for (const exact::ExactCase& exact_case : exact::exact_cases()) {
    if (exact_case.id == trial.scene) return exact_case.parameters;
  }
  return {};
}

Expected<Scene> scene_of(const Trial& trial, const Catalogues& catalogues) {
  const Scenario* scenario = find_scenario(catalogues, trial.scene);
  if (trial.source != Source::scenario || scenario == nullptr) {
    return fail(Fault::invalid, fmt::format("there is no scenario '{}'", trial.scene));
  }
  return build(*scenario, trial.parameters);
}

void set_parameter(Trial& trial, const Parameter& parameter, const ParameterValue& value) {
  if (value == parameter.default_value) {
    trial.parameters.erase(parameter.name);
  } else {
    trial.parameters[parameter.name] = value;
  }
}

std::string label(const Trial& trial) {
  std::string text = fmt::format("{} in {}", trial.scene, trial.engine.label());
  if (trial.source == Source::scenario) {
    text += fmt::format(", {} steps of {} s", trial.steps, trial.step_s);
  }
  for (const auto& [name, value] : trial.parameters) {
    text += fmt::format(", {} = {}", name, text_of(value));
  }
  for (const auto& [name, value] : trial.knobs) text += fmt::format(", knob {} = {}", name, value);
  return text;
}

}  // namespace brickbench::hunt
