// `sweep plan` and `sweep submit`: what comes before a sweep runs.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>

#include "cli/complain.hpp"
#include "cli/planned_work.hpp"
#include "cli/terminal.hpp"
#include "cli/verbs.hpp"
#include "experiments/sweep/estimate.hpp"
#include "experiments/sweep/inventory.hpp"
#include "experiments/sweep/slurm.hpp"
#include "experiments/sweep/sweep.hpp"

namespace brickbench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t k_cells_shown = 20;

struct PreviewChoice {
  PlanChoice plan;
  bool all_cells = false;
  bool json = false;
};

struct SubmitChoice {
  PlanChoice plan;
  std::string out;
  std::size_t shards = 1;
  SlurmJob job;
  double time_limit_s = 3600.0;
  std::uint64_t memory_limit_mb = 0;
  bool retry_failed = false;
  bool slurm = false;
  bool dry_run = false;
  bool json = false;
};

std::string size_text(double bytes) {
  if (bytes < 1e6) return fmt::format("{:.0f} kB", bytes / 1e3);
  return bytes < 1e9 ? fmt::format("{:.1f} MB", bytes / 1e6)
                     : fmt::format("{:.1f} GB", bytes / 1e9);
}

nlohmann::ordered_json cells_json(const std::vector<PlannedCell>& cells) {
  auto array = nlohmann::ordered_json::array();
  for (const PlannedCell& cell : cells) {
    array.push_back({{"id", cell.cell}, {"label", label(cell)}, {"excluded", cell.excluded}});
  }
  return array;
}

void print_preview(const Estimate& estimate, const std::vector<PlannedCell>& cells, bool all,
                   unsigned cores) {
  for (std::size_t i = 0; i < cells.size() && (all || i < k_cells_shown); ++i) {
    fmt::print("{} {}{}\n", cells[i].cell, label(cells[i]),
               cells[i].excluded.empty() ? "" : ", left out: " + cells[i].excluded);
  }
  if (!all && cells.size() > k_cells_shown) {
    fmt::print("... {} more; --cells prints all\n", cells.size() - k_cells_shown);
  }
  fmt::print("{} cells, {} of them left out by the plan.\n", cells.size(), estimate.excluded);
  fmt::print(
      "About {} of work, {} with {} workers here; {} of results{}. {} of {} kinds of cells "
      "were tried; right within a factor of about two.\n",
      duration_text(estimate.work_s), duration_text(estimate.work_s / cores), cores,
      size_text(estimate.size_bytes),
      estimate.motion_bytes > 0.0
          ? fmt::format(" and {} of motion, before compression", size_text(estimate.motion_bytes))
          : "",
      estimate.tried, estimate.kinds);
  for (const TrialFailure& failure : estimate.failures) {
    fmt::print("warning: {} cells like {} {} {}: {}: {}\n", failure.cells, failure.cell.experiment,
               failure.cell.engine.label(), failure.cell.axes, failure.outcome, failure.reason);
  }
}

int preview(const PreviewChoice& choice, const Invocation& invocation) {
  const auto work = planned_work(choice.plan, invocation.arguments);
  if (!work) return k_exit_bad_input;
  const Machine& machine = work->provenance.machine;
  const auto cells = planned_cells(work->cells, work->catalogues, machine.revision);
  const auto cost = estimate(work->cells, work->catalogues, {machine.revision, machine.label()});
  if (!cost) return complain(cost.error());
  if (!choice.json) {
    print_preview(*cost, cells, choice.all_cells, machine.cores);
    return k_exit_fine;
  }
  auto warnings = nlohmann::ordered_json::array();
  for (const TrialFailure& failure : cost->failures) {
    warnings.push_back({{"experiment", failure.cell.experiment},
                        {"engine", failure.cell.engine.label()},
                        {"axes", failure.cell.axes},
                        {"cells", failure.cells},
                        {"outcome", failure.outcome},
                        {"reason", failure.reason}});
  }
  const nlohmann::ordered_json json = {{"plan", work->plan.file.string()},
                                       {"cells", cells_json(cells)},
                                       {"excluded", cost->excluded},
                                       {"work_s", cost->work_s},
                                       {"size_bytes", cost->size_bytes},
                                       {"motion_bytes", cost->motion_bytes},
                                       {"kinds", cost->kinds},
                                       {"tried", cost->tried},
                                       {"warnings", warnings}};
  fmt::print("{}\n", json.dump(2));
  return k_exit_fine;
}

