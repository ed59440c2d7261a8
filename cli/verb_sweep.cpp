#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

#include "cli/complain.hpp"
#include "cli/number_option.hpp"
#include "cli/planned_work.hpp"
#include "cli/sweep_progress.hpp"
#include "cli/terminal.hpp"
#include "cli/verbs.hpp"
#include "experiments/run/trajectory_choice.hpp"
#include "experiments/sweep/database.hpp"
#include "experiments/sweep/inventory.hpp"
#include "experiments/sweep/merge.hpp"
#include "experiments/sweep/run_sweep.hpp"

namespace brickbench {
namespace {

constexpr std::size_t k_shown = 20;  // cells in a list for people

struct RunChoice {
  PlanChoice plan;
  std::string out;
  std::string shard = "0/1";
  SweepOptions options;
  bool json = false;
};

struct FolderChoice {
  std::string folder;
  std::string out;
  std::string database;
  bool json = false;
};

int code_of(bool incomplete, std::size_t failed) {
  if (incomplete) return k_exit_incomplete;
  return failed > 0 ? k_exit_failed_case : k_exit_fine;
}

SweepCallbacks callbacks_for(SweepProgress& progress) {
  auto done = std::make_shared<std::size_t>(0);
  auto failed = std::make_shared<std::size_t>(0);
  SweepCallbacks callbacks;
  callbacks.begins = [&progress, done](std::size_t cells, std::size_t found) {
    *done = found;
    progress.begin(cells, found);
  };
  callbacks.damaged = [&progress](const std::string& what) {
    progress.say("damaged, run again: " + what);
  };
  callbacks.cell_ends = [&progress, done, failed](const CellOutcome& cell, bool) {
    ++*done;
    if (!is_failure(cell)) return;
    ++*failed;
    progress.say(fmt::format("{} {}/{} step {} s {}: {}: {}", cell.cell.experiment,
                             cell.cell.engine.engine, cell.cell.engine.variant, cell.cell.step_s,
                             cell.cell.axes, cell.outcome, cell.reason));
  };
  callbacks.tick = [&progress, done, failed](std::size_t running) {
    progress.update(*done, *failed, running);
  };
  return callbacks;
}

int run(RunChoice& choice, const Invocation& invocation) {
  const auto shard = parse_shard(choice.shard);
  if (!shard) return complain(shard.error());
  choice.options.shard = *shard;
  const auto work = planned_work(choice.plan, invocation.arguments);
  if (!work) return k_exit_bad_input;
  const Machine& machine = work->provenance.machine;
  if (auto ok = check_recordable(work->cells); !ok) return complain(ok.error());
  if (choice.options.jobs == 0) choice.options.jobs = machine.cores;
  const auto sweep =
      open_sweep(choice.out, work->plan, choice.plan.overrides,
                 planned_cells(work->cells, work->catalogues, machine.revision), work->provenance);
  if (!sweep) return complain(sweep.error());
  SweepProgress progress;
  const auto summary =
      run_sweep(*sweep, work->cells, work->catalogues, {machine.revision, machine.label()},
                choice.options, callbacks_for(progress));
  if (!summary) return complain(summary.error());
  progress.end();
  const int code = code_of(summary->missing() > 0, summary->failed);
  if (choice.json) {
    const nlohmann::ordered_json json = {{"folder", choice.out},
                                         {"shard", shard->text()},
                                         {"cells", summary->cells},
                                         {"found", summary->found},
                                         {"damaged", summary->damaged},
                                         {"ran", summary->ran},
                                         {"shared", summary->shared},
                                         {"failed", summary->failed},
                                         {"missing", summary->missing()},
                                         {"stopped", summary->stopped},
                                         {"exit_code", code}};
    fmt::print("{}\n", json.dump(2));
    return code;
  }
  fmt::print("{} of {} cells of shard {} have a result: {} from before, {} now{}; {} failed.\n",
             summary->cells - summary->missing(), summary->cells, shard->text(), summary->found,
             summary->ran,
             summary->shared == 0 ? "" : fmt::format(", {} by another sweep", summary->shared),
             summary->failed);
  if (summary->missing() > 0) {
    fmt::print("{}; the same command goes on from here.\n",
               summary->stopped ? "Stopped" : "Incomplete");
  } else {
    fmt::print("Merge with: brickbench sweep merge {} --out FILE.csv\n", choice.out);
  }
  return code;
}

int status(const FolderChoice& choice) {
  const auto sweep = read_sweep(choice.folder);
  if (!sweep) return complain(sweep.error());
  const auto states = take_inventory(*sweep);
  std::map<std::string, std::size_t> outcomes;
  std::vector<std::size_t> missing;
  std::vector<std::size_t> failed;
  std::size_t damaged = 0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!states[i].damage.empty()) ++damaged;
    if (!states[i].is_done()) {
      missing.push_back(i);
      continue;
    }
    ++outcomes[states[i].outcome];
    if (is_failure(sweep->cells[i], states[i].outcome)) failed.push_back(i);
  }
  const int code = code_of(!missing.empty(), failed.size());
  if (choice.json) {
    const auto ids = [&](const std::vector<std::size_t>& cells) {
      auto array = nlohmann::ordered_json::array();
      for (const std::size_t cell : cells) {
        array.push_back({{"id", sweep->cells[cell].cell},
                         {"label", label(sweep->cells[cell])},
                         {"outcome", states[cell].outcome},
                         {"damage", states[cell].damage}});
      }
      return array;
    };
    const nlohmann::ordered_json json = {{"folder", choice.folder}, {"cells", states.size()},
                                         {"outcomes", outcomes},    {"damaged", damaged},
                                         {"missing", ids(missing)}, {"failed", ids(failed)},
                                         {"exit_code", code}};
    fmt::print("{}\n", json.dump(2));
    return code;
  }
  fmt::print("{} of {} cells have a result", states.size() - missing.size(), states.size());
  for (const auto& [outcome, count] : outcomes) fmt::print(", {} {}", count, outcome);
  fmt::print("\n");
  if (damaged > 0) fmt::print("{} result files are damaged; `sweep run` replaces them\n", damaged);
  const auto list = [&](const char* what, const std::vector<std::size_t>& cells) {
    for (std::size_t i = 0; i < cells.size() && i < k_shown; ++i) {
      const auto& cell = sweep->cells[cells[i]];
      const auto log = log_path(sweep->folder, cell.cell);
      fmt::print("{} {} {}{}\n", what, cell.cell, label(cell),
                 std::filesystem::exists(log) ? ", output in " + log.string() : "");
    }
    if (cells.size() > k_shown) fmt::print("{} more {}\n", cells.size() - k_shown, what);
  };
  list("failed", failed);
  list("missing", missing);
  return code;
}

