#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/complain.hpp"
#include "cli/planned_work.hpp"
#include "cli/terminal.hpp"
#include "cli/verbs.hpp"
#include "experiments/record/file.hpp"
#include "experiments/run/results.hpp"
#include "reports/src/markdown_report.hpp"
#include "reports/src/summary.hpp"

namespace brickbench {
namespace {

struct RunOptions {
  PlanChoice choice;
  std::string out;
  bool json = false;
};

std::string cell_label(const Cell& cell) {
  return fmt::format("{} {} step {} s{}{}", cell.experiment, cell.engine.label(), cell.step_s,
                     cell.seed == 0 ? "" : fmt::format(" seed {}", cell.seed),
                     cell.axes.empty() ? "" : " " + cell.axes);
}

RunResult run_with_progress(const PlannedWork& work, const std::filesystem::path& folder) {
  Progress progress(work.cells.size());
  const Machine& machine = work.provenance.machine;
  return run_cells(work.cells, work.catalogues, {machine.revision, machine.label()},
                   callbacks_for(progress, cell_label), folder);
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
                     {"validity", cell.validity},
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
                          {timing.outcome + (timing.validity.empty() ? "" : " !")}});
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
  std::size_t flagged = 0;
  for (const CellOutcome& cell : result.cells) {
    if (!cell.validity.empty()) {
      ++flagged;
      fmt::print("! {}: {}\n", cell_label(cell.cell), cell.validity);
    }
    if (cell.outcome == "ok")
      ++ran;
    else
      fmt::print("{}: {}: {}\n", cell_label(cell.cell), cell.outcome, cell.reason);
  }
  fmt::print("{} of {} cells ran to their end", ran, result.cells.size());
  if (flagged > 0) fmt::print("; {} of them are flagged (!) and not ranked", flagged);
  fmt::print(".\nResults: {}\n", folder.string());
}

int run(const RunOptions& options, const Invocation& invocation) {
  auto work = planned_work(options.choice, invocation.arguments);
  if (!work) return k_exit_bad_input;
  if (auto ok = check_recordable(work->cells); !ok) return complain(ok.error());
  const auto folder = new_results_folder(options.out, *work);
  if (!folder) return complain(folder.error());
  const RunResult result = run_with_progress(*work, *folder);

  if (auto ok = write_results(*folder, work->plan, result, work->provenance); !ok) {
    return complain(ok.error());
  }
  const std::string report = markdown_report({result.rows, result.timings, &work->provenance});
  if (auto ok = write_new_file(*folder / "report.md", report); !ok) return complain(ok.error());
  if (options.json)
    print_json(*folder, work->plan, result);
  else
    print_tables(*folder, result);
  return count_unrecorded(result) > 0 ? k_exit_infrastructure : exit_code(result);
}

}  // namespace

void add_run_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb = app.add_subcommand("run", "Run a plan and write rows, timings and a report");
  auto options = std::make_shared<RunOptions>();
  add_plan_choice(*verb, options->choice);
  verb->add_option("--out", options->out,
                   "New folder for the results; default results/<plan>-<number>");
  verb->add_flag("--json", options->json, "The result as JSON on standard output");
  verb->callback([options, &invocation] { invocation.exit_code = run(*options, invocation); });
}

}  // namespace brickbench
