#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/complain.hpp"
#include "cli/planned_work.hpp"
#include "cli/terminal.hpp"
#include "cli/verbs.hpp"
#include "experiments/record/file.hpp"
#include "experiments/run/bench.hpp"
#include "experiments/run/results.hpp"
#include "reports/src/summary.hpp"
#include "reports/src/table.hpp"

namespace brickbench {
namespace {

struct BenchOptions {
  PlanChoice choice;
  std::string out;
  std::size_t repeat = 0;  // 0: as the plan says
  bool json = false;
};

// The accuracy that stands beside every time, if the plan's metrics yield it.
constexpr std::array k_accuracy = {"penetration_max_m", "penetration_final_m",
                                   "brick_displacement_max_m", "brick_speed_rms_mps",
                                   "bricks_displaced"};

// The scene without what belongs to an engine.
std::string scene_label(const Cell& cell) {
  std::string text = cell.experiment;
  std::istringstream parts(cell.axes);
  for (std::string part; std::getline(parts, part, ';');) {
    if (!part.starts_with("knob.")) text += ' ' + part;
  }
  return fmt::format("{}, {} s", text, shortest(cell.duration_s));
}

BenchResult bench_with_progress(const PlannedWork& work, const BenchChoice& choice) {
  Progress progress(work.cells.size() * choice.repeat);
  const auto label = [](const Cell& cell) {
    return fmt::format("{} {}", cell.engine.label(), scene_label(cell));
  };
  const Machine& machine = work.provenance.machine;
  return bench_cells(work.cells, choice.base, choice.repeat, work.catalogues,
                     {machine.revision, machine.label()}, callbacks_for(progress, label));
}

const Row* find_row(const BenchEntry& entry, std::string_view metric) {
  const auto found = std::ranges::find(entry.rows, metric, &Row::metric);
  return found == entry.rows.end() ? nullptr : &*found;
}

nlohmann::ordered_json to_json(const std::optional<Spread>& spread) {
  if (!spread) return nullptr;
  return {{"median", spread->median}, {"least", spread->least}, {"most", spread->most}};
}

nlohmann::ordered_json to_json(const BenchEntry& entry) {
  nlohmann::ordered_json accuracy = nlohmann::ordered_json::object();
  for (const Row& row : entry.rows) {
    accuracy[row.metric] = row.value ? nlohmann::ordered_json(*row.value) : nullptr;
  }
  nlohmann::ordered_json knobs = nlohmann::ordered_json::object();
  for (const auto& [name, value] : entry.cell.knobs) knobs[name] = value;
  return {{"cell", entry.id},
          {"group", entry.group},
          {"experiment", entry.cell.experiment},
          {"engine", entry.cell.engine.label()},
          {"knobs", knobs},
          {"axes", entry.cell.axes},
          {"step_s", entry.cell.step_s},
          {"duration_s", entry.cell.duration_s},
          {"is_base", entry.is_base},
          {"outcome", entry.outcome},
          {"reason", entry.reason},
          {"validity", entry.validity},
          {"rounds", entry.rounds},
          {"repeatable", entry.repeatable},
          {"cpu_per_simulated_s", to_json(entry.cost)},
          {"step_cpu_s", to_json(entry.step_cpu_s)},
          {"ratio_to_base", to_json(entry.ratio)},
          {"accuracy", accuracy}};
}

nlohmann::ordered_json to_json(const BenchResult& result, const Provenance& provenance) {
  auto entries = nlohmann::ordered_json::array();
  for (const BenchEntry& entry : result.entries) entries.push_back(to_json(entry));
  return {{"provenance", to_json(provenance)},
          {"base", result.base.text},
          {"rounds", result.rounds},
          {"entries", entries}};
}

std::string spread_text(const std::optional<Spread>& spread, double scale) {
  if (!spread) return "-";
  return fmt::format("{} ({}..{})", short_number(scale * spread->median),
                     short_number(scale * spread->least), short_number(scale * spread->most));
}

std::vector<TableCell> table_row(const BenchEntry& entry) {
  std::string engine = entry.cell.engine.label();
  for (const auto& [name, value] : entry.cell.knobs) {
    engine += fmt::format(" {}={}", name, shortest(value));
  }
  if (entry.is_base) engine += " (base)";
  std::vector<TableCell> cells = {
      {engine},
      {shortest(entry.cell.step_s)},
      {spread_text(entry.step_cpu_s, 1e3)},
      {spread_text(entry.cost, 1e3)},
      {entry.validity.empty() ? spread_text(entry.ratio, 1.0) : std::string("not comparable")}};
  for (const char* metric : k_accuracy) {
    const Row* row = find_row(entry, metric);
    cells.push_back({row == nullptr || !row->value ? "-" : short_number(*row->value)});
  }
  std::string outcome = entry.outcome;
  if (outcome == "ok" && !entry.repeatable) outcome += ", not repeatable";
  if (!entry.validity.empty()) outcome += "; " + entry.validity;
  cells.push_back({outcome, entry.validity.empty() ? Mark::plain : Mark::flagged});
  return cells;
}

std::vector<Table> tables_of(const BenchResult& result) {
  std::vector<Table> tables;
  for (const BenchEntry& entry : result.entries) {
    if (entry.group == tables.size()) {
      Table& table = tables.emplace_back();
      table.title = scene_label(entry.cell);
      table.header = {"engine", "step_s", "ms per step", "CPU ms per simulated s",
                      fmt::format("over {}", result.base.text)};
      table.header.insert(table.header.end(), k_accuracy.begin(), k_accuracy.end());
      table.header.emplace_back("outcome");
    }
    tables[entry.group].rows.push_back(table_row(entry));
  }
  return tables;
}

std::string markdown(const BenchResult& result, const Provenance& provenance) {
  std::string text = fmt::format(
      "# {}\n\n{} rounds; median (least..most) over the rounds; base {}; {}, revision {}.\n",
      provenance.title, result.rounds, result.base.text, provenance.machine.label(),
      provenance.machine.revision);
  for (const Table& table : tables_of(result)) text += '\n' + to_markdown(table);
  return text;
}

int run(const BenchOptions& options, const Invocation& invocation) {
  auto work = planned_work(options.choice, invocation.arguments);
  if (!work) return k_exit_bad_input;
  const auto& [catalogues, plan, cells, provenance] = *work;
  if (!plan.bench) {
    return complain(
        fmt::format("{}: a plan to be timed needs a table [bench] with 'base'", plan.file.string()),
        k_exit_bad_input);
  }
  BenchChoice choice = *plan.bench;
  if (options.repeat != 0) choice.repeat = options.repeat;
  const auto folder = new_results_folder(options.out, *work);
  if (!folder) return complain(folder.error());
  const BenchResult result = bench_with_progress(*work, choice);

  if (auto ok = write_results(*folder, plan, result.runs, provenance); !ok) {
    return complain(ok.error());
  }
  const nlohmann::ordered_json json = to_json(result, provenance);
  if (auto ok = write_new_file(*folder / "bench.json", json.dump(2) + '\n'); !ok) {
    return complain(ok.error());
  }
  if (auto ok = write_new_file(*folder / "bench.md", markdown(result, provenance)); !ok) {
    return complain(ok.error());
  }
  if (options.json) {
    fmt::print("{}\n", json.dump(2));
  } else {
    for (const Table& table : tables_of(result)) {
      fmt::print("{}\n", to_terminal(table, standard_output_style()));
    }
    fmt::print("Results: {}\n", folder->string());
  }
  return exit_code(result.runs);
}

}  // namespace

void add_bench_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb =
      app.add_subcommand("bench", "Time the engines of a plan side by side, with their accuracy");
  auto options = std::make_shared<BenchOptions>();
  add_plan_choice(*verb, options->choice, "--plan,plan");
  verb->add_option("--out", options->out,
                   "New folder for the results; default results/<plan>-<number>");
  verb->add_option("--repeat", options->repeat, "Rounds instead of the plan's")
      ->check(CLI::Range(1, 1000));
  verb->add_flag("--json", options->json, "The result as JSON on standard output");
  verb->callback([options, &invocation] { invocation.exit_code = run(*options, invocation); });
}

}  // namespace brickbench