Expected<MergeSummary> merge_as_asked(const Sweep& sweep, const FolderChoice& choice) {
  Expected<MergeSummary> summary;
  if (!choice.out.empty()) {
    const std::filesystem::path out = choice.out;
    auto timings = out;
    timings.replace_extension(".timings.csv");
    summary =
        out.extension() == ".csv" ? merge(sweep, {out, timings}) : merge_to_folder(sweep, out);
  }
  if (choice.database.empty() || !summary || !summary->missing.empty()) return summary;
  auto stored = merge_to_database(sweep, choice.database);
  if (!stored || choice.out.empty()) return stored;
  return summary;
}

int merge_verb(const FolderChoice& choice) {
  if (choice.out.empty() && choice.database.empty()) {
    return complain({Fault::invalid, "name where to merge to: --out, --sqlite, or both"});
  }
  const auto sweep = read_sweep(choice.folder);
  if (!sweep) return complain(sweep.error());
  const auto summary = merge_as_asked(*sweep, choice);
  if (!summary) return complain(summary.error());
  const bool complete = summary->missing.empty();
  const int code = code_of(!complete, summary->failed);
  if (choice.json) {
    auto missing = nlohmann::ordered_json::array();
    for (const std::size_t cell : summary->missing) missing.push_back(sweep->cells[cell].cell);
    const nlohmann::ordered_json json = {{"out", choice.out},
                                         {"sqlite", choice.database},
                                         {"cells", summary->cells},
                                         {"missing", missing},
                                         {"damage", summary->damage},
                                         {"failed", summary->failed},
                                         {"rows_bytes", summary->bytes},
                                         {"trajectories", summary->recorded},
                                         {"exit_code", code}};
    fmt::print("{}\n", json.dump(2));
    return code;
  }
  for (const std::string& damage : summary->damage) fmt::print(stderr, "damaged: {}\n", damage);
  if (!complete) {
    fmt::print(stderr, "brickbench: incomplete: {} of {} cells have no result:\n",
               summary->missing.size(), summary->cells);
    for (const std::size_t cell : summary->missing) {
      fmt::print(stderr, "{} {}\n", sweep->cells[cell].cell, label(sweep->cells[cell]));
    }
    return code;
  }
  const char* both = !choice.out.empty() && !choice.database.empty() ? " and " : "";
  fmt::print("{} cells merged to {}{}{}; {} failed.\n", summary->cells, choice.out, both,
             choice.database, summary->failed);
  return code;
}

