#include "cli/hunt_output.hpp"

#include <fmt/format.h>

#include <map>

#include "adapters/seam/unit.hpp"
#include "experiments/run/cell.hpp"

namespace brickbench {
namespace {

std::string trial_sketch(const hunt::Trial& trial) {
  std::string text = trial.scene;
  for (const auto& [name, value] : trial.parameters) {
    text += fmt::format(", {} = {}", name, text_of(value));
  }
  for (const auto& [name, value] : trial.knobs) text += fmt::format(", knob {} = {}", name, value);
  return text;
}

}  // namespace

Table findings_table(const std::vector<hunt::Finding>& findings, std::size_t most) {
  Table table;
  table.header = {"finding", "observed", "allowed", "unit", "seen", "needs"};
  for (const hunt::Finding& finding : findings) {
    if (table.rows.size() == most) break;
    const hunt::Breach& breach = finding.breach();
    const char* known = finding.question.empty() ? "" : " known";
    table.rows.push_back({{finding.id},
                          {fmt::format("{:.3g}", breach.observed)},
                          {fmt::format("{:.3g}", breach.allowed)},
                          {breach.unit},
                          {fmt::format("{}{}", finding.seen, known)},
                          {finding.needed}});
  }
  return table;
}

std::string counts_text(const hunt::Record& record) {
  std::string text = fmt::format("{} trials:", record.judged());
  const char* comma = " ";
  for (const auto& [outcome, count] : record.outcomes()) {
    text += fmt::format("{}{} {}", comma, count, outcome);
    comma = ", ";
  }
  std::uint64_t told = 0;
  for (const auto& [kind, count] : record.told()) told += count;
  return text + fmt::format("; laws broken by runs that had said so: {}", told);
}

std::string findings_page(const hunt::Quarry& quarry, const hunt::Record& record,
                          const std::vector<hunt::Finding>& findings, const std::string& link) {
  std::string text = fmt::format("Seed {}, {}.\n\n", quarry.seed, counts_text(record));
  text += "| engine | law | observed | allowed | seen | smallest scene | plan |\n";
  text += "|---|---|---:|---:|---:|---|---|\n";
  for (const hunt::Finding& finding : findings) {
    const hunt::Breach& breach = finding.breach();
    const hunt::Trial& trial = finding.shrunk.trial;
    text += fmt::format(
        "| `{}` | {} | {:.3g}{} | {:.3g} | {} | {}; {} steps of {:.4g} s | [plan]({}/{}.toml) |\n",
        trial.engine.label(), finding.oracle + (finding.question.empty() ? "" : " (known)"),
        breach.observed, unit_suffix(breach.unit), breach.allowed, finding.seen,
        markdown_cell(trial_sketch(trial)), trial.steps, trial.step_s, link, finding.id);
  }
  return text;
}

}  // namespace brickbench
