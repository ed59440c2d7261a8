#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "adapters/seam/unit.hpp"
#include "cli/build_facts.hpp"
#include "cli/complain.hpp"
#include "cli/scene_settings.hpp"
#include "cli/terminal.hpp"
#include "cli/verbs.hpp"
#include "experiments/record/provenance.hpp"
#include "experiments/record/schema.hpp"
#include "experiments/run/plan.hpp"
#include "experiments/run/threshold.hpp"

namespace brickbench {
namespace {

struct ThresholdOptions {
  std::string scene;
  std::vector<std::string> set;
  std::string vary;
  std::vector<double> between;
  std::string until;
  std::vector<std::string> engines = {"all"};
  double step_s = 0.002;
  double duration_s = 0.0;  // 0: the scene's
  double width = 1e-3;
  std::uint64_t seeds = 0;
  double perturb_m = 0.0;
  bool json = false;
};

// The question, but for engine and seed.
struct AskedThreshold {
  Catalogues catalogues;
  SceneChoice choice;
  std::vector<EngineVariant> engines;
  ThresholdQuestion question;
  std::string unit;
};

tl::unexpected<InputError> bad_option(const std::string& option, std::string reason) {
  return tl::unexpected<InputError>({{option, 0, 0}, std::move(reason)});
}

// The varied parameter and the ends of the search; complains where they are none.
Checked<void> set_range(const ThresholdOptions& options, AskedThreshold& asked) {
  const Scenario& scenario = *asked.choice.scenario;
  const auto parameter = std::ranges::find(scenario.parameters, options.vary, &Parameter::name);
  const std::string option = "--vary " + options.vary;
  if (parameter == scenario.parameters.end()) {
    return bad_option(option,
                      fmt::format("{} has no parameter '{}'{}", scenario.name, options.vary,
                                  known_names(options.vary, names_of(scenario.parameters))));
  }
  if (parameter->kind != ParameterKind::number && parameter->kind != ParameterKind::integer) {
    return bad_option(option, "only numbers can be bisected");
  }
  ThresholdQuestion& question = asked.question;
  question.parameter = parameter->name;
  question.whole = parameter->kind == ParameterKind::integer;
  question.low = options.between[0];
  question.high = options.between[1];
  question.width = options.width;
  asked.unit = parameter->unit;
  if (!(question.low < question.high)) {
    return bad_option("--between", "the first value must be below the second");
  }
  for (const double end : options.between) {
    ParameterValues values = question.cell.parameters;
    values[question.parameter] = end;
    if (auto scene = build(scenario, values); !scene) {
      return bad_option("--between", scene.error().reason);
    }
  }
  return {};
}

Checked<AskedThreshold> asked_threshold(const ThresholdOptions& options) {
  AskedThreshold asked;
  asked.catalogues = all_catalogues();
  auto choice = choose_scene(options.scene, "scene " + options.scene, asked.catalogues);
  if (!choice) return tl::unexpected(choice.error());
  asked.choice = std::move(*choice);
  const Scenario& scenario = *asked.choice.scenario;
  const auto given = scene_settings(options.set);
  if (!given) return bad_option("--set", given.error().reason);
  auto values = complete(scenario, *given);
  if (!values) return bad_option("--set", values.error().reason);
  auto until = threshold_condition(options.until, "--until", asked.catalogues);
  if (!until) return tl::unexpected(until.error());
  if (options.seeds > 0 && options.perturb_m <= 0.0) {
    return bad_option("--seeds", "seeds without --perturb would only repeat the same run");
  }
  if (options.seeds == 0 && options.perturb_m > 0.0) {
    return bad_option("--perturb", "it needs --seeds");
  }
  Cell& cell = asked.question.cell;
  cell.experiment = scenario.name;
  cell.scenario = scenario.name;
  cell.file_scene = asked.choice.file;
  cell.parameters = std::move(*values);
  cell.step_s = options.step_s;
  const double duration_s = options.duration_s > 0.0 ? options.duration_s : scenario.duration_s;
  const double steps = std::max(1.0, std::round(duration_s / options.step_s));
  if (steps > k_most_steps) {
    return bad_option("--step",
                      fmt::format("{:.3g} steps; a run has at most {:.0e}", steps, k_most_steps));
  }
  cell.duration_s = steps * options.step_s;
  cell.metrics = until->metrics;
  cell.perturb.position_m = options.perturb_m;
  asked.question.until = std::move(until->condition);
  if (auto ok = set_range(options, asked); !ok) return tl::unexpected(ok.error());
  for (const std::string& text : options.engines) {
    const auto selector = parse_selector(text, {"--engine " + text, 0, 0}, asked.catalogues, true);
    if (!selector) return tl::unexpected(selector.error());
    for (const EngineVariant& engine : select(*selector, asked.catalogues)) {
      asked.engines.push_back(engine);
    }
  }
  return asked;
}

nlohmann::ordered_json answer_json(const ThresholdQuestion& question,
                                   const ThresholdAnswer& answer) {
  auto trials = nlohmann::ordered_json::array();
  for (const ThresholdTrial& trial : answer.trials) {
    trials.push_back({{"value", trial.value},
                      {"held", trial.held},
                      {"outcome", trial.outcome},
                      {"validity", trial.validity}});
  }
  return {{"id", question.cell.engine.label()},
          {"seed", question.cell.seed},
          {"outcome", answer.outcome},
          {"reason", answer.reason},
          {"low", answer.low},
          {"high", answer.high},
          {"held_at_high", answer.held_at_high},
          {"cpu_s", answer.cpu_s},
          {"flagged", answer.flagged},
          {"trials", trials}};
}

void print_answer(const AskedThreshold& asked, const ThresholdQuestion& question,
                  const ThresholdAnswer& answer) {
  const std::string seed =
      question.cell.seed == 0 ? "" : fmt::format(" seed {}", question.cell.seed);
  const std::string who = question.cell.engine.label() + seed;
  if (answer.outcome != "ok") {
    fmt::print("{:<28} {}: {}\n", who, answer.outcome, answer.reason);
    return;
  }
  fmt::print("{:<28} {} .. {}{}; it {} above; {} runs, {:.3g} s of CPU{}\n", who,
             shortest(answer.low), shortest(answer.high), unit_suffix(asked.unit),
             answer.held_at_high ? "holds" : "ends", answer.trials.size(), answer.cpu_s,
             answer.flagged == 0
                 ? ""
                 : fmt::format("; {} runs are flagged: not to be trusted", answer.flagged));
}

// Median and range of the middles of the brackets of several seeds.
void print_distribution(const std::string& engine, std::vector<double> middles, std::size_t seeds) {
  if (middles.empty()) return;
  std::ranges::sort(middles);
  const std::size_t half = middles.size() / 2;
  const double median =
      middles.size() % 2 == 1 ? middles[half] : 0.5 * (middles[half - 1] + middles[half]);
  fmt::print("{:<28} median {:.6g}, from {:.6g} to {:.6g}, over {} of {} seeds\n", engine, median,
             middles.front(), middles.back(), middles.size(), seeds);
}

int find_thresholds(const ThresholdOptions& options) {
  const auto asked = asked_threshold(options);
  if (!asked) return complain(asked.error().text(), k_exit_bad_input);
  const Machine machine = this_machine();
  const Origin origin{machine.revision, machine.label()};
  const std::uint64_t runs = std::max<std::uint64_t>(1, options.seeds);
  Progress progress(asked->engines.size() * runs);
  auto answers = nlohmann::ordered_json::array();
  std::size_t found = 0;
  bool failed = false;
  for (const EngineVariant& engine : asked->engines) {
    std::vector<double> middles;
    for (std::uint64_t run = 0; run < runs; ++run) {
      ThresholdQuestion question = asked->question;
      question.cell.engine = engine;
      question.cell.seed = options.seeds == 0 ? 0 : run + 1;
      progress.begin(engine.label());
      const ThresholdAnswer answer =
          find_threshold(question, asked->catalogues, origin,
                         [&](const ThresholdTrial&, double share) { progress.update(share); });
      progress.end(fmt::format("{}: {}", engine.label(), answer.outcome));
      const bool ok = answer.outcome == "ok";
      found += ok ? 1 : 0;
      failed = failed || (!ok && answer.outcome != "no_change" && answer.outcome != "refused");
      if (ok) middles.push_back(0.5 * (answer.low + answer.high));
      if (options.json)
        answers.push_back(answer_json(question, answer));
      else
        print_answer(*asked, question, answer);
    }
    if (!options.json && options.seeds > 0) {
      print_distribution(engine.label(), std::move(middles), runs);
    }
  }
  const int code = failed ? k_exit_failed_case : found == 0 ? k_exit_incomplete : k_exit_fine;
  if (options.json) {
    const nlohmann::ordered_json json = {{"scene", asked->choice.scenario->name},
                                         {"parameter", asked->question.parameter},
                                         {"unit", asked->unit},
                                         {"until", options.until},
                                         {"exit_code", code},
                                         {"answers", answers}};
    fmt::print("{}\n", json.dump(2));
  }
  return code;
}

}  // namespace

void add_threshold_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb = app.add_subcommand(
      "threshold", "Bisect a parameter of any scene to where a condition on its numbers turns");
  auto options = std::make_shared<ThresholdOptions>();
  verb->add_option("scene", options->scene,
                   "Scene file (it ends in .toml), or one of `list scenarios`")
      ->required();
  verb->add_option("--vary", options->vary, "The parameter, a number")->required();
  verb->add_option("--between", options->between, "Two values between which it turns")
      ->required()
      ->expected(2);
  verb->add_option(
          "--until", options->until,
          "Condition on numbers of `list metrics`, or on outcome: \"bricks_displaced > 0\"")
      ->required();
  verb->add_option("--set", options->set, "key=value of a parameter; may be repeated")
      ->expected(1)
      ->take_all();
  verb->add_option("--engine", options->engines, "Engine selector; may be repeated; default all")
      ->expected(1)
      ->take_all();
  verb->add_option("--step", options->step_s, "Time step, s; default 0.002")
      ->check(CLI::PositiveNumber);
  verb->add_option("--duration", options->duration_s, "Simulated time, s; default the scene's")
      ->check(CLI::PositiveNumber);
  verb->add_option("--width", options->width,
                   "Width of the answer as a share of --between; default 0.001")
      ->check(CLI::Range(1e-12, 1.0));
  verb->add_option("--seeds", options->seeds, "So many perturbed starts, for the distribution")
      ->check(CLI::Range(1, 100000));
  verb->add_option("--perturb", options->perturb_m,
                   "Standard deviation (m) of each start's positions; needs --seeds")
      ->check(CLI::PositiveNumber);
  verb->add_flag("--json", options->json, "The answers with all their runs as JSON");
  verb->callback([options, &invocation] { invocation.exit_code = find_thresholds(*options); });
}

}  // namespace brickbench
