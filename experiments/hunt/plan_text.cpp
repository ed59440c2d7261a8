#include "experiments/hunt/plan_text.hpp"

#include <fmt/format.h>

#include <cmath>

#include "adapters/seam/unit.hpp"
#include "experiments/run/cell.hpp"

namespace brickbench::hunt {
namespace {

// "1/240" where the step is one part of a whole second, else the shortest number.
std::string step_text(double step_s) {
  const double parts = std::round(1.0 / step_s);
  const bool exact = 1.0 / parts == step_s && parts < 1e4;
  const std::string number = fmt::format("{}", step_s);
  const std::string quotient = fmt::format("\"1/{}\"", parts);
  return exact && number.size() > quotient.size() ? quotient : number;
}

std::string toml(const ParameterValue& value) {
  if (const auto* word = std::get_if<std::string>(&value)) return fmt::format("\"{}\"", *word);
  return fmt::format("{}", std::get<double>(value));
}

// For a basic string of TOML.
std::string escaped(const std::string& text) {
  std::string safe;
  for (const char letter : text) {
    if (letter == '\\' || letter == '"') safe += '\\';
    safe += letter;
  }
  return safe;
}

std::string engine_text(const Trial& trial) {
  if (trial.knobs.empty()) return fmt::format("[\"{}\"]", trial.engine.label());
  std::string knobs;
  for (const auto& [name, value] : trial.knobs) {
    knobs += fmt::format("{}{} = {}", knobs.empty() ? "" : ", ", name, value);
  }
  return fmt::format("[{{ engine = \"{}\", knobs = {{ {} }} }}]", trial.engine.label(), knobs);
}

std::string law_of(std::string_view oracle) {
  for (const OracleInfo& info : oracles()) {
    if (info.name == oracle) return std::string(info.law);
  }
  return {};
}

std::string seen_text(const Verdict& verdict) {
  std::string text;
  for (const Breach& breach : verdict.breaches) {
    const std::string unit = unit_suffix(breach.unit);
    text += fmt::format(
        "{}: {}. Expected at most {:.4g}{}, observed {:.4g}{}{}{}.\n", breach.oracle,
        law_of(breach.oracle), breach.allowed, unit, breach.observed, unit,
        breach.step > 0 ? fmt::format(" after step {} ({:.4g} s)", breach.step, breach.time_s) : "",
        breach.bodies.empty() ? "" : ", bodies " + breach.bodies);
  }
  if (verdict.outcome != "ok") text += fmt::format("{}: {}\n", verdict.outcome, verdict.reason);
  return text;
}

// An exact case is no scenario: a table of its own instead of a plan.
std::string case_text(const Trial& trial, const Verdict& verdict, const std::string& file,
                      const std::string& origin) {
  std::string text = fmt::format("# brickbench hunt --replay {}\n", file);
  text +=
      fmt::format("analysis = \"\"\"\n{}{}\"\"\"\n\n[case]\nid = \"{}\"\nengine = \"{}\"\n",
                  escaped(seen_text(verdict)), escaped(origin), trial.scene, trial.engine.label());
  for (const auto& [name, value] : trial.knobs) text += fmt::format("knobs.{} = {}\n", name, value);
  for (const auto& [name, value] : trial.parameters) {
    text += fmt::format("parameters.{} = {}\n", name, toml(value));
  }
  return text;
}

// Throws InputError.
Trial read_case(const InputValue& table, const Catalogues& catalogues) {
  reject_unknown(table, "a case", {"id", "engine", "knobs", "parameters"});
  const InputValue* id = table.find("id");
  const InputValue* engine = table.find("engine");
  if (id == nullptr || engine == nullptr) reject(table.at, "a case needs 'id' and 'engine'");
  Trial trial;
  trial.source = Source::exact_case;
  trial.scene = filled_text(*id, "id");
  const auto selector =
      parse_selector(filled_text(*engine, "engine"), engine->at, catalogues, true);
  if (!selector) reject(selector.error().at, selector.error().reason);
  const auto chosen = select(*selector, catalogues);
  if (chosen.size() != 1) reject(engine->at, "a case runs in one engine and variant");
  trial.engine = chosen.front();
  if (parameters_of(trial, catalogues).empty()) reject(id->at, "there is no such exact case");
  if (const InputValue* knobs = table.find("knobs")) {
    for (const Entry& entry : knobs->entries) {
      trial.knobs[entry.name] = finite_number(entry.value, entry.name);
    }
  }
  if (const InputValue* parameters = table.find("parameters")) {
    for (const Entry& entry : parameters->entries) {
      trial.parameters[entry.name] = finite_number(entry.value, entry.name);
    }
  }
  return trial;
}

}  // namespace

Checked<std::optional<Trial>> case_trial(const std::string& text, const std::string& file,
                                         const Catalogues& catalogues) {
  const auto table = parse_toml(text, file);
  if (!table) return tl::unexpected(table.error());
  const InputValue* given = table->find("case");
  if (given == nullptr) return std::optional<Trial>();
  try {
    return std::optional<Trial>(read_case(*given, catalogues));
  } catch (const InputError& error) {
    return tl::unexpected(error);
  }
}

std::string plan_text(const Trial& trial, const Verdict& verdict, std::string_view oracle,
                      const std::string& file, const std::string& origin) {
  if (trial.source == Source::exact_case) return case_text(trial, verdict, file, origin);
  std::string text =
      fmt::format("# brickbench hunt --replay {}\n# brickbench run {}\n", file, file);
  text +=
      fmt::format("title = \"{} breaks {} in {}\"\n", trial.engine.label(), oracle, trial.scene);
  text += fmt::format("analysis = \"\"\"\n{}{}\"\"\"\n\n[[experiment]]\n",
                      escaped(seen_text(verdict)), escaped(origin));
  text += fmt::format("scenario = \"{}\"\nengines = {}\nstep_s = {}\nduration_s = {}\n",
                      trial.scene, engine_text(trial), step_text(trial.step_s),
                      static_cast<double>(trial.steps) * trial.step_s);
  if (!trial.parameters.empty()) {
    text += "\n[experiment.parameters]\n";
    for (const auto& [name, value] : trial.parameters) {
      text += fmt::format("{} = {}\n", name, toml(value));
    }
  }
  return text;
}

Checked<std::vector<Trial>> trials_of(const Plan& plan, const Catalogues& catalogues) {
  const auto cells = expand(plan, catalogues);
  if (!cells) return tl::unexpected(cells.error());
  std::vector<Trial> trials;
  for (const Cell& cell : *cells) {
    if (!cell.excluded_why.empty() || cell.seed != 0) {
      return file_error(plan.file.string(),
                        "a hunt replays plans without seeds and without excluded cells");
    }
    if (cell.file_scene) {
      return file_error(plan.file.string(),
                        "a hunt replays compiled scenes, not " + cell.file_scene->file);
    }
    Trial trial;
    trial.scene = cell.scenario;
    const Scenario& scenario = scenario_of(cell, catalogues);
    for (const Parameter& parameter : scenario.parameters) {
      set_parameter(trial, parameter, cell.parameters.find(parameter.name)->second);
    }
    trial.step_s = cell.step_s;
    trial.steps = step_count(cell);
    trial.engine = cell.engine;
    trial.knobs = cell.knobs;
    trials.push_back(std::move(trial));
  }
  return trials;
}

}  // namespace brickbench::hunt
