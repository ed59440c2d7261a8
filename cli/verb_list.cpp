#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "adapters/seam/unit.hpp"
#include "cli/build_facts.hpp"
#include "cli/cases_json.hpp"
#include "cli/complain.hpp"
#include "cli/engine_files.hpp"
#include "cli/terminal.hpp"
#include "cli/verbs.hpp"
#include "cli/verbs_json.hpp"
#include "experiments/record/schema.hpp"
#include "experiments/run/plan.hpp"
#include "experiments/run/plan_files.hpp"
#include "experiments/run/run_cell.hpp"

namespace brickbench {
namespace {

using Json = nlohmann::ordered_json;

// Those that run, then programs that do not, with the `problem`.
Json engines_json(const Catalogues& catalogues) {
  auto array = Json::array();
  for (const Adapter& adapter : catalogues.adapters) {
    auto variants = Json::array();
    for (const Variant& variant : adapter.variants) {
      variants.push_back(
          {{"id", variant.name}, {"meaning", variant.meaning}, {"precision", variant.precision}});
    }
    auto knobs = Json::array();
    for (const Knob& knob : adapter.knobs) {
      knobs.push_back({{"id", knob.name},
                       {"unit", knob.unit},
                       {"engine_default", knob.engine_default},
                       {"minimum", knob.min},
                       {"maximum", knob.max},
                       {"whole", knob.whole},
                       {"allowed", range_text(knob)},
                       {"meaning", knob.meaning}});
    }
    array.push_back({{"id", adapter.name},
                     {"version", adapter.version},
                     {"precision", precision_text(adapter)},
                     {"own", adapter.own},
                     {"variants", variants},
                     {"knobs", knobs}});
  }
  for (const auto& [name, why] : catalogues.why_absent) {
    array.push_back({{"id", name}, {"problem", why}});
  }
  return array;
}

Json value_json(const ParameterValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return *number;
  return std::get<std::string>(value);
}

std::string_view kind_word(ParameterKind kind) {
  switch (kind) {
    case ParameterKind::number:
      return "number";
    case ParameterKind::integer:
      return "integer";
    case ParameterKind::boolean:
      return "boolean";
    case ParameterKind::choice:
      return "choice";
  }
  return "number";
}

Json parameter_json(const Parameter& parameter) {
  Json json = {{"id", parameter.name},
               {"unit", parameter.unit},
               {"kind", kind_word(parameter.kind)},
               {"default", value_json(parameter.default_value)}};
  if (parameter.kind == ParameterKind::choice) {
    json["choices"] = parameter.choices;
  } else {
    json["minimum"] = parameter.minimum;
    json["maximum"] = parameter.maximum;
  }
  json["meaning"] = parameter.meaning;
  return json;
}

Json scenarios_json() {
  auto array = Json::array();
  for (const Scenario& scenario : all_catalogues().scenarios) {
    auto parameters = Json::array();
    for (const Parameter& parameter : scenario.parameters) {
      parameters.push_back(parameter_json(parameter));
    }
    array.push_back({{"id", scenario.name},
                     {"meaning", scenario.meaning},
                     {"duration_s", scenario.duration_s},
                     {"parameters", parameters}});
  }
  return array;
}

Json outputs_json(const std::vector<OutputInfo>& outputs) {
  auto array = Json::array();
  for (const OutputInfo& output : outputs) {
    array.push_back({{"id", output.name},
                     {"unit", output.unit},
                     {"better", better_word(output.better)},
                     {"meaning", output.meaning},
                     {"good", output.good}});
  }
  return array;
}

Json metrics_json() {
  auto array = Json::array();
  for (const MetricInfo& metric : all_catalogues().metrics) {
    array.push_back({{"id", metric.name},
                     {"meaning", metric.meaning},
                     {"outputs", outputs_json(metric.outputs)},
                     {"curves", outputs_json(metric.curves)}});
  }
  return array;
}

Json plans_json() {
  const Catalogues catalogues = all_catalogues();
  auto array = Json::array();
  for (const auto& file : all_plans()) {
    const auto plan = read_plan(file, catalogues);
    array.push_back({{"id", file.stem().string()},
                     {"file", file.string()},
                     {"title", plan ? plan->title : ""},
                     {"analysis", plan ? plan->analysis : ""},
                     {"problem", plan ? "" : plan.error().text()}});
  }
  return array;
}

std::string one_line(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  return text;
}

void print_parts(const Json& parts, const char* title) {
  if (parts.empty()) return;
  fmt::print("  {}\n", title);
  for (const Json& part : parts) {
    std::string facts;
    if (part.contains("kind") && part["kind"] != "choice") {
      facts =
          fmt::format(" = {}{}, {} .. {}",
                      shortest(part["default"].is_number() ? part["default"].get<double>() : 0.0),
                      unit_suffix(part["unit"].get<std::string>()), shortest(part["minimum"]),
                      shortest(part["maximum"]));
    } else if (part.contains("choices")) {
      facts = fmt::format(" = {}, one of {}", part["default"].get<std::string>(),
                          part["choices"].dump());
    } else if (part.contains("engine_default")) {
      facts = fmt::format(" [{}], {}", part["unit"].get<std::string>(),
                          part["allowed"].get<std::string>());
    } else if (part.contains("value")) {
      facts =
          part["value"].get<std::string>().empty() ? "" : ' ' + part["value"].get<std::string>();
    } else if (part.contains("unit")) {
      facts = " [" + part["unit"].get<std::string>() + ']';
    }
    fmt::print("    {}{}: {}\n", part["id"].get<std::string>(), facts,
               part["meaning"].get<std::string>());
  }
}

void print_entry(const Json& entry) {
  std::string line = entry["id"];
  for (const char* key : {"version", "precision", "title", "meaning", "analysis", "problem"}) {
    if (!entry.contains(key) || entry[key].get<std::string>().empty()) continue;
    line += (line == entry["id"] ? ": " : ", ") + one_line(entry[key]);
  }
  fmt::print("{}\n", line);
  for (const char* key : {"variants", "parameters", "knobs", "options", "outputs", "curves"}) {
    if (entry.contains(key)) print_parts(entry[key], key);
  }
}

struct ListOptions {
  std::string what;
  std::vector<std::string> engine_files;
  bool json = false;
};

int list(const ListOptions& options, const CLI::App& app) {
  Checked<Catalogues> catalogues;
  if (options.what == "engines") catalogues = all_catalogues(options.engine_files);
  if (!catalogues) return complain(catalogues.error().text(), k_exit_bad_input);
  const Json array = options.what == "engines"     ? engines_json(*catalogues)
                     : options.what == "scenarios" ? scenarios_json()
                     : options.what == "metrics"   ? metrics_json()
                     : options.what == "cases"     ? cases_json()
                     : options.what == "verbs"     ? verbs_json(app)
                                                   : plans_json();
  if (options.json) {
    fmt::print("{}\n", array.dump(2));
    return k_exit_fine;
  }
  for (const Json& entry : array) print_entry(entry);
  return k_exit_fine;
}

}  // namespace

void add_list_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb =
      app.add_subcommand("list", "List engines, scenarios, metrics, cases, plans or verbs");
  auto options = std::make_shared<ListOptions>();
  verb->add_option("what", options->what, "engines, scenarios, metrics, cases, plans or verbs")
      ->required()
      ->check(CLI::IsMember({"engines", "scenarios", "metrics", "cases", "plans", "verbs"}));
  add_engine_files(*verb, options->engine_files);
  verb->add_flag("--json", options->json, "An array of objects, each with an id");
  verb->callback([options, &app, &invocation] { invocation.exit_code = list(*options, app); });
}

}  // namespace brickbench
