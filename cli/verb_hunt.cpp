#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <memory>
#include <thread>

#include "adapters/seam/unit.hpp"
#include "cli/complain.hpp"
#include "cli/engine_files.hpp"
#include "cli/hunt_output.hpp"
#include "cli/known_questions.hpp"
#include "cli/terminal.hpp"
#include "cli/verbs.hpp"
#include "experiments/exact/validation/validate.hpp"
#include "experiments/hunt/hunt.hpp"
#include "experiments/hunt/isolated_judge.hpp"
#include "experiments/hunt/plan_text.hpp"
#include "experiments/record/file.hpp"
#include "experiments/record/provenance.hpp"
#include "experiments/run/results.hpp"

namespace brickbench {
namespace {

constexpr std::size_t k_findings_shown = 30;  // findings on a screen

struct HuntChoice {
  std::vector<std::string> engines = {"*/*"};
  std::vector<std::string> engine_files;
  std::vector<std::string> scenes = {"all"};
  std::string budget = "60s";
  std::uint64_t seed = 1;
  std::uint64_t trials = 0;  // 0: as many as the budget allows
  std::string out;
  bool resume = false;
  std::size_t workers = 0;
  std::string replay;
  bool json = false;
};

// "90", "90s", "10min", "1h"; nullopt for anything else.
std::optional<double> seconds_of(const std::string& text) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  if (error != std::errc() || !(number > 0.0)) return std::nullopt;
  if (unit.empty() || unit == "s") return number;
  if (unit == "min") return 60.0 * number;
  if (unit == "h") return 3600.0 * number;
  return std::nullopt;
}

// Throws InputError.
hunt::Quarry quarry_of(const HuntChoice& choice, const Catalogues& catalogues) {
  hunt::Quarry quarry;
  quarry.seed = choice.seed;
  for (const std::string& text : choice.engines) {
    const auto selector = parse_selector(text, {.file = "--engine"}, catalogues, true);
    if (!selector) reject(selector.error().at, selector.error().reason);
    for (const EngineVariant& engine : select(*selector, catalogues)) {
      if (std::ranges::find(quarry.engines, engine) == quarry.engines.end()) {
        quarry.engines.push_back(engine);
      }
    }
  }
  const std::vector<std::string> known = names_of(catalogues.scenarios);
  const auto cases = exact::exact_cases();
  for (const std::string& text : choice.scenes) {
    const auto chosen = exact::select_cases(cases, text);
    for (const exact::ExactCase& exact_case : chosen) quarry.cases.push_back(exact_case.id);
    if (chosen.empty() && std::ranges::find(known, text) == known.end()) {
      reject({.file = "--scene"},
             fmt::format("no scenario '{}'{}", text, known_names(text, known)));
    }
  }
  for (const std::string& name : known) {
    const bool wanted = std::ranges::any_of(
        choice.scenes, [&](const std::string& text) { return text == "all" || text == name; });
    if (wanted) quarry.scenes.push_back(name);
  }
  return quarry;
}

hunt::Tick ticker(bool is_quiet) {
  const auto told = std::make_shared<std::chrono::steady_clock::time_point>();
  return [told, is_quiet](const hunt::Record& record, std::size_t running) {
    constexpr std::chrono::seconds period{5};
    const auto now = std::chrono::steady_clock::now();
    if (is_quiet || now - *told < period) return true;
    *told = now;
    fmt::print(stderr, "{} trials, {} finds, {} of them shrunk, {} processes\n", record.judged(),
               record.finds().size(), record.shrunk().size(), running);
    return true;
  };
}

void print_text(const std::filesystem::path& folder, const hunt::Record& record,
                const std::vector<hunt::Finding>& findings) {
  fmt::print("{}\n", counts_text(record));
  if (findings.empty()) {
    fmt::print("Nothing was found.\n");
    return;
  }
  fmt::print("{}\n",
             to_terminal(findings_table(findings, k_findings_shown), standard_output_style()));
  if (findings.size() > k_findings_shown)
    fmt::print("and {} more\n", findings.size() - k_findings_shown);
  const std::size_t known = findings.size() - hunt::new_findings(findings);
  fmt::print("{} findings{}; each has a plan in {}, for example:\n  brickbench hunt --replay {}\n",
             findings.size(), known == 0 ? "" : fmt::format(", {} of them known", known),
             folder.string(), (folder / (findings.front().id + ".toml")).string());
}

int hunt_anew(const HuntChoice& choice, const Catalogues& catalogues, double budget_s) {
  const hunt::Quarry quarry = quarry_of(choice, catalogues);
  if (quarry.engines.empty()) return complain("--engine matches nothing", k_exit_bad_input);
  if (choice.resume && choice.out.empty()) {
    return complain("--resume needs --out: the folder to go on with", k_exit_bad_input);
  }
  const std::filesystem::path folder =
      choice.out.empty() ? next_results_folder("hunt") : std::filesystem::path(choice.out);
  hunt::Record record;
  const auto progress = choice.resume ? hunt::ProgressFile::resume(folder, quarry, record)
                                      : hunt::ProgressFile::create(folder, quarry);
  if (!progress) return complain(progress.error());
  hunt::HuntOptions options;
  options.budget_s = budget_s;
  if (choice.trials > 0) options.most_trials = choice.trials;
  options.workers =
      choice.workers > 0 ? choice.workers : std::max(1U, std::thread::hardware_concurrency());
  if (auto ok = hunt::run_hunt(quarry, catalogues, options, *progress, record, ticker(choice.json));
      !ok) {
    return complain(ok.error());
  }
  const auto questions = known_questions();
  if (!questions) return complain(questions.error());
  const auto findings = hunt::findings(record, catalogues, *questions);
  const std::string origin = fmt::format("Found by brickbench hunt --seed {}.", quarry.seed);
  if (auto ok = hunt::write_plans(folder, findings, origin); !ok) return complain(ok.error());
  const std::string json = hunt::summary_json(quarry, record, findings);
  std::error_code error;
  std::filesystem::remove(folder / "findings.json", error);
  std::filesystem::remove(folder / "findings.md", error);
  if (auto ok = write_new_file(folder / "findings.json", json + "\n"); !ok) {
    return complain(ok.error());
  }
  const std::string page = findings_page(quarry, record, findings, ".");
  if (auto ok = write_new_file(folder / "findings.md", page); !ok) return complain(ok.error());
  if (choice.json) {
    fmt::print("{}\n", json);
  } else {
    print_text(folder, record, findings);
  }
  return hunt::new_findings(findings) == 0 ? k_exit_fine : k_exit_failed_case;
}

Checked<std::vector<hunt::Trial>> trials_in(const std::string& text, const std::string& file,
                                            const Catalogues& catalogues) {
  const auto of_case = hunt::case_trial(text, file, catalogues);
  if (!of_case) return tl::unexpected(of_case.error());
  if (*of_case) return std::vector<hunt::Trial>{**of_case};
  const auto plan = parse_plan(text, file, catalogues);
  if (!plan) return tl::unexpected(plan.error());
  return hunt::trials_of(*plan, catalogues);
}

int replay(const HuntChoice& choice, const Catalogues& catalogues) {
  const auto text = read_file(choice.replay);
  if (!text) return complain(text.error().reason, k_exit_bad_input);
  const auto trials = trials_in(*text, choice.replay, catalogues);
  if (!trials) return complain(trials.error().text(), k_exit_bad_input);
  bool broken = false;
  for (const hunt::Trial& trial : *trials) {
    const hunt::Verdict verdict = hunt::judge_isolated(trial, catalogues);
    fmt::print("{}\n  outcome {}{}{}\n", hunt::label(trial), verdict.outcome,
               verdict.reason.empty() ? "" : ": ", verdict.reason);
    for (const hunt::Breach& breach : verdict.breaches) {
      fmt::print("  {}: observed {:.6g}{}, allowed {:.6g}, after step {} ({:.6g} s) {}\n",
                 breach.oracle, breach.observed, unit_suffix(breach.unit), breach.allowed,
                 breach.step, breach.time_s, breach.bodies);
    }
    broken = broken || !verdict.breaches.empty();
  }
  if (!broken) fmt::print("No law is broken.\n");
  return broken ? k_exit_failed_case : k_exit_fine;
}

int run_hunt_verb(const HuntChoice& choice) {
  const auto catalogues = running_catalogues(choice.engine_files);
  if (!catalogues) return complain(catalogues.error().text(), k_exit_bad_input);
  const auto budget_s = seconds_of(choice.budget);
  if (!budget_s) {
    return complain(fmt::format("--budget {}: write 90s, 10min or 1h", choice.budget),
                    k_exit_bad_input);
  }
  try {
    return choice.replay.empty() ? hunt_anew(choice, *catalogues, *budget_s)
                                 : replay(choice, *catalogues);
  } catch (const InputError& error) {
    return complain(error.text(), k_exit_bad_input);
  }
}

}  // namespace

