#include "cli/planned_work.hpp"

#include <fmt/core.h>

#include "cli/complain.hpp"
#include "cli/engine_files.hpp"
#include "cli/number_option.hpp"
#include "cli/verbs.hpp"
#include "experiments/record/file.hpp"
#include "experiments/run/plan_files.hpp"
#include "experiments/run/results.hpp"

namespace brickbench {

void add_overrides(CLI::App& verb, Overrides& overrides) {
  // One value per option: CLI11 must not split or swallow lists.
  verb.add_option("--set", overrides.set,
                  "key=value for every experiment, or experiment.key=value; may be repeated")
      ->expected(1)
      ->take_all();
  const auto add_setting = [&](const std::string& name, const std::string& key,
                               const std::string& meaning) {
    verb.add_option_function<std::string>(
            name,
            [&overrides, key](const std::string& text) {
              overrides.set.push_back(key + '=' + set_value(text));
            },
            meaning)
        ->type_name("NUMBER");
  };
  add_setting("--step", "step_s", "Time step, s, of every experiment: 0.004 or 1/240");
  add_setting("--duration", "duration_s", "Simulated time, s, of every experiment");
  verb.add_option("--engine", overrides.engines,
                  "Engine selector instead of the plan's; may be repeated")
      ->expected(1)
      ->take_all();
  verb.add_option("--only", overrides.only, "Only the experiment of this name");
}

void add_plan_choice(CLI::App& verb, PlanChoice& choice, const std::string& names) {
  verb.add_option(names, choice.plan, "Plan file, or the name of one of `list plans`")->required();
  add_overrides(verb, choice.overrides);
  add_engine_files(verb, choice.engine_files);
}

std::optional<PlannedWork> planned_work(const PlanChoice& choice,
                                        const std::vector<std::string>& arguments) {
  const auto bad = [](const InputError& error) {
    complain(error.text(), k_exit_bad_input);
    return std::nullopt;
  };
  PlannedWork work;
  auto catalogues = running_catalogues(choice.engine_files);
  if (!catalogues) return bad(catalogues.error());
  work.catalogues = std::move(*catalogues);
  const auto file = find_plan(choice.plan);
  if (!file) return bad(file.error());
  auto plan = read_plan(*file, work.catalogues, choice.overrides);
  if (!plan) return bad(plan.error());
  work.plan = std::move(*plan);
  auto cells = expand(work.plan, work.catalogues);
  if (!cells) return bad(cells.error());
  work.cells = std::move(*cells);
  work.provenance = provenance_of(work.plan, work.catalogues);
  work.provenance.command = shell_command(arguments);
  work.provenance.set = choice.overrides.set;
  work.provenance.engine_files = choice.engine_files;
  work.provenance.date_utc = now_utc();
  return work;
}

Expected<std::filesystem::path> new_results_folder(const std::string& out, PlannedWork& work) {
  const std::filesystem::path folder =
      out.empty() ? next_results_folder(work.plan.name) : std::filesystem::path(out);
  if (auto made = create_new_folder(folder); !made) return tl::unexpected(made.error());
  std::error_code error;
  if (!std::filesystem::is_regular_file(work.plan.file, error)) {
    work.provenance.plan = (folder / "plan.toml").string();
  }
  return folder;
}

RunCallbacks callbacks_for(Progress& progress, std::function<std::string(const Cell&)> label) {
  RunCallbacks callbacks;
  callbacks.cell_begins = [&progress, label](const Cell& cell, std::size_t) {
    progress.begin(label(cell));
  };
  callbacks.after_step = [&progress](double share) {
    progress.update(share);
    return true;
  };
  callbacks.cell_ends = [&progress, label](const CellOutcome& done, std::size_t) {
    progress.end(fmt::format("{}: {}{}{}, {}", label(done.cell), done.outcome,
                             done.reason.empty() ? "" : ": ", done.reason,
                             duration_text(done.wall_s)));
  };
  return callbacks;
}

}  // namespace brickbench
