#include "experiments/hunt/findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "experiments/exact/validation/validate.hpp"
#include "experiments/hunt/cause.hpp"
#include "experiments/hunt/codec.hpp"
#include "experiments/hunt/plan_text.hpp"
#include "experiments/record/file.hpp"

namespace brickbench::hunt {
namespace {

void number_the_names(std::vector<Finding>& list) {
  std::map<std::string, int> taken;
  for (Finding& finding : list) {
    const int count = ++taken[finding.id];
    if (count > 1) finding.id += fmt::format("-{}", count);
  }
}

// Open questions are about engines as they are, with no knob turned.
std::string question_that_knows(const Trial& trial,
                                const std::vector<exact::OpenQuestion>& questions) {
  if (trial.source != Source::exact_case || !trial.knobs.empty()) return "";
  const auto cases = exact::select_cases(exact::exact_cases(), trial.scene);
  if (cases.empty()) return "";
  const auto values = exact::complete(cases.front(), trial.parameters);
  if (!values) return "";
  exact::CellResult cell;
  cell.engine = trial.engine.engine;
  cell.variant = trial.engine.variant;
  cell.case_id = cases.front().id;
  const auto* question = exact::question_of(questions, cell, cases.front(), *values);
  return question == nullptr ? "" : question->question;
}

}  // namespace

std::vector<Finding> findings(const Record& record, const Catalogues& catalogues,
                              const std::vector<exact::OpenQuestion>& questions) {
  std::map<std::string, Finding> by_cause;
  for (const auto& [place, shrunk] : record.shrunk()) {
    const Find& find = record.finds()[place];
    if (shrunk.verdict.find(find.oracle) == nullptr) continue;
    Finding& finding = by_cause[cause_key(find.oracle, shrunk.trial)];
    const bool first = finding.finds++ == 0;
    if (!first && burden(finding.shrunk.trial, catalogues) <= burden(shrunk.trial, catalogues)) {
      continue;
    }
    finding.id = fmt::format("{}-{}-{}-{}", find.oracle, shrunk.trial.engine.engine,
                             shrunk.trial.engine.variant, shrunk.trial.scene);
    finding.oracle = find.oracle;
    finding.needed = needed(shrunk.trial);
    finding.shrunk = shrunk;
    finding.trial = find.number;
    finding.seen = record.seen().at(kind_key(find.oracle, shrunk.trial));
    finding.question = question_that_knows(shrunk.trial, questions);
  }
  std::vector<Finding> list;
  for (auto& [key, finding] : by_cause) list.push_back(std::move(finding));
  std::ranges::sort(list, {}, [](const Finding& f) {
    return std::tuple(f.shrunk.trial.engine.engine, f.shrunk.trial.engine.variant, f.oracle,
                      f.shrunk.trial.scene, f.needed);
  });
  number_the_names(list);
  return list;
}

std::size_t new_findings(const std::vector<Finding>& findings) {
  return static_cast<std::size_t>(
      std::ranges::count_if(findings, [](const Finding& f) { return f.question.empty(); }));
}

Expected<void> write_plans(const std::filesystem::path& folder, const std::vector<Finding>& list,
                           const std::string& origin) {
  std::error_code error;
  for (const Finding& finding : list) {
    const std::filesystem::path file = folder / (finding.id + ".toml");
    std::filesystem::remove(file, error);
    const std::string text =
        plan_text(finding.shrunk.trial, finding.shrunk.verdict, finding.oracle, file.string(),
                  fmt::format("{} Trial {}.", origin, finding.trial));
    if (auto ok = write_new_file(file, text); !ok) return ok;
  }
  return {};
}

std::string summary_json(const Quarry& quarry, const Record& record,
                         const std::vector<Finding>& list) {
  auto items = Json::array();
  for (const Finding& finding : list) {
    items.push_back({{"id", finding.id},
                     {"oracle", finding.oracle},
                     {"engine", finding.shrunk.trial.engine.label()},
                     {"needed", finding.needed},
                     {"breach", to_json(finding.breach())},
                     {"trial", to_json(finding.shrunk.trial)},
                     {"found_in_trial", finding.trial},
                     {"seen", finding.seen},
                     {"question", finding.question}});
  }
  const Json json = {{"seed", quarry.seed},
                     {"trials", record.judged()},
                     {"outcomes", record.outcomes()},
                     {"findings", items},
                     {"seen", record.seen()},
                     {"told", record.told()},
                     {"exit_code", new_findings(list) == 0 ? 0 : 1}};
  return json.dump(2);
}

}  // namespace brickbench::hunt
