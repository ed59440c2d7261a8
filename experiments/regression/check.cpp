#include "experiments/regression/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "experiments/record/markup.hpp"
#include "experiments/record/provenance.hpp"
#include "experiments/regression/observe.hpp"

namespace brickbench::gate {
namespace {

using SeedCounts = std::vector<std::pair<std::string, std::size_t>>;

SeedCounts seed_counts(const Plan& plan) {
  SeedCounts counts;
  for (const Experiment& experiment : plan.experiments) {
    counts.emplace_back(experiment.name, experiment.seeds.size());
  }
  return counts;
}

// What one ensemble is: an experiment in one engine at one step and one set of axes.
std::string group_of(const Cell& cell) {
  return cell.experiment + '|' + cell.engine.label() + "|step_s=" + shortest(cell.step_s) +
         (cell.axes.empty() ? "" : ';' + cell.axes) + '|';
}

constexpr double k_suspicious = 0.05;

// The references of the experiments and engines that the cells belong to: others are not asked.
Suite asked_of(const Suite& reference, const std::vector<Cell>& cells) {
  std::set<std::pair<std::string, std::string>> asked;
  for (const Cell& cell : cells) asked.emplace(cell.experiment, cell.engine.label());
  Suite suite;
  for (const Suite::Experiment& experiment : reference.experiments) {
    Suite::Experiment kept{experiment.name, {}};
    for (const Record& record : experiment.records) {
      if (asked.contains({experiment.name, record.engine})) kept.records.push_back(record);
    }
    suite.experiments.push_back(std::move(kept));
  }
  return suite;
}

void append(RunResult& all, RunResult part) {
  std::ranges::move(part.cells, std::back_inserter(all.cells));
  std::ranges::move(part.rows, std::back_inserter(all.rows));
}

std::string title(const Comparison& c) {
  return fmt::format("{} {} {} {}", c.experiment, c.obtained.engine, c.obtained.axes,
                     c.obtained.metric.empty() ? "state hash" : c.obtained.metric);
}

}  // namespace

std::set<std::string> undecided(const std::vector<Comparison>& comparisons) {
  std::set<std::string> groups;
  for (const Comparison& c : comparisons) {
    // "Same within the margin" beside a small p: small samples cannot show a difference yet.
    const bool suspicious = c.finding == Finding::fine && c.p_value < k_suspicious;
    // What is to become a reference wants every start.
    const bool wants_all = c.finding == Finding::fresh && c.obtained.kind == Kind::distribution;
    if (c.finding != Finding::open && !suspicious && !wants_all) continue;
    groups.insert(c.experiment + '|' + c.obtained.engine + '|' + c.obtained.axes + '|');
  }
  return groups;
}

CheckResult check(const Plan& plan, const std::vector<Cell>& cells, const Catalogues& catalogues,
                  const Suite& reference, const CheckPlan& how, const Machine& machine,
                  const RunCallbacks& callbacks) {
  const SeedCounts counts = seed_counts(plan);
  const Suite asked = asked_of(reference, cells);
  std::vector<std::size_t> looks = how.all_starts ? std::vector<std::size_t>{} : how.compare.looks;
  looks.push_back(static_cast<std::size_t>(-1));

  CheckResult result;
  RunResult all;
  std::map<std::string, std::size_t> taken;  // starts per group
  std::set<std::string> open;                // groups to go on with; all at first
  for (std::size_t look = 0; look < looks.size(); ++look) {
    std::map<std::string, std::size_t> seen;
    std::vector<Cell> batch;
    for (const Cell& cell : cells) {
      const std::string group = group_of(cell);
      const std::size_t number = seen[group]++;
      if (number < taken[group] || number >= looks[look]) continue;
      if (look == 0 || open.contains(group)) batch.push_back(cell);
    }
    for (const Cell& cell : batch) ++taken[group_of(cell)];
    append(all, run_cells(batch, catalogues, {machine.revision, machine.label()}, callbacks));
    result.obtained = counted_once(observe(all.rows, counts, machine));
    result.comparisons = compare(asked, result.obtained, how.compare, true);
    open = undecided(result.comparisons);
    if (open.empty()) break;
  }
  result.cells = std::move(all.cells);
  result.cells_spared = cells.size() - result.cells.size();
  return result;
}

int exit_code(const CheckResult& result) {
  int code = std::ranges::any_of(result.comparisons, is_compared) ? 0 : 3;
  for (const Comparison& c : result.comparisons) {
    if (c.finding == Finding::deviation) return 1;
    if (c.finding == Finding::missing || c.finding == Finding::fresh) code = 3;
  }
  return code;
}

std::string reproduce(const std::string& command, const Comparison& comparison) {
  std::vector<std::string> words = {"--engine", comparison.obtained.engine, "--only",
                                    comparison.experiment};
  const std::string& axes = comparison.obtained.axes;
  for (std::size_t at = 0; at < axes.size();) {
    const std::size_t end = std::min(axes.find(';', at), axes.size());
    const std::string axis = axes.substr(at, end - at);
    if (axis.starts_with("knob.")) {
      words.insert(words.end(), {"--set", comparison.experiment + '.' + axis});
    }
    at = end + 1;
  }
  return command + ' ' + shell_command(words);
}

std::string junit(const std::string& suite, const CheckResult& result) {
  std::size_t failures = 0;
  std::string cases;
  for (const Comparison& c : result.comparisons) {
    cases += fmt::format("  <testcase classname=\"{}.{}\" name=\"{}\">", escape_markup(suite),
                         escape_markup(c.experiment), escape_markup(title(c)));
    if (is_red(c)) {
      ++failures;
      cases += fmt::format("<failure type=\"{}\" message=\"{}\">{}</failure>", to_word(c.finding),
                           escape_markup(c.message), escape_markup(reproduce(result.command, c)));
    } else if (!is_compared(c)) {
      cases += fmt::format("<skipped message=\"{}\"/>", escape_markup(c.message));
    }
    cases += "</testcase>\n";
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<testsuite name=\"brickbench.{}\" tests=\"{}\" failures=\"{}\">\n{}</testsuite>\n",
      escape_markup(suite), result.comparisons.size(), failures, cases);
}

std::string annotations(const std::string& suite, const std::string& reference_folder,
                        const CheckResult& result, std::size_t most) {
  // Percent, carriage return and line feed end a message early (GitHub, Workflow commands).
  const auto plain = [](std::string text) {
    std::string out;
    for (const char c : text) {
      if (c == '%') {
        out += "%25";
      } else if (c == '\n') {
        out += "%0A";
      } else if (c == '\r') {
        out += "%0D";
      } else {
        out += c;
      }
    }
    return out;
  };
  std::string text;
  for (const Comparison& c : result.comparisons) {
    if (!is_red(c) || most-- == 0) break;
    text += fmt::format("::error file={}/{}.json,title=brickbench {}::{}: {}\n", reference_folder,
                        c.experiment, plain(suite), plain(title(c)), plain(c.message));
  }
  return text;
}

BlessResult bless(const Suite& reference, const Suite& obtained, const Blessing& blessing,
                  const ComparePlan& plan) {
  BlessResult result{counted_once(reference), {}};
  for (const Comparison& c : compare(reference, obtained, plan, false)) {
    const bool reflagged =
        c.finding == Finding::flagged && c.reference.validity != c.obtained.validity;
    if (!is_red(c) && !reflagged && c.finding != Finding::fresh &&
        c.finding != Finding::not_comparable) {
      continue;
    }
    auto experiment =
        std::ranges::find(result.suite.experiments, c.experiment, &Suite::Experiment::name);
    if (experiment == result.suite.experiments.end()) {
      result.suite.experiments.push_back({c.experiment, {}});
      experiment = std::prev(result.suite.experiments.end());
    }
    Record fresh = c.obtained;
    fresh.blessed = blessing;
    auto& records = experiment->records;
    const auto at = std::ranges::lower_bound(records, fresh.key(), {}, &Record::key);
    if (at != records.end() && at->key() == fresh.key()) {
      *at = std::move(fresh);
    } else {
      records.insert(at, std::move(fresh));
    }
    result.changed.push_back(c);
  }
  return result;
}

}  // namespace brickbench::gate