std::vector<std::string> run_command(const SubmitChoice& choice, const fs::path& program,
                                     const fs::path& plan) {
  std::vector<std::string> command = {program.string(), "sweep", "run",
                                      plan.string(),    "--out", choice.job.folder.string()};
  const auto add = [&](const std::string& option, const std::string& value) {
    command.push_back(option);
    command.push_back(value);
  };
  for (const std::string& set : choice.plan.overrides.set) add("--set", set);
  for (const std::string& engine : choice.plan.overrides.engines) add("--engine", engine);
  for (const std::string& file : choice.plan.engine_files) {
    add("--engine-file", fs::absolute(file).string());
  }
  if (!choice.plan.overrides.only.empty()) add("--only", choice.plan.overrides.only);
  add("--time-limit", fmt::format("{}", choice.time_limit_s));
  add("--memory-limit", fmt::format("{}", choice.memory_limit_mb));
  if (choice.retry_failed) command.emplace_back("--retry-failed");
  return command;
}

// The shards in which something is left to do; all of them if the sweep does not exist yet.
std::vector<std::size_t> open_shards(const SubmitChoice& choice, std::size_t cells) {
  const auto sweep = read_sweep(choice.job.folder);
  std::set<std::size_t> open;
  if (!sweep) {
    for (std::size_t i = 0; i < std::min(choice.shards, cells); ++i) open.insert(i);
  } else {
    const auto states = take_inventory(*sweep);
    for (std::size_t i = 0; i < states.size(); ++i) {
      const bool retry = choice.retry_failed && is_failure(sweep->cells[i], states[i].outcome);
      if (!states[i].is_done() || retry) open.insert(i % choice.shards);
    }
  }
  return {open.begin(), open.end()};
}

// Submits, unless nothing is open or the run is dry, and says as JSON what came of it.
int submit_for_machines(const SlurmJob& job, bool dry_run) {
  Submitted submitted;
  if (!dry_run && !job.open_shards.empty()) {
    const auto done = submit(job);
    if (!done) return complain(done.error());
    submitted = *done;
  }
  const nlohmann::ordered_json json = {
      {"folder", job.folder.string()},     {"shards", job.shards},
      {"open_shards", job.open_shards},    {"array_job", submitted.array_job},
      {"merge_job", submitted.merge_job},  {"array_script", array_script(job)},
      {"merge_script", merge_script(job)}, {"exit_code", k_exit_fine}};
  fmt::print("{}\n", json.dump(2));
  return k_exit_fine;
}

