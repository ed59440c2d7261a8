#include "experiments/run/axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "experiments/run/range.hpp"

namespace brickbench {
namespace {

// true and false, or 1 and 0 as the rows write them.
double truth(const InputValue& value, std::string_view name) {
  const bool number =
      value.kind == ValueKind::integer && (value.number == 0.0 || value.number == 1.0);
  return number ? value.number : expect(value, name, ValueKind::boolean).number;
}

ParameterValue parameter_value(const Scenario& scenario, const Parameter& parameter,
                               const InputValue& value) {
  const std::string name = fmt::format("{}: {}", scenario.name, parameter.name);
  ParameterValue result;
  switch (parameter.kind) {
    case ParameterKind::choice:
      result = expect(value, name, ValueKind::text).text;
      break;
    case ParameterKind::boolean:
      result = truth(value, name);
      break;
    case ParameterKind::integer:
      result = expect(value, name, ValueKind::integer).number;
      break;
    case ParameterKind::number:
      result = finite_number(value, name);
      break;
  }
  if (auto ok = complete(scenario, {{parameter.name, result}}); !ok) {
    reject(value.at, ok.error().reason);
  }
  return result;
}

}  // namespace

Axis axis(const std::string& name, const InputValue& value, const Converter& convert) {
  Axis result{.name = name, .values = {}, .at = value.at};
  InputValue listed;
  if (value.kind == ValueKind::table) {
    listed.kind = ValueKind::array;
    listed.items = range_values(value, name);
  }
  for (const InputValue* item :
       one_or_more(value.kind == ValueKind::table ? listed : value, name)) {
    ParameterValue converted = convert(*item);
    if (std::ranges::find(result.values, converted) != result.values.end()) {
      reject(item->at, fmt::format("{} lists the same value twice", name));
    }
    result.values.push_back(std::move(converted));
  }
  return result;
}

std::vector<Axis> parameter_axes(const Scenario& scenario, const InputValue& table) {
  expect(table, "parameters", ValueKind::table);
  reject_unknown(table, fmt::format("scenario {}", scenario.name), names_of(scenario.parameters));
  std::vector<Axis> axes;
  for (const Entry& entry : table.entries) {
    const auto parameter = std::ranges::find(scenario.parameters, entry.name, &Parameter::name);
    axes.push_back(axis(entry.name, entry.value, [&](const InputValue& value) {
      return parameter_value(scenario, *parameter, value);
    }));
  }
  return axes;
}

std::vector<std::vector<std::string>> zip_groups(const InputValue& list,
                                                 const std::vector<Axis>& axes) {
  std::vector<std::vector<std::string>> groups;
  std::set<std::string> used;
  for (const InputValue& item : expect(list, "zip", ValueKind::array).items) {
    std::vector<std::string> group;
    std::size_t length = 0;
    for (const InputValue& word : expect(item, "an entry of zip", ValueKind::array).items) {
      const std::string& name = filled_text(word, "an entry of zip");
      const auto found = std::ranges::find(axes, name, &Axis::name);
      if (found == axes.end()) {
        reject(word.at, fmt::format("zip: parameters has no '{}'{}", name,
                                    known_names(name, names_of(axes))));
      }
      if (!used.insert(name).second) reject(word.at, fmt::format("zip names '{}' twice", name));
      if (length == 0) length = found->values.size();
      if (found->values.size() != length) {
        reject(word.at, fmt::format("zip: {} has {} values, {} has {}", group.front(), length, name,
                                    found->values.size()));
      }
      group.push_back(name);
    }
    if (group.size() < 2) reject(item.at, "an entry of zip needs two names or more");
    groups.push_back(std::move(group));
  }
  return groups;
}

std::vector<Axis> knob_axes(const InputValue& table, const Selector& selector,
                            const Catalogues& catalogues) {
  expect(table, "knobs", ValueKind::table);
  std::vector<const Adapter*> chosen;
  for (const EngineVariant& engine : select(selector, catalogues)) {
    chosen.push_back(find_adapter(catalogues, engine.engine));
    reject_unknown(table, fmt::format("engine {} as a knob", engine.engine),
                   names_of(chosen.back()->knobs));
  }
  std::vector<Axis> axes;
  for (const Entry& entry : table.entries) {
    axes.push_back(axis(entry.name, entry.value, [&](const InputValue& value) {
      const double number = finite_number(value, entry.name);
      for (const Adapter* adapter : chosen) {
        const auto ok =
            validate(*std::ranges::find(adapter->knobs, entry.name, &Knob::name), number);
        if (!ok) reject(value.at, fmt::format("{}: {}", adapter->name, ok.error().reason));
      }
      return ParameterValue(number);
    }));
  }
  return axes;
}

}  // namespace brickbench