void add_hunt_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb = app.add_subcommand(
      "hunt", "Draw random scenes, judge every engine by laws alone, shrink what breaks one");
  auto choice = std::make_shared<HuntChoice>();
  verb->add_option("--engine", choice->engines, "Engines and variants")->capture_default_str();
  add_engine_files(*verb, choice->engine_files);
  verb->add_option("--scene", choice->scenes,
                   "Scenarios and exact cases, family.* too; all: every one")
      ->capture_default_str();
  verb->add_option("--budget", choice->budget, "When to stop drawing: 90s, 10min, 1h")
      ->capture_default_str();
  verb->add_option("--seed", choice->seed, "Of the draws")->capture_default_str();
  verb->add_option("--trials", choice->trials, "Stop after so many trials; 0: at the budget's end");
  verb->add_option("--out", choice->out, "New folder; default results/hunt-<number>");
  verb->add_flag("--resume", choice->resume, "Go on with the hunt in --out");
  verb->add_option("--workers", choice->workers, "Processes at a time; 0: one per core");
  verb->add_option("--replay", choice->replay, "Judge the cells of this plan instead");
  verb->add_flag("--json", choice->json, "The result as JSON on standard output");
  verb->callback([choice, &invocation] { invocation.exit_code = run_hunt_verb(*choice); });
}

}  // namespace brickbench
