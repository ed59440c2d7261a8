#include "experiments/run/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "experiments/record/file.hpp"
#include "experiments/run/axes.hpp"
#include "experiments/run/override.hpp"

namespace brickbench {
namespace {

const std::vector<std::string> k_plan_keys = {"title", "analysis", "experiment", "bench",
                                              "trajectory"};
const std::vector<std::string> k_experiment_keys = {
    "name", "scenario", "engines", "step_s", "duration_s", "time_limit_s", "parameters",
    "zip",  "seeds",    "perturb", "except", "expect",     "metrics"};
const std::vector<std::string> k_outcomes = {"refused", "invalid",   "diverged",     "blown_up",
                                             "crashed", "timed_out", "out_of_memory"};
// The largest relative distance of duration / step from a whole number: rounding of 2 / (1/240).
constexpr double k_whole_steps_tolerance = 1e-9;

std::vector<EngineChoice> engine_choices(const InputValue& value, const Catalogues& catalogues) {
  std::vector<EngineChoice> choices;
  std::size_t matched = 0;
  for (const InputValue* item : one_or_more(value, "engines")) {
    EngineChoice choice;
    if (item->kind == ValueKind::table) {
      reject_unknown(*item, "an entry of engines", {"engine", "knobs"});
      const InputValue* engine = item->find("engine");
      if (engine == nullptr) reject(item->at, "an entry of engines needs the key 'engine'");
      choice.selector =
          expect_selector(filled_text(*engine, "engine"), engine->at, catalogues, true);
      if (const InputValue* knobs = item->find("knobs")) {
        choice.knobs = knob_axes(*knobs, choice.selector, catalogues);
      }
    } else {
      choice.selector = expect_selector(filled_text(*item, "engines"), item->at, catalogues, true);
    }
    matched += select(choice.selector, catalogues).size();
    choices.push_back(std::move(choice));
  }
  if (matched == 0) reject(value.at, "engines matches nothing in this build");
  return choices;
}

std::vector<std::string> condition_names(const Scenario& scenario, const Catalogues& catalogues) {
  std::vector<std::string> names = names_of(scenario.parameters);
  for (const char* name : {"step_s", "duration_s", "seed"}) names.emplace_back(name);
  for (const Adapter& adapter : catalogues.adapters) {
    for (const Knob& knob : adapter.knobs) names.push_back("knob." + knob.name);
  }
  return names;
}

std::vector<Rule> rules(const InputValue& list, bool with_outcome, const Scenario& scenario,
                        const Catalogues& catalogues) {
  const std::string_view what = with_outcome ? "expect" : "except";
  std::vector<std::string> keys = {"engine", "when", "why"};
  if (with_outcome) keys.emplace_back("outcome");
  std::vector<Rule> result;
  for (const InputValue& item : expect(list, what, ValueKind::array).items) {
    expect(item, fmt::format("an entry of {}", what), ValueKind::table);
    reject_unknown(item, fmt::format("an entry of {}", what), keys);
    Rule rule;
    const InputValue* engine = item.find("engine");
    const InputValue* when = item.find("when");
    const InputValue* why = item.find("why");
    if (engine == nullptr && when == nullptr) {
      reject(item.at, fmt::format("an entry of {} needs 'engine' or 'when' or both", what));
    }
    if (why == nullptr) reject(item.at, fmt::format("an entry of {} needs 'why'", what));
    rule.why = filled_text(*why, "why");
    if (engine != nullptr) {
      rule.selector =
          expect_selector(filled_text(*engine, "engine"), engine->at, catalogues, false);
      // In a rule the bare name means all variants: a rule is about the engine.
      if (rule.selector->variant.empty()) rule.selector->variant = "*";
    }
    if (when != nullptr) {
      rule.when = parse_condition(filled_text(*when, "when"), when->at,
                                  condition_names(scenario, catalogues));
    }
    if (with_outcome) {
      const InputValue* outcome = item.find("outcome");
      if (outcome == nullptr) reject(item.at, "an entry of expect needs 'outcome'");
      rule.outcome = filled_text(*outcome, "outcome");
      if (std::ranges::find(k_outcomes, rule.outcome) == k_outcomes.end()) {
        reject(outcome->at, fmt::format("no outcome '{}'{}", rule.outcome,
                                        known_names(rule.outcome, k_outcomes)));
      }
    }
    result.push_back(std::move(rule));
  }
  return result;
}

std::uint64_t seed_number(const InputValue& value) {
  const double seed = expect(value, "seeds", ValueKind::integer).number;
  if (seed < 1.0) reject(value.at, fmt::format("seeds: {} must be at least 1", seed));
  return static_cast<std::uint64_t>(seed);
}

std::vector<std::uint64_t> seed_list(const InputValue& value) {
  std::vector<std::uint64_t> seeds;
  if (value.kind == ValueKind::array) {
    for (const InputValue* item : one_or_more(value, "seeds")) {
      const std::uint64_t seed = seed_number(*item);
      if (std::ranges::find(seeds, seed) != seeds.end()) {
        reject(item->at, fmt::format("seeds lists {} twice", seed));
      }
      seeds.push_back(seed);
    }
    return seeds;
  }
  const std::uint64_t count = seed_number(value);
  if (count > 1'000'000) reject(value.at, fmt::format("seeds = {}: at most 1000000", count));
  for (std::uint64_t seed = 1; seed <= count; ++seed) seeds.push_back(seed);
  return seeds;
}

Perturbation perturbation(const InputValue& table) {
  expect(table, "perturb", ValueKind::table);
  reject_unknown(
      table, "perturb",
      {"position_m", "angle_rad", "velocity_mps", "angular_velocity_radps", "distribution"});
  Perturbation result;
  bool any = false;
  const auto read = [&](const char* name, double& size) {
    const InputValue* value = table.find(name);
    if (value == nullptr) return;
    size = positive_number(*value, name);
    any = true;
  };
  read("position_m", result.position_m);
  read("angle_rad", result.angle_rad);
  read("velocity_mps", result.velocity_mps);
  read("angular_velocity_radps", result.angular_velocity_radps);
  if (!any) reject(table.at, "perturb names no quantity to perturb");
  if (const InputValue* value = table.find("distribution")) {
    result.distribution = filled_text(*value, "distribution");
    if (result.distribution != "normal" && result.distribution != "uniform") {
      reject(value->at, fmt::format("no distribution '{}'{}", result.distribution,
                                    known_names(result.distribution, {"normal", "uniform"})));
    }
  }
  return result;
}

std::vector<double> step_list(const InputValue& value, double duration_s) {
  const Axis steps = axis("step_s", value, [&](const InputValue& item) {
    const double step_s = positive_number(item, "step_s");
    const double count = duration_s / step_s;
    if (!(count <= k_most_steps)) {
      reject(item.at, fmt::format("duration_s = {} in steps of {} s is {:.3g} steps; a cell has at "
                                  "most {:.0e}",
                                  duration_s, step_s, count, k_most_steps));
    }
    if (std::round(count) < 1.0 ||
        std::abs(count - std::round(count)) > k_whole_steps_tolerance * count) {
      reject(item.at, fmt::format("duration_s = {} is not a whole number of steps of {} s",
                                  duration_s, step_s));
    }
    return ParameterValue(step_s);
  });
  std::vector<double> result;
  for (const ParameterValue& step : steps.values) result.push_back(std::get<double>(step));
  return result;
}

std::vector<std::string> metric_list(const InputValue* value, const Catalogues& catalogues) {
  const std::vector<std::string> known = names_of(catalogues.metrics);
  if (value == nullptr) return known;
  std::set<std::string> wanted;
  for (const InputValue* item : one_or_more(*value, "metrics")) {
    const std::string& name = filled_text(*item, "metrics");
    if (std::ranges::find(known, name) == known.end()) {
      reject(item->at, fmt::format("no metric '{}'{}", name, known_names(name, known)));
    }
    wanted.insert(name);
  }
  std::vector<std::string> names;
  std::ranges::copy_if(known, std::back_inserter(names),
                       [&](const std::string& name) { return wanted.contains(name); });
  return names;
}

SceneChoice scene_of(const InputValue& table, const Catalogues& catalogues) {
  const InputValue* name = table.find("scenario");
  if (name == nullptr) reject(table.at, "an experiment needs the key 'scenario'");
  filled_text(*name, "scenario");
  auto choice = choose_scene(*name, catalogues);
  if (!choice) throw choice.error();
  return std::move(*choice);
}

const InputValue& required(const InputValue& table, const char* key) {
  const InputValue* value = table.find(key);
  if (value == nullptr) reject(table.at, fmt::format("an experiment needs the key '{}'", key));
  return *value;
}

Experiment experiment(const InputValue& table, const Catalogues& catalogues) {
  expect(table, "experiment", ValueKind::table);
  reject_unknown(table, "an experiment", k_experiment_keys);
  const SceneChoice choice = scene_of(table, catalogues);
  const Scenario& scenario = *choice.scenario;
  Experiment result;
  result.scenario = scenario.name;
  result.file_scene = choice.file;
  result.at = table.at;
  const InputValue* name = table.find("name");
  result.name = name == nullptr ? scenario.name : file_word(*name, "name");
  result.engines = engine_choices(required(table, "engines"), catalogues);
  const InputValue* duration = table.find("duration_s");
  result.duration_s =
      duration == nullptr ? scenario.duration_s : positive_number(*duration, "duration_s");
  result.step_s = step_list(required(table, "step_s"), result.duration_s);
  if (const InputValue* limit = table.find("time_limit_s")) {
    result.time_limit_s = positive_number(*limit, "time_limit_s");
  }
  result.parameters_at = table.at;
  if (const InputValue* parameters = table.find("parameters")) {
    result.parameters = parameter_axes(scenario, *parameters);
    result.parameters_at = parameters->at;
  }
  if (const InputValue* zip = table.find("zip")) result.zip = zip_groups(*zip, result.parameters);
  const InputValue* seeds = table.find("seeds");
  const InputValue* perturb = table.find("perturb");
  if (seeds != nullptr && perturb == nullptr) {
    reject(seeds->at, "seeds without perturb would only repeat the same run");
  }
  if (perturb != nullptr && seeds == nullptr) reject(perturb->at, "perturb needs seeds");
  if (seeds != nullptr) result.seeds = seed_list(*seeds);
  if (perturb != nullptr) result.perturb = perturbation(*perturb);
  if (const InputValue* list = table.find("except")) {
    result.except = rules(*list, false, scenario, catalogues);
  }
  if (const InputValue* list = table.find("expect")) {
    result.expected = rules(*list, true, scenario, catalogues);
  }
  result.metrics = metric_list(table.find("metrics"), catalogues);
  return result;
}

BenchChoice bench_choice(const InputValue& table, const Catalogues& catalogues) {
  expect(table, "bench", ValueKind::table);
  reject_unknown(table, "bench", {"base", "repeat"});
  const InputValue* base = table.find("base");
  if (base == nullptr) reject(table.at, "bench needs the key 'base'");
  BenchChoice result;
  result.base = expect_selector(filled_text(*base, "base"), base->at, catalogues, false);
  if (const InputValue* repeat = table.find("repeat")) {
    const double rounds = expect(*repeat, "repeat", ValueKind::integer).number;
    if (rounds < 1.0 || rounds > 1000.0) reject(repeat->at, "repeat must be from 1 to 1000");
    result.repeat = static_cast<std::size_t>(rounds);
  }
  return result;
}

// Rows name the scene, so that one name must mean one file.
void reject_namesake(const InputValue& table, const std::vector<Experiment>& experiments) {
  const Experiment& last = experiments.back();
  for (const Experiment& other : experiments) {
    if (other.scenario != last.scenario || other.file_scene == nullptr) continue;
    if (other.file_scene->hash == last.file_scene->hash) continue;
    reject(table.find("scenario")->at,
           fmt::format("{} and {} are different scenes of one name: rename one",
                       other.file_scene->file, last.file_scene->file));
  }
}

Plan plan(const InputValue& table, const Catalogues& catalogues) {
  reject_unknown(table, "a plan", k_plan_keys);
  Plan result;
  const InputValue* title = table.find("title");
  if (title == nullptr) reject({table.at.file, 0, 0}, "a plan needs the key 'title'");
  result.title = filled_text(*title, "title");
  if (const InputValue* analysis = table.find("analysis")) {
    result.analysis = expect(*analysis, "analysis", ValueKind::text).text;
  }
  if (const InputValue* bench = table.find("bench"))
    result.bench = bench_choice(*bench, catalogues);
  const InputValue* list = table.find("experiment");
  if (list == nullptr) reject({table.at.file, 0, 0}, "a plan needs at least one [[experiment]]");
  if (list->kind != ValueKind::array) {
    reject(list->at, "experiment must be an array of tables: write [[experiment]]");
  }
  std::set<std::string> names;
  for (const InputValue& item : list->items) {
    result.experiments.push_back(experiment(item, catalogues));
    reject_namesake(item, result.experiments);
    const std::string& name = result.experiments.back().name;
    if (!names.insert(name).second) {
      reject(item.at, fmt::format("two experiments are called '{}': give one a name", name));
    }
  }
  if (const InputValue* trajectory = table.find("trajectory")) {
    std::vector<std::string> known;
    for (const Experiment& item : result.experiments) {
      for (auto& quantity : condition_names(scenario_of(item, catalogues), catalogues)) {
        known.push_back(std::move(quantity));
      }
    }
    result.trajectory = trajectory_choice(*trajectory, std::move(known), catalogues);
  }
  return result;
}

}  // namespace

Checked<Plan> parse_plan(const std::string& text, const std::filesystem::path& file,
                         const Catalogues& catalogues, const Overrides& overrides) {
  auto table = parse_toml(text, file.string());
  if (!table) return tl::unexpected(table.error());
  try {
    override_values(*table, overrides, catalogues);
    Plan result = plan(*table, catalogues);
    result.file = file;
    result.name = file.stem().string();
    result.text = text;
    return result;
  } catch (const InputError& error) {
    return tl::unexpected(error);
  }
}

Checked<Plan> read_plan(const std::filesystem::path& file, const Catalogues& catalogues,
                        const Overrides& overrides) {
  const auto text = read_file(file);
  if (!text) return file_error(file.string(), text.error().reason);
  return parse_plan(*text, file, catalogues, overrides);
}

}  // namespace brickbench