void add_run(CLI::App& sweep, Invocation& invocation) {
  CLI::App* verb = sweep.add_subcommand("run", "Run what is missing of a plan's cells");
  auto choice = std::make_shared<RunChoice>();
  add_plan_choice(*verb, choice->plan);
  verb->add_option("--out", choice->out, "Folder of the sweep, new or to be gone on with")
      ->required();
  verb->add_option("--jobs", choice->options.jobs, "Cells at the same time; 0: one per core");
  verb->add_option("--shard", choice->shard, "Only shard i of n, i/n with i from 0");
  verb->add_flag("--retry-failed", choice->options.retry_failed,
                 "Run again what diverged, crashed, timed out, ran out of memory or was invalid");
  add_number(*verb, "--time-limit", choice->options.limits.wall_s,
             fmt::format("Wall-clock limit of a cell in s; 0: none; default {}",
                         choice->options.limits.wall_s),
             Sign::not_negative);
  verb->add_option("--memory-limit", choice->options.limits.memory_mb,
                   "Memory of a cell beyond that of the program, in MB; 0: no limit")
      ->check(CLI::NonNegativeNumber);
  verb->add_flag("--json", choice->json, "The summary as JSON on standard output");
  choice->options.jobs = 0;
  verb->callback([choice, &invocation] { invocation.exit_code = run(*choice, invocation); });
}

// A verb on the folder of a sweep; returns it for further options.
CLI::App* add_folder_verb(CLI::App& sweep, Invocation& invocation, const char* name,
                          const char* what, std::shared_ptr<FolderChoice> choice,
                          int (*act)(const FolderChoice&)) {
  CLI::App* verb = sweep.add_subcommand(name, what);
  verb->add_option("folder", choice->folder, "Folder of the sweep")->required();
  verb->add_flag("--json", choice->json, "The result as JSON on standard output");
  verb->callback([choice, act, &invocation] { invocation.exit_code = act(*choice); });
  return verb;
}

void add_merge(CLI::App& sweep, Invocation& invocation) {
  auto choice = std::make_shared<FolderChoice>();
  CLI::App* verb =
      add_folder_verb(sweep, invocation, "merge", "Join the results of all cells, in plan order",
                      choice, merge_verb);
  verb->add_option("--out", choice->out,
                   "New FILE.csv for the rows, with FILE.timings.csv beside it; or a new results "
                   "folder for reports");
  verb->add_option("--sqlite", choice->database,
                   "New SQLite database with the tables `rows` and `cells`");
}

}  // namespace

void add_sweep_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* sweep = app.add_subcommand(
      "sweep", "Run many cells, each in a process of its own, on one machine or many");
  sweep->require_subcommand(1);
  add_sweep_plan_verb(*sweep, invocation);
  add_run(*sweep, invocation);
  add_folder_verb(*sweep, invocation, "status", "What a sweep has and lacks",
                  std::make_shared<FolderChoice>(), status);
  add_merge(*sweep, invocation);
  add_sweep_submit_verb(*sweep, invocation);
}

}  // namespace brickbench
