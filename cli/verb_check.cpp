#include <fmt/format.h>

#include <cstdlib>

#include "cli/check_output.hpp"
#include "cli/complain.hpp"
#include "cli/engine_files.hpp"
#include "cli/planned_work.hpp"
#include "cli/terminal.hpp"
#include "cli/verbs.hpp"
#include "experiments/record/file.hpp"
#include "experiments/regression/check.hpp"
#include "experiments/run/plan_files.hpp"

namespace brickbench {
namespace {

struct CheckOptions {
  std::string suite = "smoke";
  std::string reference = "reference_data/baseline";
  std::string obtained;
  std::string junit;
  Overrides overrides;
  std::vector<std::string> engine_files;
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
  for (const std::string& word : engine_file_words(options.engine_files)) words.push_back(word);
  if (options.all_starts) words.emplace_back("--all-starts");
  return shell_command(words);
}

int check(CheckOptions options) {
  const auto known = running_catalogues(options.engine_files);
  if (!known) return complain(known.error().text(), k_exit_bad_input);
  const Catalogues& catalogues = *known;
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
  const bool is_first = !std::filesystem::is_directory(reference_folder);
  if (is_first) {
    fmt::print(stderr, "brickbench: no references in {}: nothing to compare with yet\n",
               reference_folder.string());
  }

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
  const CheckTold told{suite, options.reference, is_first, folder.string(), options.worst};
  if (options.json) {
    fmt::print("{}\n", check_json(result, told, code).dump(2));
  } else {
    print_check(result, told);
  }
  return code;
}

}  // namespace

void add_check_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb = app.add_subcommand(
      "check", "Run a suite and compare its behaviour with the references, read-only");
  auto options = std::make_shared<CheckOptions>();
  verb->add_option("suite", options->suite, "smoke, full, or the path of a plan; default smoke");
  add_overrides(*verb, options->overrides);
  add_engine_files(*verb, options->engine_files);
  verb->add_option("--reference", options->reference,
                   "Folder of the references; default reference_data/baseline");
  verb->add_option("--obtained,--out", options->obtained,
                   "New folder for the numbers, also --out; default obtained/<suite>-<number>");
  verb->add_option("--junit", options->junit, "Also write a JUnit file");
  verb->add_option("--worst", options->worst, "How many offenders to print; default 20");
  verb->add_flag("--all-starts", options->all_starts,
                 "Run every start, also where fewer decide: for new references");
  verb->add_flag("--json", options->json, "The result as JSON on standard output");
  verb->callback([options, &invocation] { invocation.exit_code = check(*options); });
}

}  // namespace brickbench
