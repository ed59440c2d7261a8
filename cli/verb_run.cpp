#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/complain.hpp"
#include "cli/planned_work.hpp"
#include "cli/record_command.hpp"
#include "cli/run_output.hpp"
#include "cli/terminal.hpp"
#include "cli/verbs.hpp"
#include "experiments/record/file.hpp"
#include "experiments/run/results.hpp"
#include "reports/src/markdown_report.hpp"

namespace brickbench {
namespace {

struct RunOptions {
  PlanChoice choice;
  std::string out;
  bool record = false;
  bool all = false;
  bool json = false;
};

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

// So many frames of each cell, whatever its length: as many as a page shows by default.
void record_all(std::vector<Cell>& cells) {
  constexpr std::uint64_t k_frames = 240;
  for (Cell& cell : cells) {
    if (cell.recording || !cell.excluded_why.empty()) continue;
    cell.recording = Recording{.every = std::max<std::uint64_t>(1, step_count(cell) / k_frames),
                               .precision = TrajectoryPrecision::f32};
  }
}

void print_text(const std::filesystem::path& folder, const PlannedWork& work,
                const RunResult& result, const RunOptions& options, const Invocation& invocation) {
  if (options.all) print_run_tables(result);
  const bool has_motion =
      std::ranges::any_of(work.cells, [](const Cell& cell) { return cell.recording.has_value(); });
  const RunTold told{folder.string(), has_motion ? "" : record_command(invocation.arguments),
                     smallest_edges(work, result)};
  for (const std::string& line : run_screen(result, told, standard_output_style())) {
    fmt::print("{}\n", line);
  }
}

int run(const RunOptions& options, const Invocation& invocation) {
  auto work = planned_work(options.choice, invocation.arguments);
  if (!work) return k_exit_bad_input;
  if (options.record) record_all(work->cells);
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
    print_text(*folder, *work, result, options, invocation);
  return count_unrecorded(result) > 0 ? k_exit_infrastructure : exit_code(result);
}

}  // namespace

void add_run_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb = app.add_subcommand("run", "Run a plan and write rows, timings and a report");
  auto options = std::make_shared<RunOptions>();
  add_plan_choice(*verb, options->choice);
  verb->add_option("--out", options->out,
                   "New folder for the results; default results/<plan>-<number>");
  verb->add_flag("--record", options->record,
                 "Record the motion of every cell, for the page and for render");
  verb->add_flag("--all", options->all, "Print every table, not one screen");
  verb->add_flag("--json", options->json, "The result as JSON on standard output");
  verb->callback([options, &invocation] { invocation.exit_code = run(*options, invocation); });
}

}  // namespace brickbench
