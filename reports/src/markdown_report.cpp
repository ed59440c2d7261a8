#include "reports/src/markdown_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "adapters/seam/unit.hpp"
#include "reports/src/flags.hpp"
#include "reports/src/losses.hpp"
#include "reports/src/summary.hpp"

namespace brickbench {
namespace {

std::string head(const ReportInput& input) {
  const Provenance& p = *input.provenance;
  std::set<std::string> cells;
  std::set<std::string> whole;
  std::set<std::string> flagged;
  for (const Row& row : input.rows) {
    cells.insert(row.cell);
    if (!row.state_hash.empty()) whole.insert(row.cell);
    if (!row.validity.empty()) flagged.insert(row.cell);
  }
  std::string out = fmt::format("# {}\n\n", p.title);
  if (!p.analysis.empty()) out += p.analysis + "\n\n";
  if (!cells.empty()) {
    out += fmt::format("{} of {} cells ran to their end", whole.size(), cells.size());
    if (!flagged.empty()) {
      out += fmt::format(
          "; {} of them are flagged (!): their numbers are shown and not ranked, averaged or timed",
          flagged.size());
    }
    out += ".\n\n";
  }
  out += fmt::format("Made by\n\n```sh\n{}\n```\n\n", p.command);
  const Machine& m = p.machine;
  out += fmt::format(
      "on {} ({} cores, {}), {}, revision {}, {} build with {} {}.\n\n| engine | version | "
      "precision "
      "|\n|---|---|---|\n",
      m.cpu, m.cores, m.architecture, m.system, m.revision, m.build_type, m.compiler, m.flags);
  for (const EngineRecord& engine : p.engines) {
    out += fmt::format("| {}{} | {} | {} |\n", engine.name, engine.own ? " (ours)" : "",
                       markdown_cell(engine.version), engine.precision);
  }
  return out + '\n';
}

std::string own_losses(const ReportInput& input, const std::vector<Block>& blocks) {
  const std::vector<std::string> own = own_engines(*input.provenance);
  if (own.empty()) return "";
  const LossTable found = losses(blocks, own);
  std::string out = "## Where our own engine is not the best\n\n";
  out += fmt::format("{} of {} comparisons are lost", found.rows.size(), found.compared);
  if (found.rounding > 0) {
    out += fmt::format(", {} of them by rounding only (at most {} in SI units)", found.rounding,
                       k_rounding);
  }
  if (found.flagged > 0) {
    out += fmt::format("; {} more are not made, because one side's numbers are flagged",
                       found.flagged);
  }
  out += ".\n\n";
  if (found.rows.empty()) return out;
  Table table;
  table.header = {"number", "scene", "ours", "value", "best", "value", "ours / best"};
  for (const Loss& loss : found.rows) {
    table.rows.push_back({{loss.number},
                          {loss.scene},
                          {loss.ours},
                          {short_number(loss.ours_value)},
                          {loss.best},
                          {short_number(loss.best_value)},
                          {loss.rounding ? "rounding"
                           : loss.ratio  ? short_number(*loss.ratio)
                                         : "-"}});
  }
  return out + to_markdown(table) + '\n';
}

std::string unfinished(const ReportInput& input) {
  std::string out;
  std::set<std::string> seen;
  Table table;
  table.header = {"engine", "experiment", "step_s", "seed", "outcome", "reason", "repeat"};
  for (const Row& row : input.rows) {
    if (!row.state_hash.empty() || !seen.insert(row.cell).second) continue;
    table.rows.push_back(
        {{row.engine + '/' + row.variant},
         {row.experiment},
         {shortest(row.step_s)},
         {std::to_string(row.seed)},
         {row.outcome},
         {row.reason},
         {row.outcome == "excluded" ? "" : '`' + reproduce_command(row, *input.provenance) + '`'}});
  }
  if (table.rows.empty()) return "";
  return "## Cells without numbers\n\n" + to_markdown(table) + '\n';
}

std::string flagged_table(const ReportInput& input) {
  Table table;
  table.header = {"engine", "experiment", "step_s", "seed", "flags", "repeat"};
  for (const Row* row : flagged_cells(input.rows)) {
    table.rows.push_back({{row->engine + '/' + row->variant},
                          {row->experiment},
                          {shortest(row->step_s)},
                          {std::to_string(row->seed)},
                          {"! " + row->validity},
                          {'`' + reproduce_command(*row, *input.provenance) + '`'}});
  }
  if (table.rows.empty()) return "";
  return "## Cells whose numbers do not count\n\n" + to_markdown(table) + '\n';
}

std::string worst_lines(const Block& block) {
  std::string out;
  for (std::size_t n = 0; n < block.numbers.size(); ++n) {
    const Number& number = block.numbers[n];
    if (!number.worst) continue;
    const Score& score = block.scores[*number.worst][n];
    out += fmt::format("- worst {}: {} with {}{}{}{}\n", number.name,
                       block.contenders[*number.worst].label(), short_number(*score.mean),
                       unit_suffix(number.unit), score.note.empty() ? "" : ", ", score.note);
  }
  return out.empty() ? "" : out + '\n';
}

std::string inapplicable_lines(const Block& block) {
  std::string out;
  for (std::size_t n = 0; n < block.numbers.size(); ++n) {
    std::string who;
    std::string why;
    for (std::size_t c = 0; c < block.contenders.size(); ++c) {
      const Score& score = block.scores[c][n];
      const bool about_number = score.outcome.starts_with("not_");
      if (score.mean || !about_number) continue;
      who += (who.empty() ? "" : ", ") + block.contenders[c].label();
      why = score.reason;
    }
    if (!who.empty()) out += fmt::format("- {}: {} ({})\n", block.numbers[n].name, why, who);
  }
  return out.empty() ? "" : out + '\n';
}

std::string flagged_lines(const Block& block) {
  std::string out;
  for (const std::string& line : flag_lines({&block, 1})) out += "- " + line + '\n';
  return out.empty() ? "" : out + '\n';
}

std::string blocks_text(const std::vector<Block>& blocks) {
  std::string out;
  std::string scene;
  for (const Block& block : blocks) {
    if (scene_label(block) != scene) {
      scene = scene_label(block);
      out += fmt::format("## {}\n\n", scene);
    }
    out += fmt::format("### {}\n\n", block.group);
    const Table table = to_table(block);
    if (!table.rows.empty()) out += to_markdown(table) + '\n';
    out += flagged_lines(block) + worst_lines(block) + inapplicable_lines(block);
  }
  return out;
}

// Whether the time may be compared with that of others.
std::string comparable_text(const Timing& timing) {
  if (timing.outcome != "ok") return "no: " + timing.outcome;
  return timing.validity.empty() ? "yes" : "no: " + timing.validity;
}

std::string cost(const ReportInput& input) {
  Table table;
  table.header = {"engine", "experiment", "step_s", "axes",  "seed",
                  "steps",  "median ms",  "max ms", "CPU s", "comparable"};
  for (const Timing& timing : input.timings) {
    if (timing.steps == 0) continue;
    table.rows.push_back({{timing.engine + '/' + timing.variant},
                          {timing.experiment},
                          {shortest(timing.step_s)},
                          {timing.axes},
                          {std::to_string(timing.seed)},
                          {std::to_string(timing.steps)},
                          {short_number(1e3 * timing.step_median_cpu_s)},
                          {short_number(1e3 * timing.step_max_cpu_s)},
                          {short_number(timing.steps_total_cpu_s)},
                          {comparable_text(timing)}});
  }
  if (table.rows.empty()) return "";
  return "## Cost\n\nCPU time of the engine alone, per step. It differs from run to run.\n\n" +
         to_markdown(table) + '\n';
}

std::string glossary(const ReportInput& input) {
  std::set<std::string> used;
  for (const Row& row : input.rows) used.insert(row.metric);
  Table table;
  table.header = {"number", "unit", "better", "meaning", "a good value"};
  for (const MetricRecord& metric : input.provenance->metrics) {
    if (!used.contains(metric.name)) continue;
    table.rows.push_back(
        {{metric.name}, {metric.unit}, {metric.better}, {metric.meaning}, {metric.good}});
  }
  if (table.rows.empty()) return "";
  return "## What the numbers mean\n\n" + to_markdown(table);
}

}  // namespace

std::string reproduce_command(const Row& row, const Provenance& provenance) {
  std::vector<std::string> words = {"brickbench",
                                    "run",
                                    provenance.plan,
                                    "--only",
                                    row.experiment,
                                    "--engine",
                                    row.engine + '/' + row.variant};
  for (const std::string& file : provenance.engine_files) {
    words.insert(words.end(), {"--engine-file", file});
  }
  for (const std::string& setting : provenance.set) {
    words.insert(words.end(), {"--set", setting});
  }
  const auto set = [&](const std::string& setting) {
    words.insert(words.end(), {"--set", row.experiment + '.' + setting});
  };
  set("step_s=" + shortest(row.step_s));
  set("duration_s=" + shortest(row.duration_s));
  if (row.seed != 0) set(fmt::format("seeds=[{}]", row.seed));
  for (std::size_t at = 0; at < row.axes.size();) {
    const std::size_t end = std::min(row.axes.find(';', at), row.axes.size());
    set(row.axes.substr(at, end - at));
    at = end + 1;
  }
  return shell_command(words);
}

std::string markdown_report(const ReportInput& input) {
  const std::vector<Block> blocks = summarize(input.rows);
  return head(input) + own_losses(input, blocks) + unfinished(input) + flagged_table(input) +
         blocks_text(blocks) + cost(input) + glossary(input);
}

}  // namespace brickbench
