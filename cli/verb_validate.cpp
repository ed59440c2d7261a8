#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/build_facts.hpp"
#include "cli/complain.hpp"
#include "cli/json_number.hpp"
#include "cli/report_output.hpp"
#include "cli/terminal.hpp"
#include "cli/validate_scenes.hpp"
#include "cli/validation_output.hpp"
#include "cli/verbs.hpp"
#include "experiments/exact/order.hpp"
#include "experiments/exact/sketch.hpp"
#include "experiments/exact/validate.hpp"
#include "experiments/record/csv.hpp"
#include "experiments/record/file.hpp"
#include "experiments/record/provenance.hpp"
#include "experiments/run/selector.hpp"

namespace brickbench {
namespace {

using Json = nlohmann::ordered_json;

struct ValidateOptions {
  std::vector<std::string> engines = {"all"};
  std::string cases = "all";
  bool predict = false;
  bool order = false;
  std::string symmetry;                 // a scene, or all, whose images are compared; empty: none
  std::vector<std::string> parameters;  // of the scene of `symmetry`, name=value
  std::string stable_step;              // a scene at rest; empty: none
  std::vector<std::string> knobs;       // name=value
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

std::string reproduce(const exact::CellResult& cell, const std::vector<std::string>& knobs) {
  std::vector<std::string> words = {"brickbench", "validate",
                                    "--engine",   cell.engine + '/' + cell.variant,
                                    "--case",     cell.case_id};
  for (const std::string& knob : knobs) words.insert(words.end(), {"--knob", knob});
  return shell_command(words);
}

Json cell_json(const exact::CellResult& cell, const std::string& reproduce) {
  auto scores = Json::array();
  for (const exact::Score& score : cell.scores) {
    scores.push_back({{"id", score.observable},
                      {"unit", score.unit},
                      {"truth", json_number(score.truth)},
                      {"predicted", json_number(score.predicted)},
                      {"measured", json_number(score.measured)},
                      {"scale", json_number(score.scale)},
                      {"error", json_number(score.error)},
                      {"explained", json_number(score.explained)},
                      {"unexplained", json_number(score.unexplained)}});
  }
  Json json = {{"id", fmt::format("{}/{}:{}", cell.engine, cell.variant, cell.case_id)},
               {"engine", cell.engine},
               {"variant", cell.variant},
               {"case", cell.case_id},
               {"outcome", cell.outcome},
               {"reason", cell.reason},
               {"failed", cell.failed()},
               {"bound", cell.bound},
               {"no_prediction", cell.no_prediction},
               {"law", cell.law},
               {"scores", scores}};
  if (cell.bracket) {
    json["threshold"] = {
        {"parameter", cell.bracket->parameter},      {"unit", cell.bracket->unit},
        {"truth", json_number(cell.bracket->truth)}, {"low", json_number(cell.bracket->low)},
        {"high", json_number(cell.bracket->high)},   {"found", cell.bracket->found}};
  }
  json["reproduce"] = reproduce;
  return json;
}

std::string digits(double value) {
  return std::isnan(value) ? std::string("-") : fmt::format("{:.3g}", value);
}
std::string digits(const std::optional<double>& value) { return value ? digits(*value) : "-"; }

double largest(const exact::CellResult& cell, double exact::Score::*part) {
  double worst = std::nan("");
  for (const exact::Score& score : cell.scores) {
    const double value = score.*part;
    if (!std::isnan(value) && (std::isnan(worst) || value > worst)) worst = value;
  }
  return worst;
}

// Worst observable of each cell: error, explained and unexplained part, and how to see it again.
void print_line(const exact::CellResult& cell, const std::string& reproduce) {
  double explained = std::nan("");
  for (const exact::Score& score : cell.scores) {
    if (score.explained && !std::isnan(*score.explained)) {
      explained = std::isnan(explained) ? *score.explained : std::max(explained, *score.explained);
    }
  }
  const std::string verdict = cell.failed()              ? "FAILED"
                              : cell.outcome != "ok"     ? cell.outcome
                              : cell.worst_unexplained() ? "ok"
                                                         : "open";
  fmt::print("{:<30} {:<18} {:<8} {:>9} {:>9} {:>9}  {}\n", cell.case_id,
             cell.engine + '/' + cell.variant, verdict,
             cell.outcome == "ok" ? digits(largest(cell, &exact::Score::error)) : "-",
             digits(explained), digits(cell.worst_unexplained()), reproduce);
  if (!cell.law.empty()) fmt::print("    law of impact: {}\n", cell.law);
  if (!cell.reason.empty()) fmt::print("    {}\n", cell.reason);
  if (cell.outcome == "ok" && !cell.no_prediction.empty()) {
    fmt::print("    no prediction: {}\n", cell.no_prediction);
  }
  if (cell.bracket && cell.bracket->found) {
    fmt::print("    {} between {:.6g} and {:.6g} {}, exact {:.6g}\n", cell.bracket->parameter,
               cell.bracket->low, cell.bracket->high, cell.bracket->unit, cell.bracket->truth);
  }
  if (cell.bracket && !cell.bracket->found) {
    fmt::print("    {}: the same outcome at {:.6g} and {:.6g} {}, exact {:.6g}\n",
               cell.bracket->parameter, cell.bracket->low, cell.bracket->high, cell.bracket->unit,
               cell.bracket->truth);
  }
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

int validate(const ValidateOptions& options) {
  const Catalogues catalogues = all_catalogues();
  std::vector<EngineVariant> engines;
  for (const std::string& text : options.engines) {
    const auto selector = parse_selector(text, {.file = "--engine"}, catalogues, true);
    if (!selector) return complain(selector.error().text(), k_exit_bad_input);
    for (const EngineVariant& engine : select(*selector, catalogues)) engines.push_back(engine);
  }
  const auto knobs = parse_numbers("--knob", options.knobs);
  if (!knobs) return complain(knobs.error());
  for (const EngineVariant& engine : engines) {
    const Settings settings{.variant = engine.variant, .knobs = *knobs};
    const auto known = brickbench::validate(*find_adapter(catalogues, engine.engine), settings);
    if (!known) return complain(known.error());
  }
  const auto cases = exact::select_cases(exact::exact_cases(), options.cases);
  if (cases.empty()) {
    return complain(
        fmt::format("no case '{}': all, family.* or one of `brickbench list cases`", options.cases),
        k_exit_bad_input);
  }
  const bool table = options.symmetry.empty() && options.stable_step.empty() && !options.order;
  if (!table && !knobs->empty()) {
    return complain("--knob goes with the table of cases and with --predict only",
                    k_exit_bad_input);
  }
  if (options.symmetry.empty() && !options.parameters.empty()) {
    return complain("--parameter is of the scene of --symmetry", k_exit_bad_input);
  }
  for (const std::string& out : {options.out, options.figures}) {
    if (const auto free = check_is_new(out); !free) return complain(free.error());
  }
  if (!options.figures.empty()) return draw_starts(cases, options.figures);
  if (!options.out.empty()) {
    if (!options.symmetry.empty() || !options.stable_step.empty() || options.predict) {
      return complain("--out saves the table of cases, or with --order their orders, only",
                      k_exit_bad_input);
    }
  }
  if (!options.symmetry.empty()) {
    const auto parameters = parse_numbers("--parameter", options.parameters);
    if (!parameters) return complain(parameters.error());
    return compare_symmetries(engines, catalogues, options.symmetry,
                              ParameterValues(parameters->begin(), parameters->end()),
                              options.json);
  }
  if (!options.stable_step.empty()) {
    return search_stable_steps(engines, catalogues, options.stable_step, options.json);
  }
  if (options.order) return fit_orders(engines, catalogues, cases, options);
  if (options.predict) {
    print_predictions(engines, catalogues, cases, *knobs);
    return k_exit_fine;
  }
  auto cells = Json::array();
  std::size_t failed = 0, held = 0, open = 0;
  Progress progress(engines.size() * cases.size());
  if (!options.json) {
    fmt::print("{:<30} {:<18} {:<8} {:>9} {:>9} {:>9}  {}\n", "case", "engine", "verdict", "error",
               "explained", "unexpl.", "reproduce with");
  }
  for (const exact::ExactCase& exact_case : cases) {
    for (const EngineVariant& engine : engines) {
      progress.begin(exact_case.id + ' ' + engine.label());
      const exact::CellResult cell = exact::validate(*find_adapter(catalogues, engine.engine),
                                                     engine.variant, exact_case, {}, *knobs);
      progress.end(fmt::format("{} {}: {}", exact_case.id, engine.label(), cell.outcome));
      failed += cell.failed();
      const bool predicted = cell.outcome == "ok" && cell.worst_unexplained().has_value();
      held += predicted && !cell.failed();
      open += cell.outcome == "ok" && !predicted;
      const std::string again = reproduce(cell, options.knobs);
      cells.push_back(cell_json(cell, again));
      if (!options.json) print_line(cell, again);
    }
  }
  const std::size_t count = engines.size() * cases.size();
  const int exit_code = failed > 0 ? k_exit_failed_case : k_exit_fine;
  Json json = {{"cells", std::move(cells)}, {"count", count}, {"failed", failed},
               {"within_bounds", held},     {"open", open},   {"exit_code", exit_code}};
  if (options.json) {
    fmt::print("{}\n", json.dump(2));
  } else {
    fmt::print(
        "{} of {} cells follow their scheme within the bounds, {} failed, {} have no "
        "discrete prediction, {} refused.\n",
        held, count, failed, open, count - held - failed - open);
  }
  if (options.out.empty()) return exit_code;
  json["engines"] = audited_engines(engines, catalogues, cases, *knobs);
  const auto saved =
      save_validation(options.out, "validation.json", json, "Exact cases in all engines asked for",
                      options.arguments, engines, catalogues);
  return saved ? exit_code : complain(saved.error());
}

}  // namespace

void add_validate_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb = app.add_subcommand(
      "validate", "Check engines against exact cases and against their own documented schemes");
  auto options = std::make_shared<ValidateOptions>();
  verb->add_option("--engine", options->engines, "Engine selector; may be repeated; default all")
      ->expected(1)
      ->take_all();
  verb->add_option("--case", options->cases, "all, family.* or the id of one case");
  verb->add_flag("--predict", options->predict,
                 "Print what the schemes predict, as CSV, without running any engine");
  verb->add_flag("--order", options->order,
                 "Fit the order of convergence of the first observable on a ladder of steps");
  verb->add_option("--symmetry", options->symmetry,
                   "Compare a scene, or all, with its mirrored, turned, shifted and scaled images");
  verb->add_option("--parameter", options->parameters,
                   "name=number of the scene of --symmetry; may be repeated")
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
    invocation.exit_code = validate(*options);
  });
}

}  // namespace brickbench
