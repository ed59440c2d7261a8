#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/complain.hpp"
#include "cli/engine_files.hpp"
#include "cli/json_number.hpp"
#include "cli/known_questions.hpp"
#include "cli/report_output.hpp"
#include "cli/validate_cases.hpp"
#include "cli/validate_scenes.hpp"
#include "cli/validation_output.hpp"
#include "cli/verbs.hpp"
#include "experiments/exact/sketch/sketch.hpp"
#include "experiments/exact/validation/order.hpp"
#include "experiments/exact/validation/validate.hpp"
#include "experiments/record/file.hpp"
#include "experiments/run/plan_files.hpp"
#include "experiments/run/selector.hpp"

namespace brickbench {
namespace {

using Json = nlohmann::ordered_json;

struct ValidateOptions {
  std::vector<std::string> engines = {"all"};
  std::vector<std::string> engine_files;
  std::string cases = "all";
  bool predict = false;
  bool order = false;
  std::string symmetry;                 // a scene, or all, whose images are compared; empty: none
  std::vector<std::string> parameters;  // of the scene of `symmetry` or of the case, name=value
  std::size_t scan = 0;                 // drawings per case; 0: the cases at given values
  std::uint64_t seed = 1;               // of the drawings
  std::string questions;                // file of open questions; empty: the project's
  std::string stable_step;              // a scene at rest; empty: none
  std::vector<std::string> knobs;       // name=value
  std::vector<std::string> set;         // either, knobs as knob.name=value
  std::string figures;                  // a new folder for the cases' starts; empty: none
  bool json = false;
  std::string out;                     // a new folder for `report`; empty: none
  std::vector<std::string> arguments;  // as typed
};

// name=number, ... as typed; Fault::invalid names what is not of that form.
Expected<KnobValues> parse_numbers(const std::string& option,
                                   const std::vector<std::string>& texts) {
  KnobValues numbers;
  for (const std::string& text : texts) {
    const std::size_t sign = text.find('=');
    double value = 0.0;
    const char* end = text.data() + text.size();
    const auto read = sign == std::string::npos
                          ? std::from_chars_result{nullptr, std::errc::invalid_argument}
                          : std::from_chars(text.data() + sign + 1, end, value);
    if (read.ec != std::errc() || read.ptr != end) {
      return fail(Fault::invalid, fmt::format("{} {}: wanted is name=number", option, text));
    }
    numbers[text.substr(0, sign)] = value;
  }
  return numbers;
}

// One row per observable: what each scheme predicts, before any engine runs.
void print_predictions(const std::vector<EngineVariant>& engines, const Catalogues& catalogues,
                       const std::vector<exact::ExactCase>& cases, const KnobValues& knobs) {
  fmt::print("engine,variant,case,observable,unit,truth,predicted,scale,no_prediction\n");
  for (const EngineVariant& engine : engines) {
    const Adapter& adapter = *find_adapter(catalogues, engine.engine);
    for (const exact::ExactCase& exact_case : cases) {
      const exact::ExactRun run = exact::build(exact_case).value();
      const exact::CellResult cell =
          exact::predict(adapter, engine.variant, exact_case, run, knobs);
      for (const exact::Score& score : cell.scores) {
        fmt::print("{},{},{},{},{},{},{},{},{}\n", cell.engine, cell.variant, cell.case_id,
                   score.observable, score.unit, score.truth,
                   score.predicted ? fmt::format("{}", *score.predicted) : "", score.scale,
                   cell.no_prediction);
      }
    }
  }
}

Json order_json(const exact::OrderResult& result) {
  auto ladder = Json::array();
  for (const exact::LadderRung& rung : result.ladder) {
    ladder.push_back(
        {{"step_s", rung.step_s}, {"error", json_number(rung.error)}, {"cpu_s", rung.cpu_s}});
  }
  return {{"id", fmt::format("{}/{}:{}", result.engine, result.variant, result.case_id)},
          {"engine", result.engine},
          {"variant", result.variant},
          {"case", result.case_id},
          {"outcome", result.outcome},
          {"reason", result.reason},
          {"order", json_number(result.fit.order)},
          {"half_width_95", json_number(result.fit.half_width)},
          {"at_rounding", result.fit.at_rounding},
          {"promised", result.promised},
          {"ladder", ladder}};
}

// Orders of convergence and the cost of each rung, for accuracy-versus-cost plots.
int fit_orders(const std::vector<EngineVariant>& engines, const Catalogues& catalogues,
               const std::vector<exact::ExactCase>& cases, const ValidateOptions& options) {
  auto results = Json::array();
  if (!options.json) {
    fmt::print("{:<30} {:<18} {:>16} {:>8}  finest: step_s, error, cpu_s\n", "case", "engine",
               "order", "promised");
  }
  for (const exact::ExactCase& exact_case : cases) {
    for (const EngineVariant& engine : engines) {
      const exact::OrderResult result =
          exact::convergence(*find_adapter(catalogues, engine.engine), engine.variant, exact_case);
      results.push_back(order_json(result));
      if (options.json) continue;
      const std::string order =
          result.outcome != "ok" ? result.outcome
          : result.fit.at_rounding
              ? "rounding"
              : fmt::format("{:.3f} +- {:.3f}", result.fit.order, result.fit.half_width);
      fmt::print("{:<30} {:<18} {:>16} {:>8.3g}", exact_case.id, engine.label(), order,
                 result.promised);
      if (!result.ladder.empty()) {
        const exact::LadderRung& finest = result.ladder.back();
        fmt::print("  {:.3g} {:.3g} {:.3g}", finest.step_s, finest.error, finest.cpu_s);
      }
      fmt::print("\n");
    }
  }
  if (options.json) fmt::print("{}\n", results.dump(2));
  if (options.out.empty()) return k_exit_fine;
  const auto saved = save_validation(options.out, "orders.json", {{"orders", results}},
                                     "Orders of convergence and cost in exact cases",
                                     options.arguments, engines, catalogues);
  return saved ? k_exit_fine : complain(saved.error());
}

// The start of each case, ID.svg.
int draw_starts(const std::vector<exact::ExactCase>& cases, const std::string& folder) {
  std::vector<OutputFile> files;
  for (const exact::ExactCase& exact_case : cases) {
    files.push_back(
        {exact_case.id + ".svg", exact::sketch_svg(exact_case, exact::build(exact_case).value())});
  }
  const auto written = write_folder(folder, files);
  return written ? k_exit_fine : complain(written.error());
}

// As asked, or what is wrong.
Expected<std::vector<EngineVariant>> engines_of(const ValidateOptions& options,
                                                const Catalogues& catalogues,
                                                const KnobValues& knobs) {
  std::vector<EngineVariant> engines;
  for (const std::string& text : options.engines) {
    const auto selector = parse_selector(text, {.file = "--engine"}, catalogues, true);
    if (!selector) return fail(Fault::invalid, selector.error().text());
    for (const EngineVariant& engine : select(*selector, catalogues)) engines.push_back(engine);
  }
  for (const EngineVariant& engine : engines) {
    const Settings settings{.variant = engine.variant, .knobs = knobs};
    const auto known = brickbench::validate(*find_adapter(catalogues, engine.engine), settings);
    if (!known) return tl::unexpected(known.error());
  }
  return engines;
}

// Which options go with which.
Expected<void> check_company(const ValidateOptions& options, std::size_t cases) {
  const bool symmetry = !options.symmetry.empty(), stable = !options.stable_step.empty();
  const bool table = !symmetry && !stable && !options.order && !options.predict;
  const auto refuse = [](std::string reason) { return fail(Fault::invalid, std::move(reason)); };
  if (!options.knobs.empty() && (symmetry || stable || options.order)) {
    return refuse("--knob goes with the table of cases, with --scan and with --predict only");
  }
  if (options.scan > 0 && !table) return refuse("--scan is a way of running the table of cases");
  if (options.scan > 0 && !options.parameters.empty()) {
    return refuse("--scan draws the parameters that --parameter would state");
  }
  if (!options.parameters.empty() && !symmetry && !(table && cases == 1)) {
    return refuse("--parameter is of the scene of --symmetry, or of the one case of --case");
  }
  if (!options.out.empty() && (symmetry || stable || options.predict || options.scan > 0)) {
    return refuse("--out saves the table of cases, or with --order their orders, only");
  }
  if (auto ok = check_is_new(options.figures); !ok) return ok;
  return check_is_new(options.out);
}

int run_cases(const ValidateOptions& options, CasesAsked asked, const Catalogues& catalogues) {
  auto questions = known_questions(options.questions);
  if (!questions) return complain(questions.error());
  asked.questions = std::move(*questions);
  asked.json = options.json;
  asked.out = options.out;
  asked.knob_text = options.knobs;
  asked.engine_files = options.engine_files;
  asked.arguments = options.arguments;
  if (options.scan > 0) return scan_cases(asked, catalogues, options.scan, options.seed);
  if (!asked.parameters.empty()) {
    const auto run = exact::build(asked.cases.front(), asked.parameters);
    if (!run) return complain(run.error());
  }
  return tabulate_cases(asked, catalogues);
}

// --set is the one language for both.
ValidateOptions with_settings(ValidateOptions options) {
  constexpr std::string_view k_knob = "knob.";
  for (const std::string& setting : options.set) {
    if (setting.starts_with(k_knob)) {
      options.knobs.push_back(setting.substr(k_knob.size()));
    } else {
      options.parameters.push_back(setting);
    }
  }
  options.set.clear();
  return options;
}

int validate(const ValidateOptions& options) {
  const auto known = running_catalogues(options.engine_files);
  if (!known) return complain(known.error().text(), k_exit_bad_input);
  const Catalogues& catalogues = *known;
  const auto knobs = parse_numbers("--knob", options.knobs);
  if (!knobs) return complain(knobs.error());
  const auto parameters = parse_numbers("--parameter", options.parameters);
  if (!parameters) return complain(parameters.error());
  const auto engines = engines_of(options, catalogues, *knobs);
  if (!engines) return complain(engines.error());
  const auto cases = exact::select_cases(exact::exact_cases(), options.cases);
  if (cases.empty()) {
    return complain(
        fmt::format("no case '{}': all, family.* or one of `brickbench list cases`", options.cases),
        k_exit_bad_input);
  }
  if (auto ok = check_company(options, cases.size()); !ok) return complain(ok.error());
  const ParameterValues values(parameters->begin(), parameters->end());
  if (!options.figures.empty()) return draw_starts(cases, options.figures);
  if (!options.symmetry.empty()) {
    return compare_symmetries(*engines, catalogues, options.symmetry, values, options.json);
  }
  if (!options.stable_step.empty()) {
    return search_stable_steps(*engines, catalogues, options.stable_step, options.json);
  }
  if (options.order) return fit_orders(*engines, catalogues, cases, options);
  if (options.predict) {
    print_predictions(*engines, catalogues, cases, *knobs);
    return k_exit_fine;
  }
  return run_cases(options,
                   {.engines = *engines, .cases = cases, .knobs = *knobs, .parameters = values},
                   catalogues);
}

}  // namespace

void add_validate_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb = app.add_subcommand(
      "validate", "Check engines against exact cases and against their own documented schemes");
  auto options = std::make_shared<ValidateOptions>();
  verb->add_option("--engine", options->engines, "Engine selector; may be repeated; default all")
      ->expected(1)
      ->take_all();
  add_engine_files(*verb, options->engine_files);
  verb->add_option("--case", options->cases, "all, family.* or the id of one case");
  verb->add_flag("--predict", options->predict,
                 "Print what the schemes predict, as CSV, without running any engine");
  verb->add_flag("--order", options->order,
                 "Fit the order of convergence of the first observable on a ladder of steps");
  verb->add_option("--scan", options->scan,
                   "Draw each case's parameters so many times at random over its domain");
  verb->add_option("--seed", options->seed, "Of the drawings; default 1");
  verb->add_option("--questions", options->questions,
                   "File of the cells that are known to fail; default that of the project");
  verb->add_option("--symmetry", options->symmetry,
                   "Compare a scene, or all, with its mirrored, turned, shifted and scaled images");
  verb->add_option("--parameter", options->parameters,
                   "name=number of the one case, or of the scene of --symmetry; may be repeated")
      ->expected(1)
      ->take_all();
  verb->add_option("--set", options->set,
                   "name=number as --parameter, knob.name=number as --knob; may be repeated")
      ->expected(1)
      ->take_all();
  verb->add_option("--stable-step", options->stable_step,
                   "Find the largest step that keeps a scene at rest standing for 2 s");
  verb->add_option("--knob", options->knobs,
                   "name=number of every engine asked for; may be repeated")
      ->expected(1)
      ->take_all();
  verb->add_option("--figures", options->figures,
                   "New folder: draw the start of each case as SVG, without running any engine");
  verb->add_flag("--json", options->json, "The result as JSON on standard output");
  verb->add_option("--out", options->out,
                   "New folder for the table, or with --order the orders; `report` reads it");
  verb->callback([options, &invocation] {
    options->arguments = invocation.arguments;
    invocation.exit_code = validate(with_settings(*options));
  });
}

}  // namespace brickbench
