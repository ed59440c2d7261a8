#include "cli/run_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "experiments/hunt/extent.hpp"
#include "reports/src/engine_digest.hpp"
#include "reports/src/summary.hpp"

namespace brickbench {
namespace {

constexpr std::size_t k_engines_shown = 8;
constexpr std::size_t k_endings_shown = 4;

Table cost_table(const RunResult& result) {
  Table table;
  table.title = "cost (CPU of the engine alone)";
  table.header = {"engine", "experiment", "step_s", "median_ms", "max_ms", "total_s", "outcome"};
  for (const Timing& timing : result.timings) {
    if (timing.steps == 0) continue;
    table.rows.push_back({{timing.engine + '/' + timing.variant},
                          {timing.experiment},
                          {shortest(timing.step_s)},
                          {short_number(1e3 * timing.step_median_cpu_s)},
                          {short_number(1e3 * timing.step_max_cpu_s)},
                          {short_number(timing.steps_total_cpu_s)},
                          {timing.outcome + (timing.validity.empty() ? "" : " !")}});
  }
  return table;
}

void add_text(std::vector<std::string>& lines, const std::string& text) {
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
}

// A sentence over as many lines as it needs, two at most; what does not fit ends in "~".
void add_wrapped(std::vector<std::string>& lines, std::string sentence, std::size_t width) {
  for (int line = 0; line < 2 && !sentence.empty(); ++line) {
    const bool last = line == 1;
    std::size_t cut = sentence.size();
    if (cut > width) {
      const std::size_t blank = sentence.rfind(' ', width);
      cut = last || blank == std::string::npos || blank < 4 ? width - 1 : blank;
    }
    lines.push_back(sentence.substr(0, cut) + (last && cut < sentence.size() ? "~" : ""));
    sentence.erase(0, std::min(cut, sentence.size()));
    if (!sentence.empty())
      sentence = "  " + sentence.substr(std::min(sentence.find_first_not_of(' '), sentence.size()));
  }
}

std::string cells_line(const RunResult& result) {
  const auto count = [&](const auto& is) {
    return static_cast<std::size_t>(std::ranges::count_if(result.cells, is));
  };
  const std::size_t ran = count([](const CellOutcome& cell) { return cell.outcome == "ok"; });
  const std::size_t flagged = count([](const CellOutcome& cell) { return !cell.validity.empty(); });
  std::string line = fmt::format("{} of {} cells ran to their end", ran, result.cells.size());
  if (flagged > 0) line += fmt::format("; {} of them are flagged (!) and not ranked", flagged);
  return line + '.';
}

}  // namespace

std::string cell_label(const Cell& cell) {
  return fmt::format("{} {} step {} s{}{}", cell.experiment, cell.engine.label(), cell.step_s,
                     cell.seed == 0 ? "" : fmt::format(" seed {}", cell.seed),
                     cell.axes.empty() ? "" : " " + cell.axes);
}

std::vector<std::string> run_screen(const RunResult& result, const RunTold& told,
                                    const TerminalStyle& style) {
  const auto engines = engine_digests(result.rows, result.timings, told.smallest_edge_m);
  std::vector<std::string> lines = {cells_line(result)};
  // A table too wide for the terminal would be told twice over: it is cut instead.
  Table table = engine_table(engines, k_engines_shown);
  if (!table.rows.empty()) add_text(lines, to_terminal(table, style));
  if (engines.size() > k_engines_shown) {
    lines.push_back(
        fmt::format("... and {} slower or untimed engines", engines.size() - k_engines_shown));
  }
  for (const std::string& line : breach_lines(engines)) add_wrapped(lines, line, style.width);
  if (const std::string line = fastest_line(engines); !line.empty()) {
    add_wrapped(lines, line, style.width);
  }
  std::vector<std::string> last = {
      fmt::format("Results: {} (report.md has every table; --all prints them)", told.folder),
      fmt::format("Page: brickbench report {0} --out {0}/page", told.folder)};
  if (!told.record_command.empty()) last.push_back("With the motion: " + told.record_command);
  const std::size_t room = k_screen_lines - std::min(k_screen_lines, lines.size() + last.size());
  const std::size_t endings = std::min(k_endings_shown, room);
  if (endings > 0) {
    for (std::string line : ending_lines(result.rows, endings)) {
      if (line.size() > style.width) line = line.substr(0, style.width - 1) + '~';
      lines.push_back(std::move(line));
    }
  }
  lines.insert(lines.end(), last.begin(), last.end());
  return lines;
}

void print_run_tables(const RunResult& result) {
  const TerminalStyle style = standard_output_style();
  for (const Block& block : summarize(result.rows)) {
    Table table = to_table(block);
    if (table.rows.empty()) continue;
    table.title = fmt::format("{}: {}", block.group, scene_label(block));
    fmt::print("{}\n", to_terminal(table, style));
  }
  fmt::print("{}\n", to_terminal(cost_table(result), style));
  for (const CellOutcome& cell : result.cells) {
    if (!cell.validity.empty()) fmt::print("! {}: {}\n", cell_label(cell.cell), cell.validity);
    if (cell.outcome != "ok")
      fmt::print("{}: {}: {}\n", cell_label(cell.cell), cell.outcome, cell.reason);
  }
}

std::map<std::string, double> smallest_edges(const PlannedWork& work, const RunResult& result) {
  std::map<std::string, double> edges;
  std::map<std::pair<std::string, ParameterValues>, double> known;
  for (const CellOutcome& cell : result.cells) {
    const auto scenario =
        std::ranges::find(work.catalogues.scenarios, cell.cell.scenario, &Scenario::name);
    if (scenario == work.catalogues.scenarios.end() || cell.outcome == "refused") continue;
    const auto [place, is_new] =
        known.try_emplace({cell.cell.scenario, cell.cell.parameters}, HUGE_VAL);
    if (is_new) {
      const auto scene = scenario->make(cell.cell.parameters);
      if (scene) place->second = hunt::thinnest_m(scene->world);
    }
    if (std::isfinite(place->second)) edges.emplace(cell.id, place->second);
  }
  return edges;
}

}  // namespace brickbench
