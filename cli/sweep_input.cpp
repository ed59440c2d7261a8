#include "cli/sweep_input.hpp"

#include <fmt/core.h>

#include "cli/build_facts.hpp"
#include "cli/verbs.hpp"
#include "experiments/run/plan_files.hpp"
#include "experiments/run/run_plan.hpp"

namespace brickbench {

void add_plan_choice(CLI::App& verb, PlanChoice& choice) {
  verb.add_option("plan", choice.plan, "Plan file, or the name of one of `list plans`")->required();
  verb.add_option("--set", choice.overrides.set,
                  "key=value for every experiment, or experiment.key=value; may be repeated")
      ->expected(1)
      ->take_all();
  verb.add_option("--engine", choice.overrides.engines,
                  "Engine selector instead of the plan's; may be repeated")
      ->expected(1)
      ->take_all();
  verb.add_option("--only", choice.overrides.only, "Only the experiment of this name");
}

std::optional<PlannedWork> planned_work(const PlanChoice& choice,
                                        const std::vector<std::string>& arguments) {
  const auto bad = [](const InputError& error) {
    complain(error.text(), k_exit_bad_input);
    return std::nullopt;
  };
  PlannedWork work;
  work.catalogues = all_catalogues();
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
  work.provenance.date_utc = now_utc();
  return work;
}

int complain(const std::string& message, int code) {
  fmt::print(stderr, "brickbench: {}\n", message);
  return code;
}

int complain(const Failure& failure) {
  return complain(failure.reason,
                  failure.fault == Fault::invalid ? k_exit_bad_input : k_exit_infrastructure);
}

}  // namespace brickbench
