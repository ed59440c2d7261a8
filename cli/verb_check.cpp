#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "cli/build_facts.hpp"
#include "cli/complain.hpp"
#include "cli/json_number.hpp"
#include "cli/terminal.hpp"
#include "cli/verbs.hpp"
#include "experiments/record/file.hpp"
#include "experiments/regression/check.hpp"
#include "experiments/run/plan_files.hpp"

namespace brickbench {
namespace {

using Json = nlohmann::ordered_json;

struct CheckOptions {
  std::string suite = "smoke";
  std::string reference = "reference_data/baseline";
  std::string obtained;
  std::string junit;
  Overrides overrides;
  std::size_t worst = 20;
  bool all_starts = false;
  bool json = false;
};

// obtained-001, obtained-002 ...: nothing is written over.
std::filesystem::path next_obtained(const std::string& suite) {
  for (int n = 1;; ++n) {
    const std::filesystem::path folder = fmt::format("obtained/{}-{:03}", suite, n);
    if (!std::filesystem::exists(folder)) return folder;
  }
}

Json comparison_json(const std::string& command, const gate::Comparison& c) {
  return {{"id", c.experiment + '|' + c.obtained.key()},
          {"experiment", c.experiment},
          {"engine", c.obtained.engine},
          {"axes", c.obtained.axes},
          {"metric", c.obtained.metric},
          {"unit", c.obtained.unit},
          {"kind", gate::to_word(c.reference.kind)},
          {"finding", gate::to_word(c.finding)},
          {"trend", gate::to_word(c.trend)},
          {"reference", json_number(c.reference_value)},
          {"got", json_number(c.obtained_value)},
          {"difference", json_number(c.difference)},
          {"bound", json_number(c.bound)},
          {"factor_over", json_number(c.factor)},
          {"p_value", json_number(c.p_value)},
          {"validity", c.obtained.validity.value_or("")},
          {"starts", c.obtained.seeds.size()},
          {"message", c.message},
          {"reproduce", gate::reproduce(command, c)}};
}

std::size_t count(const gate::CheckResult& result, gate::Finding finding) {
  return static_cast<std::size_t>(
      std::ranges::count(result.comparisons, finding, &gate::Comparison::finding));
}

void print_text(const gate::CheckResult& result, std::size_t worst, const std::string& folder) {
  using gate::Finding;
  std::size_t shown = 0;
  for (const gate::Comparison& c : result.comparisons) {
    if (!gate::is_red(c) || shown++ >= worst) break;
    const std::string_view trend = gate::to_word(c.trend);
    fmt::print("{} {} {} {}{}\n    {}\n    {}\n", gate::to_word(c.finding), c.experiment,
               c.obtained.engine, c.obtained.metric.empty() ? "state hash" : c.obtained.metric,
               trend.empty() ? "" : fmt::format(" ({})", trend), c.message,
               gate::reproduce(result.command, c));
  }
  for (const gate::Comparison& c : result.comparisons) {
    if (c.finding != Finding::open) continue;
    fmt::print("open {} {} {}: {}\n", c.experiment, c.obtained.engine, c.obtained.metric,
               c.message);
  }
  fmt::print(
      "{} numbers, {} compared: {} fine, {} open, {} deviate. Not compared: {} flagged, {} without "
      "a number on either side, {} hashes of another platform, {} without reference, {} missing. "
      "{} cells run, {} spared.\nObtained: {}\n",
      result.comparisons.size(), std::ranges::count_if(result.comparisons, gate::is_compared),
      count(result, Finding::fine), count(result, Finding::open), count(result, Finding::deviation),
      count(result, Finding::flagged), count(result, Finding::no_number),
      count(result, Finding::not_comparable), count(result, Finding::fresh),
      count(result, Finding::missing), result.cells.size(), result.cells_spared, folder);
}

gate::CheckResult check_with_progress(const Plan& plan, const std::vector<Cell>& cells,
                                      const Catalogues& catalogues, const gate::Suite& reference,
                                      const gate::CheckPlan& how, const Machine& machine) {
  Progress progress(cells.size());
  const auto label = [](const Cell& cell) {
    return fmt::format("{} {} seed {}", cell.experiment, cell.engine.label(), cell.seed);
  };
  RunCallbacks callbacks;
  callbacks.cell_begins = [&](const Cell& cell, std::size_t) { progress.begin(label(cell)); };
  callbacks.cell_ends = [&](const CellOutcome& done, std::size_t) {
    progress.end(
        fmt::format("{}: {}, {}", label(done.cell), done.outcome, duration_text(done.wall_s)));
  };
  return gate::check(plan, cells, catalogues, reference, how, machine, callbacks);
}

// All that the check was asked for but --engine and --only, which each line brings along; nothing
// that would be written again.
std::string command_of(const CheckOptions& options) {
  std::vector<std::string> words = {"brickbench", "check", options.suite};
  if (options.reference != CheckOptions().reference) {
    words.insert(words.end(), {"--reference", options.reference});
  }
  for (const std::string& setting : options.overrides.set) {
    words.insert(words.end(), {"--set", setting});
  }
  if (options.all_starts) words.emplace_back("--all-starts");
  return shell_command(words);
}

int check(CheckOptions options) {
  const Catalogues catalogues = all_catalogues();
  const bool path =
      options.suite.find('/') != std::string::npos || options.suite.ends_with(".toml");
  const auto file = find_plan(path ? options.suite : "gate_" + options.suite);
  if (!file) return complain(file.error().text(), k_exit_bad_input);
  const auto plan = read_plan(*file, catalogues, options.overrides);
  if (!plan) return complain(plan.error().text(), k_exit_bad_input);
  const auto cells = expand(*plan, catalogues);
  if (!cells) return complain(cells.error().text(), k_exit_bad_input);
  const std::string suite = plan->name.starts_with("gate_") ? plan->name.substr(5) : plan->name;
  const std::filesystem::path reference_folder = std::filesystem::path(options.reference) / suite;
  const auto reference = gate::read_suite(reference_folder);
  if (!reference) return complain(reference.error());

  for (const std::string& out : {options.obtained, options.junit}) {
    if (auto ok = check_is_new(out); !ok) return complain(ok.error());
  }
  gate::CheckPlan how;
  how.all_starts = options.all_starts;
  const Machine machine = this_machine();
  gate::CheckResult result =
      check_with_progress(*plan, *cells, catalogues, *reference, how, machine);
  result.command = command_of(options);

  const std::filesystem::path folder =
      options.obtained.empty() ? next_obtained(suite) : std::filesystem::path(options.obtained);
  if (auto ok = gate::write_suite(folder / suite, result.obtained); !ok)
    return complain(ok.error());
  if (!options.junit.empty()) {
    std::error_code ignored;
    std::filesystem::create_directories(std::filesystem::path(options.junit).parent_path(),
                                        ignored);
    if (auto ok = write_new_file(options.junit, gate::junit(suite, result)); !ok) {
      return complain(ok.error());
    }
  }
  if (std::getenv("GITHUB_ACTIONS") != nullptr) {
    fmt::print(stderr, "{}", gate::annotations(suite, reference_folder.string(), result, 10));
  }
  const int code = gate::exit_code(result);
  if (options.json) {
    auto records = Json::array();
    for (const auto& c : result.comparisons) records.push_back(comparison_json(result.command, c));
    fmt::print("{}\n",
               Json({{"suite", suite},
                     {"exit_code", code},
                     {"obtained", folder.string()},
                     {"cells_run", result.cells.size()},
                     {"cells_spared", result.cells_spared},
                     {"compared", std::ranges::count_if(result.comparisons, gate::is_compared)},
                     {"records", records}})
                   .dump(2));
  } else {
    print_text(result, options.worst, folder.string());
  }
  return code;
}

}  // namespace

void add_check_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb = app.add_subcommand(
      "check", "Run a suite and compare its behaviour with the references, read-only");
  auto options = std::make_shared<CheckOptions>();
  verb->add_option("suite", options->suite, "smoke, full, or the path of a plan; default smoke");
  verb->add_option("--engine", options->overrides.engines,
                   "Engine selector instead of the plan's; may be repeated")
      ->expected(1)
      ->take_all();
  verb->add_option("--only", options->overrides.only, "Only the experiment of this name");
  verb->add_option("--set", options->overrides.set, "key=value, as for run; may be repeated")
      ->expected(1)
      ->take_all();
  verb->add_option("--reference", options->reference,
                   "Folder of the references; default reference_data/baseline");
  verb->add_option("--obtained", options->obtained,
                   "New folder for the numbers; default obtained/<suite>-<number>");
  verb->add_option("--junit", options->junit, "Also write a JUnit file");
  verb->add_option("--worst", options->worst, "How many offenders to print; default 20");
  verb->add_flag("--all-starts", options->all_starts,
                 "Run every start, also where fewer decide: for new references");
  verb->add_flag("--json", options->json, "The result as JSON on standard output");
  verb->callback([options, &invocation] { invocation.exit_code = check(*options); });
}

}  // namespace brickbench
