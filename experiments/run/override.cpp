#include "experiments/run/override.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "experiments/run/scene_choice.hpp"

namespace brickbench {
namespace {

const std::vector<std::string> k_settable_keys = {"step_s", "duration_s", "time_limit_s", "seeds",
                                                  "perturb"};

void put(InputValue& table, Entry entry) {
  const auto found = std::ranges::find(table.entries, entry.name, &Entry::name);
  if (found == table.entries.end())
    table.entries.push_back(std::move(entry));
  else
    *found = std::move(entry);
}

InputValue* find_mutable(InputValue& table, std::string_view name) {
  const auto found = std::ranges::find(table.entries, name, &Entry::name);
  return found == table.entries.end() ? nullptr : &found->value;
}

struct Setting {
  std::string experiment;  // empty: all
  bool of_knob = false;
  Entry entry;
};

// Splits "experiment.knob.name": all but the name may be missing.
void split_key(std::string key, Setting& setting) {
  if (const auto dot = key.rfind('.'); dot != std::string::npos) {
    setting.experiment = key.substr(0, dot);
    key = key.substr(dot + 1);
  }
  setting.entry.name = key;
  std::string& rest = setting.experiment;
  setting.of_knob = rest == "knob" || rest.ends_with(".knob");
  if (setting.of_knob) rest.resize(rest.size() - std::min<std::size_t>(rest.size(), 5));
}

Setting parse_setting(const std::string& text) {
  const std::string file = "--set " + text;
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
    reject({file, 0, 0}, "--set needs key=value");
  }
  const std::string value = text.substr(equals + 1);
  // The same columns as in the option itself.
  const std::string pad(equals - 1, ' ');
  auto parsed = parse_toml("v" + pad + "=" + value, file);
  if (!parsed) {
    const bool bare = value.find_first_of("[]{}\"'=, ") == std::string::npos;
    if (!bare) throw parsed.error();
    parsed = parse_toml("v" + pad + "=\"" + value + '"', file);
    if (!parsed) throw parsed.error();
  }
  Setting setting;
  split_key(text.substr(0, equals), setting);
  setting.entry.at = {file, 1, 1};
  setting.entry.value = std::move(parsed->entries.front().value);
  return setting;
}

// Turns the knob of every engine that the experiment chooses, be it a list of engines or one. An
// experiment without engines is rejected when it is read.
void turn_knob(InputValue& experiment, const Entry& knob) {
  InputValue* engines = find_mutable(experiment, "engines");
  if (engines == nullptr) return;
  if (engines->kind != ValueKind::array) {
    InputValue list;
    list.kind = ValueKind::array;
    list.at = engines->at;
    list.items.push_back(std::move(*engines));
    *engines = std::move(list);
  }
  for (InputValue& item : engines->items) {
    if (item.kind != ValueKind::table) {
      InputValue table;
      table.at = item.at;
      put(table, {"engine", item.at, item});
      item = std::move(table);
    }
    if (item.find("knobs") == nullptr) {
      InputValue knobs;
      knobs.at = knob.at;
      put(item, {"knobs", knob.at, knobs});
    }
    put(*find_mutable(item, "knobs"), knob);
  }
}

// Whether the experiment can take the setting; if so, it has it afterwards.
bool apply(InputValue& experiment, const Setting& setting, const Catalogues& catalogues,
           std::vector<std::string>& known) {
  const InputValue* scenario_name = experiment.find("scenario");
  // What is wrong with the scene is said when the experiment is read.
  const auto choice = scenario_name == nullptr ? Checked<SceneChoice>(SceneChoice{})
                                               : choose_scene(*scenario_name, catalogues);
  const Scenario* scenario = choice ? choice->scenario : nullptr;
  known.insert(known.end(), k_settable_keys.begin(), k_settable_keys.end());
  if (scenario != nullptr) {
    for (const Parameter& parameter : scenario->parameters) known.push_back(parameter.name);
  }
  if (setting.of_knob) {
    turn_knob(experiment, setting.entry);
    return true;
  }
  if (std::ranges::find(k_settable_keys, setting.entry.name) != k_settable_keys.end()) {
    put(experiment, setting.entry);
    return true;
  }
  if (std::ranges::find(known, setting.entry.name) == known.end()) return false;
  if (find_mutable(experiment, "parameters") == nullptr) {
    InputValue table;
    table.at = setting.entry.at;
    put(experiment, {"parameters", setting.entry.at, table});
  }
  put(*find_mutable(experiment, "parameters"), setting.entry);
  return true;
}

std::string experiment_name(const InputValue& experiment) {
  const InputValue* name = experiment.find("name");
  if (name == nullptr) name = experiment.find("scenario");
  return name == nullptr ? "" : name->text;
}

void apply_everywhere(InputValue& experiments, const Setting& setting,
                      const Catalogues& catalogues) {
  std::vector<std::string> names;
  std::vector<std::string> known;
  bool applied = false;
  for (InputValue& experiment : experiments.items) {
    names.push_back(experiment_name(experiment));
    if (!setting.experiment.empty() && setting.experiment != names.back()) continue;
    applied = apply(experiment, setting, catalogues, known) || applied;
  }
  if (applied) return;
  if (!setting.experiment.empty() && std::ranges::find(names, setting.experiment) == names.end()) {
    reject(setting.entry.at, fmt::format("no experiment '{}'{}", setting.experiment,
                                         known_names(setting.experiment, names)));
  }
  std::ranges::sort(known);
  known.erase(std::unique(known.begin(), known.end()), known.end());
  reject(setting.entry.at, fmt::format("no experiment has '{}'{}", setting.entry.name,
                                       known_names(setting.entry.name, known)));
}

void keep_only(InputValue& experiments, const std::string& only) {
  std::vector<std::string> names;
  for (const InputValue& experiment : experiments.items)
    names.push_back(experiment_name(experiment));
  std::erase_if(experiments.items,
                [&](const InputValue& experiment) { return experiment_name(experiment) != only; });
  if (!experiments.items.empty()) return;
  reject({"--only " + only, 0, 0},
         fmt::format("no experiment '{}'{}", only, known_names(only, names)));
}

InputValue engine_list(const std::vector<std::string>& selectors) {
  InputValue list;
  list.kind = ValueKind::array;
  list.at = {"--engine", 0, 0};
  for (const std::string& selector : selectors) {
    InputValue item;
    item.kind = ValueKind::text;
    item.text = selector;
    item.at = {"--engine " + selector, 1, 1};
    list.items.push_back(std::move(item));
  }
  return list;
}

}  // namespace

void override_values(InputValue& plan, const Overrides& overrides, const Catalogues& catalogues) {
  InputValue* experiments = find_mutable(plan, "experiment");
  if (experiments == nullptr || experiments->kind != ValueKind::array) return;
  if (!overrides.engines.empty()) {
    Entry entry;
    entry.name = "engines";
    entry.at.file = "--engine";
    entry.value = engine_list(overrides.engines);
    for (InputValue& experiment : experiments->items) put(experiment, entry);
  }
  // A setting of an experiment that is left out is right or wrong all the same, and acts on
  // nothing.
  InputValue all = *experiments;
  if (!overrides.only.empty()) keep_only(*experiments, overrides.only);
  for (const std::string& text : overrides.set) {
    const Setting setting = parse_setting(text);
    const bool is_of_others = !overrides.only.empty() && !setting.experiment.empty() &&
                              setting.experiment != overrides.only;
    apply_everywhere(is_of_others ? all : *experiments, setting, catalogues);
  }
}

}  // namespace brickbench
