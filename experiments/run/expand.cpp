#include <fmt/format.h>

#include <algorithm>

#include "experiments/record/schema.hpp"
#include "experiments/run/cell.hpp"

namespace brickbench {
namespace {

// The axes that advance together, in the place of the first of them; alone where none does.
std::vector<std::vector<const Axis*>> groups(const std::vector<Axis>& axes,
                                             const std::vector<std::vector<std::string>>& zip) {
  std::vector<std::vector<const Axis*>> result;
  for (const Axis& axis : axes) {
    const auto zipped = std::ranges::find_if(zip, [&](const std::vector<std::string>& names) {
      return std::ranges::find(names, axis.name) != names.end();
    });
    if (zipped == zip.end()) {
      result.push_back({&axis});
      continue;
    }
    const auto together = std::ranges::find_if(result, [&](const auto& group) {
      return std::ranges::find(*zipped, group.front()->name) != zipped->end();
    });
    if (together == result.end())
      result.push_back({&axis});
    else
      together->push_back(&axis);
  }
  return result;
}

// All combinations of the axes, the last axis fastest.
std::vector<ParameterValues> product(const std::vector<Axis>& axes,
                                     const std::vector<std::vector<std::string>>& zip = {}) {
  std::vector<ParameterValues> points = {{}};
  for (const auto& group : groups(axes, zip)) {
    std::vector<ParameterValues> longer;
    for (const ParameterValues& point : points) {
      for (std::size_t i = 0; i < group.front()->values.size(); ++i) {
        longer.push_back(point);
        for (const Axis* axis : group) longer.back().emplace(axis->name, axis->values[i]);
      }
    }
    points = std::move(longer);
  }
  return points;
}

struct Contestant {
  EngineVariant engine;
  KnobValues knobs;

  bool operator==(const Contestant&) const = default;
};

// Each engine, variant and setting of the knobs once, in the order of their first mention.
std::vector<Contestant> contestants(const Experiment& experiment, const Catalogues& catalogues) {
  std::vector<Contestant> result;
  for (const EngineChoice& choice : experiment.engines) {
    for (const EngineVariant& engine : select(choice.selector, catalogues)) {
      for (const ParameterValues& point : product(choice.knobs)) {
        Contestant contestant{engine, {}};
        for (const auto& [name, value] : point) {
          contestant.knobs.emplace(name, std::get<double>(value));
        }
        if (std::ranges::find(result, contestant) == result.end()) result.push_back(contestant);
      }
    }
  }
  return result;
}

const Rule* first_rule(const std::vector<Rule>& rules, const Cell& cell,
                       const Catalogues& catalogues) {
  if (rules.empty()) return nullptr;
  const ParameterValues values = quantities(cell, catalogues);
  for (const Rule& rule : rules) {
    const auto of_engine = [&] {
      const auto chosen = select(*rule.selector, catalogues);
      return std::ranges::find(chosen, cell.engine) != chosen.end();
    };
    if (rule.selector && !of_engine()) continue;
    if (holds(rule.when, values)) return &rule;
  }
  return nullptr;
}

std::string axes_text(const ParameterValues& point, const KnobValues& knobs) {
  std::vector<std::string> parts;
  for (const auto& [name, value] : point) parts.push_back(name + '=' + text_of(value));
  for (const auto& [name, value] : knobs) parts.push_back("knob." + name + '=' + shortest(value));
  std::ranges::sort(parts);
  return fmt::format("{}", fmt::join(parts, ";"));
}

void expand_experiment(const Experiment& experiment, const Catalogues& catalogues,
                       std::vector<Cell>& cells) {
  const Scenario& scenario = scenario_of(experiment, catalogues);
  const std::vector<Contestant> engines = contestants(experiment, catalogues);
  for (const ParameterValues& point : product(experiment.parameters, experiment.zip)) {
    const auto complete_point = complete(scenario, point);
    if (!complete_point) reject(experiment.parameters_at, complete_point.error().reason);
    bool wanted = false;
    for (const double step_s : experiment.step_s) {
      for (const std::uint64_t seed : experiment.seeds) {
        for (const Contestant& contestant : engines) {
          Cell cell;
          cell.index = cells.size();
          cell.experiment = experiment.name;
          cell.scenario = experiment.scenario;
          cell.file_scene = experiment.file_scene;
          cell.engine = contestant.engine;
          cell.parameters = *complete_point;
          cell.knobs = contestant.knobs;
          cell.step_s = step_s;
          cell.duration_s = experiment.duration_s;
          cell.time_limit_s = experiment.time_limit_s;
          cell.seed = seed;
          cell.perturb = experiment.perturb;
          cell.metrics = experiment.metrics;
          cell.axes = axes_text(point, contestant.knobs);
          const Rule* except = first_rule(experiment.except, cell, catalogues);
          if (except != nullptr) cell.excluded_why = except->why;
          const Rule* expected = first_rule(experiment.expected, cell, catalogues);
          if (expected != nullptr) cell.expected_outcome = expected->outcome;
          wanted = wanted || cell.excluded_why.empty();
          cells.push_back(std::move(cell));
        }
      }
    }
    if (!wanted) continue;
    if (auto scene = build(scenario, point); !scene) {
      reject(experiment.parameters_at, scene.error().reason);
    }
  }
}

}  // namespace

ParameterValues quantities(const Cell& cell, const Catalogues& catalogues) {
  ParameterValues values = cell.parameters;
  values["step_s"] = cell.step_s;
  values["duration_s"] = cell.duration_s;
  values["seed"] = static_cast<double>(cell.seed);
  if (const Adapter* adapter = find_adapter(catalogues, cell.engine.engine)) {
    for (const Knob& knob : adapter->knobs) values["knob." + knob.name] = knob.engine_default;
    for (const auto& [name, value] : variant_of(*adapter, cell.engine.variant).knobs) {
      values["knob." + name] = value;
    }
  }
  for (const auto& [name, value] : cell.knobs) values["knob." + name] = value;
  return values;
}

Checked<std::vector<Cell>> expand(const Plan& plan, const Catalogues& catalogues) {
  try {
    std::vector<Cell> cells;
    for (const Experiment& experiment : plan.experiments) {
      expand_experiment(experiment, catalogues, cells);
    }
    if (plan.trajectory) choose_recordings(*plan.trajectory, catalogues, cells);
    return cells;
  } catch (const InputError& error) {
    return tl::unexpected(error);
  }
}

}  // namespace brickbench
