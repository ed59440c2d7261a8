#include "reports/src/page_answer.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "experiments/statistics/bootstrap.hpp"
#include "reports/src/engine_digest.hpp"
#include "reports/src/html_sections.hpp"
#include "reports/src/markup.hpp"
#include "reports/src/replay_source.hpp"

namespace brickbench {
namespace {

constexpr std::size_t k_engines_in_answer = 12;
// Numbers that say how a scene ended; a scene without them does not fall by chance.
constexpr std::string_view k_displaced = "bricks_displaced";

// Smallest edge or diameter of what moves, of every cell of a scene that was recorded.
std::map<std::string, double> recorded_edges(const ReportSource& source) {
  std::map<std::string, double> of_scene;
  for (const Replay& replay : source.replays) {
    double smallest_m = HUGE_VAL;
    for (const ReplayBody& body : replay.bodies) {
      if (body.role == ReplayRole::fixed || body.shape == ReplayShape::plane) continue;
      smallest_m = std::min(smallest_m, 2.0 * std::ranges::min(body.half_extents_m));
    }
    if (std::isfinite(smallest_m)) of_scene[replay.scene] = smallest_m;
  }
  std::map<std::string, double> edges;
  for (const Row& row : source.rows) {
    const auto scene = of_scene.find(scene_of(row));
    if (scene != of_scene.end()) edges.emplace(row.cell, scene->second);
  }
  return edges;
}

// The words of a command that shell_command() wrote; a quoted word keeps its blanks.
std::vector<std::string> command_words(const std::string& command) {
  std::vector<std::string> words(1);
  bool is_quoted = false;
  for (const char c : command) {
    if (c == '\'') {
      is_quoted = !is_quoted;
    } else if (c == ' ' && !is_quoted) {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  return words;
}

std::string list_item(const std::string& line) { return "<li>" + escape_markup(line) + "</li>\n"; }

std::vector<EngineDigest> digests_of(const ReportSource& source) {
  return engine_digests(source.rows, source.timings, recorded_edges(source));
}

std::vector<std::string> answer_lines(const ReportSource& source) {
  std::vector<std::string> lines = law_lines(source);
  if (const std::string chance = chance_line(source); !chance.empty()) lines.push_back(chance);
  return lines;
}

}  // namespace

std::vector<std::string> overrides_of(const Provenance& provenance) {
  std::vector<std::string> overrides = provenance.set;
  const bool is_told = !overrides.empty();
  const auto words = command_words(provenance.command);
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    if (words[i] == "--set" && !is_told) overrides.push_back(words[i + 1]);
    if (words[i] == "--step" && !is_told) overrides.push_back("step_s=" + words[i + 1]);
    if (words[i] == "--duration" && !is_told) overrides.push_back("duration_s=" + words[i + 1]);
    if (words[i] == "--engine" || words[i] == "--only")
      overrides.push_back(words[i] + ' ' + words[i + 1]);
  }
  return overrides;
}

std::vector<std::string> law_lines(const ReportSource& source) {
  if (source.rows.empty()) return {};
  const auto engines = digests_of(source);
  std::vector<std::string> lines = breach_lines(engines);
  if (const std::string line = fastest_line(engines); !line.empty()) lines.push_back(line);
  return lines;
}

std::string chance_line(const ReportSource& source) {
  std::map<std::string, std::set<std::uint64_t>> starts;
  bool moves = false;
  for (const Row& row : source.rows) {
    if (row.state_hash.empty()) continue;
    starts[scene_of(row)].insert(row.seed);
    moves = moves || (row.metric == k_displaced && row.value.value_or(0.0) > 0.0);
  }
  const bool few = std::ranges::any_of(starts, [](const auto& scene) {
    return scene.second.size() < statistics::k_least_for_interval;
  });
  if (!moves || !few) return "";
  std::string text =
      "Chance: which bricks fall, where they lie and when they rest can turn on the last digits of "
      "the "
      "start. From so few starts nobody is ranked by that.";
  if (!source.provenance.command.starts_with("brickbench") &&
      source.provenance.command.find(" run ") == std::string::npos)
    return text;
  return text +
         " To tell: the command of this run with --set seeds=16 --set "
         "'perturb={position_m=1e-6}', and a page of that.";
}

std::string html_answer(const ReportSource& source, const Palette& palette) {
  const auto lines = answer_lines(source);
  if (lines.empty()) return "";
  std::string out = "<ul>\n";
  for (const std::string& line : lines) out += list_item(line);
  out += "</ul>\n";
  out += html_table(engine_table(digests_of(source), k_engines_in_answer), palette);
  return out +
         "<p class=\"quiet\">By the numbers of this run: energy or momentum out of nothing above a "
         "millionth of what there is, overlap above a thousandth of the smallest edge (where the "
         "motion "
         "was recorded), bodies that passed one another. <code>brickbench oracle laws</code> "
         "judges every "
         "step and admits what an engine's scheme may do.</p>\n";
}

std::string markdown_answer(const ReportSource& source) {
  const auto lines = answer_lines(source);
  if (lines.empty()) return "";
  std::string out = "\n## Who broke a law here\n\n";
  for (const std::string& line : lines) out += "- " + markdown_cell(line) + '\n';
  return out + '\n' + to_markdown(engine_table(digests_of(source), k_engines_in_answer));
}

}  // namespace brickbench