int submit_verb(SubmitChoice& choice, const Invocation& invocation) {
  if (!choice.slurm) return complain("submit needs --slurm", k_exit_bad_input);
  const auto work = planned_work(choice.plan, invocation.arguments);
  if (!work) return k_exit_bad_input;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  SlurmJob& job = choice.job;
  job.folder = fs::absolute(choice.out).lexically_normal();
  if (!job.folder.has_filename()) job.folder = job.folder.parent_path();
  job.shards = choice.shards;
  job.run = run_command(choice, program, fs::absolute(work->plan.file));
  job.merge = {program.string(),    "sweep", "merge",
               job.folder.string(), "--out", (job.folder / "rows.csv").string()};
  if (!choice.dry_run) {
    const auto sweep =
        open_sweep(job.folder, work->plan, choice.plan.overrides,
                   planned_cells(work->cells, work->catalogues, work->provenance.machine.revision),
                   work->provenance);
    if (!sweep) return complain(sweep.error());
  }
  job.open_shards = open_shards(choice, work->cells.size());
  if (choice.json) return submit_for_machines(job, choice.dry_run);
  if (job.open_shards.empty()) {
    fmt::print("Every cell has its result; nothing to submit. Merge with: {}\n",
               shell_command(job.merge));
    return k_exit_fine;
  }
  if (choice.dry_run) {
    fmt::print("# {}/slurm/array.sh\n{}\n# {}/slurm/merge.sh\n{}\n", job.folder.string(),
               array_script(job), job.folder.string(), merge_script(job));
    fmt::print("# sbatch array.sh; sbatch --dependency=afterany:<its job> merge.sh\n");
    return k_exit_fine;
  }
  const auto submitted = submit(job);
  if (!submitted) return complain(submitted.error());
  fmt::print(
      "Submitted {} shards as job {}, the merge as job {}.\n"
      "Watch:  squeue -r -j {},{}\n"
      "        {} sweep status {}\n"
      "Logs:   {}/slurm/shard-*.log\n"
      "Rows:   {}/rows.csv, once every cell has its result\n"
      "Resume: the same command; it submits the shards that have something left to do.\n",
      job.open_shards.size(), submitted->array_job, submitted->merge_job, submitted->array_job,
      submitted->merge_job, program.string(), job.folder.string(), job.folder.string(),
      job.folder.string());
  return k_exit_fine;
}

}  // namespace

void add_sweep_plan_verb(CLI::App& sweep, Invocation& invocation) {
  CLI::App* verb = sweep.add_subcommand(
      "plan", "Cells, time, size and likely failures of a plan, without running it");
  auto choice = std::make_shared<PreviewChoice>();
  add_plan_choice(*verb, choice->plan);
  verb->add_flag("--cells", choice->all_cells, "Print every cell");
  verb->add_flag("--json", choice->json, "The same as JSON on standard output");
  verb->callback([choice, &invocation] { invocation.exit_code = preview(*choice, invocation); });
}

void add_sweep_submit_verb(CLI::App& sweep, Invocation& invocation) {
  CLI::App* verb = sweep.add_subcommand("submit", "Hand a sweep to a cluster, or go on with it");
  auto choice = std::make_shared<SubmitChoice>();
  add_plan_choice(*verb, choice->plan);
  verb->add_flag("--slurm", choice->slurm, "As a Slurm job array");
  verb->add_option("--out", choice->out, "Folder of the sweep, seen by all nodes")->required();
  verb->add_option("--shards", choice->shards, "Tasks of the array, 4 to 10 per slot")
      ->required()
      ->check(CLI::Range(std::size_t{1}, std::size_t{1000000}));
  verb->add_option("--partition", choice->job.partition, "Partition; default the cluster's");
  verb->add_option("--cpus", choice->job.cpus_per_task, "Cells at the same time in each task")
      ->check(CLI::Range(1U, 1024U));
  verb->add_option("--sbatch", choice->job.options, "More options, as in --sbatch=--mem=4G")
      ->expected(1)
      ->take_all();
  verb->add_option("--time-limit", choice->time_limit_s, "As of `sweep run`")
      ->check(CLI::NonNegativeNumber);
  verb->add_option("--memory-limit", choice->memory_limit_mb, "As of `sweep run`")
      ->check(CLI::NonNegativeNumber);
  verb->add_flag("--retry-failed", choice->retry_failed, "As of `sweep run`");
  verb->add_flag("--dry-run", choice->dry_run, "Print the scripts; write and submit nothing");
  verb->add_flag("--json", choice->json, "Jobs and scripts as JSON on standard output");
  verb->callback(
      [choice, &invocation] { invocation.exit_code = submit_verb(*choice, invocation); });
}

}  // namespace brickbench
