#include <fmt/format.h>

#include <set>

#include "cli/build_facts.hpp"
#include "cli/terminal.hpp"
#include "cli/verbs.hpp"
#include "experiments/record/file.hpp"
#include "experiments/run/plan_files.hpp"
#include "experiments/run/results.hpp"
#include "reports/src/markdown_report.hpp"
#include "reports/src/summary.hpp"

namespace brickbench {
namespace {

struct RunOptions {
  std::string plan;
  std::string out;
  Overrides overrides;
  bool json = false;
};

int complain(const std::string& message, int code) {
  fmt::print(stderr, "brickbench: {}\n", message);
  return code;
}

int complain(const Failure& failure) {
  return complain(failure.reason,
                  failure.fault == Fault::invalid ? k_exit_bad_input : k_exit_infrastructure);
}

std::string cell_label(const Cell& cell) {
  return fmt::format("{} {} step {} s{}{}", cell.experiment, cell.engine.label(), cell.step_s,
                     cell.seed == 0 ? "" : fmt::format(" seed {}", cell.seed),
                     cell.axes.empty() ? "" : " " + cell.axes);
}

RunResult run_with_progress(const std::vector<Cell>& cells, const Catalogues& catalogues,
                            const Machine& machine, const std::filesystem::path& folder) {
  Progress progress(cells.size());
  RunCallbacks callbacks;
  callbacks.cell_begins = [&](const Cell& cell, std::size_t) { progress.begin(cell_label(cell)); };
  callbacks.after_step = [&](double share) {
    progress.update(share);
    return true;
  };
  callbacks.cell_ends = [&](const CellOutcome& done, std::size_t) {
    progress.end(fmt::format("{}: {}{}{}, {}", cell_label(done.cell), done.outcome,
                             done.reason.empty() ? "" : ": ", done.reason,
                             duration_text(done.wall_s)));
  };
  return run_cells(cells, catalogues, {machine.revision, machine.label()}, callbacks, folder);
}

// How many trajectories that were asked for are missing; the reasons go to stderr.
std::size_t count_unrecorded(const RunResult& result) {
  std::size_t count = 0;
  for (const CellOutcome& cell : result.cells) {
    if (cell.unrecorded.empty()) continue;
    ++count;
    fmt::print(stderr, "brickbench: {}: not recorded: {}\n", cell_label(cell.cell),
               cell.unrecorded);
  }
  return count;
}

template <typename Record>
nlohmann::ordered_json records_json(const std::vector<Record>& records) {
  auto array = nlohmann::ordered_json::array();
  const auto columns = Schema<Record>::columns();
  for (const Record& record : records) {
    nlohmann::ordered_json object;
    for (const auto& column : columns) {
      const std::string text = column.text(record);
      const std::string key(column.name);
      if (!column.is_number)
        object[key] = text;
      else
        object[key] = nlohmann::ordered_json::parse(text, nullptr, false);
      if (object[key].is_discarded()) object[key] = nullptr;  // empty or infinite
    }
    array.push_back(std::move(object));
  }
  return array;
}

void print_json(const std::filesystem::path& folder, const Plan& plan, const RunResult& result) {
  auto cells = nlohmann::ordered_json::array();
  for (const CellOutcome& cell : result.cells) {
    cells.push_back({{"id", cell.id},
                     {"experiment", cell.cell.experiment},
                     {"engine", cell.cell.engine.label()},
                     {"step_s", cell.cell.step_s},
                     {"seed", cell.cell.seed},
                     {"axes", cell.cell.axes},
                     {"outcome", cell.outcome},
                     {"reason", cell.reason},
                     {"failed", is_failure(cell)}});
  }
  const nlohmann::ordered_json json = {
      {"plan", plan.file.string()},        {"folder", folder.string()},
      {"exit_code", exit_code(result)},    {"cells", cells},
      {"rows", records_json(result.rows)}, {"timings", records_json(result.timings)}};
  fmt::print("{}\n", json.dump(2));
}

Table cost_table(const RunResult& result) {
  Table table;
  table.title = "cost (CPU of the engine alone)";
  table.header = {"engine", "experiment", "step_s", "median_ms", "max_ms", "total_s", "outcome"};
  for (const Timing& timing : result.timings) {
    if (timing.steps == 0) continue;
    table.rows.push_back({{timing.engine + '/' + timing.variant},
                          {timing.experiment},
                          {shortest(timing.step_s)},
                          {short_number(1e3 * timing.step_median_cpu_s)},
                          {short_number(1e3 * timing.step_max_cpu_s)},
                          {short_number(timing.steps_total_cpu_s)},
                          {timing.outcome}});
  }
  return table;
}

void print_tables(const std::filesystem::path& folder, const RunResult& result) {
  const TerminalStyle style = standard_output_style();
  for (const Block& block : summarize(result.rows)) {
    Table table = to_table(block);
    if (table.rows.empty()) continue;
    table.title = fmt::format("{}: {}", block.group, scene_label(block));
    fmt::print("{}\n", to_terminal(table, style));
  }
  fmt::print("{}\n", to_terminal(cost_table(result), style));
  std::size_t ran = 0;
  for (const CellOutcome& cell : result.cells) {
    if (cell.outcome == "ok")
      ++ran;
    else
      fmt::print("{}: {}: {}\n", cell_label(cell.cell), cell.outcome, cell.reason);
  }
  fmt::print("{} of {} cells ran to their end.\nResults: {}\n", ran, result.cells.size(),
             folder.string());
}

int run(const RunOptions& options, const Invocation& invocation) {
  const Catalogues catalogues = all_catalogues();
  const auto file = find_plan(options.plan);
  if (!file) return complain(file.error().text(), k_exit_bad_input);
  const auto plan = read_plan(*file, catalogues, options.overrides);
  if (!plan) return complain(plan.error().text(), k_exit_bad_input);
  const auto cells = expand(*plan, catalogues);
  if (!cells) return complain(cells.error().text(), k_exit_bad_input);
  if (auto ok = check_recordable(*cells); !ok) return complain(ok.error());

  const std::filesystem::path folder =
      options.out.empty() ? next_results_folder(plan->name) : std::filesystem::path(options.out);
  if (auto made = create_new_folder(folder); !made) return complain(made.error());

  Provenance provenance = provenance_of(*plan, catalogues);
  provenance.command = shell_command(invocation.arguments);
  provenance.date_utc = now_utc();
  const RunResult result = run_with_progress(*cells, catalogues, provenance.machine, folder);

  if (auto ok = write_results(folder, *plan, result, provenance); !ok) return complain(ok.error());
  const std::string report = markdown_report({result.rows, result.timings, &provenance});
  if (auto ok = write_new_file(folder / "report.md", report); !ok) return complain(ok.error());
  if (options.json)
    print_json(folder, *plan, result);
  else
    print_tables(folder, result);
  return count_unrecorded(result) > 0 ? k_exit_infrastructure : exit_code(result);
}

}  // namespace

void add_run_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb = app.add_subcommand("run", "Run a plan and write rows, timings and a report");
  auto options = std::make_shared<RunOptions>();
  verb->add_option("plan", options->plan, "Plan file, or the name of one of `list plans`")
      ->required();
  verb->add_option("--out", options->out,
                   "New folder for the results; default results/<plan>-<number>");
  // One value per option: CLI11 must not split or swallow lists.
  verb->add_option("--set", options->overrides.set,
                   "key=value for every experiment, or experiment.key=value; may be repeated")
      ->expected(1)
      ->take_all();
  verb->add_option("--engine", options->overrides.engines,
                   "Engine selector instead of the plan's; may be repeated")
      ->expected(1)
      ->take_all();
  verb->add_option("--only", options->overrides.only, "Only the experiment of this name");
  verb->add_flag("--json", options->json, "The result as JSON on standard output");
  verb->callback([options, &invocation] { invocation.exit_code = run(*options, invocation); });
}

}  // namespace brickbench
