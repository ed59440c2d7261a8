#include "experiments/scenes/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace brickbench {
namespace {

// Names that a plan or the command line keeps for itself.
const std::vector<std::string> k_kept_names = {"step_s", "duration_s", "time_limit_s", "seeds",
                                               "seed"};

Parameter word_parameter(const InputValue& table, const InputValue& choices) {
  reject_unknown(table, "a parameter with choices", {"choices", "default", "meaning"});
  Parameter parameter;
  parameter.kind = ParameterKind::choice;
  parameter.unit = "1";
  for (const InputValue& item : expect(choices, "choices", ValueKind::array).items) {
    const std::string& choice = filled_text(item, "choices");
    check_name(choice, item.at);
    if (std::ranges::find(parameter.choices, choice) != parameter.choices.end()) {
      reject(item.at, fmt::format("choices lists '{}' twice", choice));
    }
    parameter.choices.push_back(choice);
  }
  if (parameter.choices.size() < 2) reject(choices.at, "choices needs two words or more");
  parameter.default_value = parameter.choices.front();
  if (const InputValue* value = table.find("default")) {
    const std::string& word = filled_text(*value, "default");
    if (std::ranges::find(parameter.choices, word) == parameter.choices.end()) {
      reject(value->at, fmt::format("default is no choice: '{}'{}", word,
                                    known_names(word, parameter.choices)));
    }
    parameter.default_value = word;
  }
  return parameter;
}

Parameter truth_parameter(const InputValue& table, const InputValue& value) {
  reject_unknown(table, "a parameter that is true or false", {"default", "meaning"});
  Parameter parameter;
  parameter.kind = ParameterKind::boolean;
  parameter.unit = "1";
  parameter.default_value = value.number;
  parameter.minimum = 0.0;
  parameter.maximum = 1.0;
  return parameter;
}

const InputValue& needed(const InputValue& table, const char* key) {
  const InputValue* value = table.find(key);
  if (value == nullptr) {
    reject(table.at, fmt::format("a parameter needs the key '{}': numbers have default, minimum, "
                                 "maximum and meaning, words have choices and meaning",
                                 key));
  }
  return *value;
}

Parameter quantity_parameter(const InputValue& table) {
  reject_unknown(table, "a parameter",
                 {"default", "minimum", "maximum", "unit", "whole", "meaning", "choices"});
  Parameter parameter;
  parameter.unit = "1";
  if (const InputValue* unit = table.find("unit")) parameter.unit = filled_text(*unit, "unit");
  if (const InputValue* whole = table.find("whole")) {
    if (expect(*whole, "whole", ValueKind::boolean).number != 0.0) {
      parameter.kind = ParameterKind::integer;
    }
  }
  const InputValue& value = needed(table, "default");
  const double number = finite_number(value, "default");
  parameter.default_value = number;
  parameter.minimum = finite_number(needed(table, "minimum"), "minimum");
  parameter.maximum = finite_number(needed(table, "maximum"), "maximum");
  if (!(parameter.minimum <= number && number <= parameter.maximum)) {
    reject(value.at, fmt::format("default = {} must lie in minimum .. maximum, {} .. {}", number,
                                 parameter.minimum, parameter.maximum));
  }
  if (parameter.kind == ParameterKind::integer && number != std::round(number)) {
    reject(value.at, fmt::format("default = {} must be a whole number", number));
  }
  return parameter;
}

Parameter parameter_of(const Entry& entry) {
  const InputValue& table = expect(entry.value, "a parameter", ValueKind::table);
  check_name(entry.name, entry.at);
  if (std::ranges::find(k_kept_names, entry.name) != k_kept_names.end()) {
    reject(entry.at, fmt::format("'{}' is taken: plans have it for every scene", entry.name));
  }
  const InputValue* choices = table.find("choices");
  const InputValue* value = table.find("default");
  const bool truth = value != nullptr && value->kind == ValueKind::boolean;
  Parameter parameter = choices != nullptr ? word_parameter(table, *choices)
                        : truth            ? truth_parameter(table, *value)
                                           : quantity_parameter(table);
  parameter.name = entry.name;
  parameter.meaning = filled_text(needed(table, "meaning"), "meaning");
  return parameter;
}

}  // namespace

std::vector<Parameter> scene_parameters(const InputValue& table) {
  std::vector<Parameter> parameters;
  for (const Entry& entry : expect(table, "parameters", ValueKind::table).entries) {
    parameters.push_back(parameter_of(entry));
  }
  return parameters;
}

Scope scope_of(const std::vector<Parameter>& parameters, const ParameterValues& values,
               const InputValue& table) {
  Scope scope;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& parameter = parameters[i];
    const SourcePosition& at = table.entries[i].at;
    if (parameter.kind != ParameterKind::choice) {
      scope.add(parameter.name, number(values, parameter.name), at);
      continue;
    }
    const std::string& chosen = word(values, parameter.name);
    for (const std::string& choice : parameter.choices) {
      scope.add(parameter.name + '_' + choice, choice == chosen ? 1.0 : 0.0, at);
    }
    scope.words[parameter.name] = chosen;
  }
  return scope;
}

}  // namespace brickbench
