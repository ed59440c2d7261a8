#include "reports/src/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

namespace brickbench {
namespace {

constexpr std::string_view k_not_applicable = "not_applicable";

template <typename Item, typename Key>
std::size_t index_of(std::vector<Item>& items, const Key& same, Item otherwise) {
  const auto found = std::ranges::find_if(items, same);
  if (found != items.end()) return static_cast<std::size_t>(found - items.begin());
  items.push_back(std::move(otherwise));
  return items.size() - 1;
}

// The values of one score, collected before they are reduced.
struct Sheet {
  using Values = std::map<std::pair<std::size_t, std::size_t>, std::vector<double>>;
  Block block;
  Values valid;
  Values flagged;
};

void add(Sheet& sheet, const Row& row, const std::string& knobs) {
  Block& block = sheet.block;
  const Contender contender{row.engine, row.variant, knobs};
  const std::size_t who = index_of(
      block.contenders, [&](const Contender& c) { return c == contender; }, contender);
  const std::size_t what = index_of(
      block.numbers, [&](const Number& n) { return n.name == row.metric; },
      Number{row.metric, row.unit, row.better, {}, {}});
  block.scores.resize(block.contenders.size());
  for (auto& scores : block.scores) scores.resize(block.numbers.size());
  Score& score = block.scores[who][what];
  ++score.cells;
  if (row.value && !row.validity.empty()) {
    if (score.flagged++ == 0) score.validity = row.validity;
    sheet.flagged[{who, what}].push_back(*row.value);
  } else if (row.value) {
    if (score.with_value++ == 0) score.note = row.note;
    sheet.valid[{who, what}].push_back(*row.value);
  } else if (score.outcome.empty()) {
    score.outcome = row.outcome;
    score.reason = row.reason;
  }
}

// Of sorted values some of which are infinite, and so without a mean: the one in the middle.
double middle_of(const std::vector<double>& sorted) { return sorted[(sorted.size() - 1) / 2]; }

void reduce(Block& block, Sheet::Values& all) {
  for (auto& [place, values] : all) {
    Score& score = block.scores[place.first][place.second];
    if (score.mean) continue;
    std::ranges::sort(values);
    score.lowest = values.front();
    score.highest = values.back();
    const bool finite = std::isfinite(score.lowest) && std::isfinite(score.highest);
    score.mean = finite ? statistics::moments(values).mean : middle_of(values);
    if (finite && values.size() >= statistics::k_least_for_interval) {
      score.interval = statistics::mean_interval(values);
    }
  }
}

bool is_same(const Score& a, const Score& b) {
  return a.is_valid() && b.is_valid() && std::abs(*a.mean - *b.mean) <= k_rounding;
}

// Best and worst engine of each number that has a direction and differs between engines.
void rank(Block& block) {
  for (std::size_t n = 0; n < block.numbers.size(); ++n) {
    Number& number = block.numbers[n];
    if (number.better == "neither") continue;
    std::optional<std::size_t> low;
    std::optional<std::size_t> high;
    for (std::size_t c = 0; c < block.contenders.size(); ++c) {
      if (!block.scores[c][n].is_valid()) continue;
      const auto& mean = block.scores[c][n].mean;
      if (!low || *mean < *block.scores[*low][n].mean) low = c;
      if (!high || *mean > *block.scores[*high][n].mean) high = c;
    }
    if (!low || is_same(block.scores[*low][n], block.scores[*high][n])) continue;
    number.best = number.better == "lower" ? low : high;
    number.worst = number.better == "lower" ? high : low;
  }
}

}  // namespace

AxesParts split_axes(const std::string& axes) {
  AxesParts result;
  for (std::size_t at = 0; at < axes.size();) {
    const std::size_t end = std::min(axes.find(';', at), axes.size());
    const std::string axis = axes.substr(at, end - at);
    std::string& part = axis.starts_with("knob.") ? result.knobs : result.scene;
    part += (part.empty() ? "" : ", ") + axis;
    at = end + 1;
  }
  return result;
}

std::string Contender::label() const {
  std::string text = engine + '/' + variant;
  if (!knobs.empty()) text += " (" + knobs + ')';
  return text;
}

std::vector<Block> summarize(std::span<const Row> rows) {
  using Key = std::tuple<std::string, std::string, double, double, std::string>;
  std::map<Key, std::size_t> known;
  std::vector<Sheet> sheets;
  for (const Row& row : rows) {
    const AxesParts axes = split_axes(row.axes);
    const Key key{row.experiment, axes.scene, row.step_s, row.duration_s, row.group};
    const auto [place, is_new] = known.emplace(key, sheets.size());
    if (is_new) {
      Sheet sheet;
      sheet.block.experiment = row.experiment;
      sheet.block.scenario = row.scenario;
      sheet.block.axes = axes.scene;
      sheet.block.step_s = row.step_s;
      sheet.block.duration_s = row.duration_s;
      sheet.block.group = row.group;
      sheets.push_back(std::move(sheet));
    }
    add(sheets[place->second], row, axes.knobs);
  }
  std::vector<Block> blocks;
  for (Sheet& sheet : sheets) {
    reduce(sheet.block, sheet.valid);
    reduce(sheet.block, sheet.flagged);
    rank(sheet.block);
    blocks.push_back(std::move(sheet.block));
  }
  return blocks;
}

bool is_best(const Block& block, std::size_t c, std::size_t n) {
  const auto& best = block.numbers[n].best;
  return best && is_same(block.scores[c][n], block.scores[*best][n]);
}

bool is_worst(const Block& block, std::size_t c, std::size_t n) {
  const auto& worst = block.numbers[n].worst;
  return worst && is_same(block.scores[c][n], block.scores[*worst][n]);
}

Table to_table(const Block& block) {
  std::vector<std::size_t> shown;
  for (std::size_t n = 0; n < block.numbers.size(); ++n) {
    const bool nowhere = std::ranges::all_of(block.scores, [&](const auto& scores) {
      return scores[n].outcome == k_not_applicable && !scores[n].mean;
    });
    if (!nowhere) shown.push_back(n);
  }
  Table table;
  table.header.emplace_back("engine");
  for (const std::size_t n : shown) table.header.push_back(block.numbers[n].name);
  for (std::size_t c = 0; c < block.contenders.size() && !shown.empty(); ++c) {
    std::vector<TableCell> row = {{block.contenders[c].label()}};
    for (const std::size_t n : shown) {
      const Score& score = block.scores[c][n];
      Mark mark = Mark::plain;
      if (!score.mean)
        mark = Mark::failed;
      else if (!score.is_valid())
        mark = Mark::flagged;
      else if (is_best(block, c, n))
        mark = Mark::best;
      else if (is_worst(block, c, n))
        mark = Mark::worst;
      row.push_back({score_text(score), mark});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string scene_label(const Block& block) {
  return fmt::format("{}{}{}, step {} s, {} s", block.experiment, block.axes.empty() ? "" : ": ",
                     block.axes, block.step_s, block.duration_s);
}

std::string short_number(double value) { return fmt::format("{:.4g}", value); }

std::string score_text(const Score& score) {
  if (!score.mean) {
    return score.cells > 1 ? fmt::format("{} (0 of {})", score.outcome, score.cells)
                           : score.outcome;
  }
  const std::string mark = score.is_valid() ? "" : " !";
  if (score.cells == 1) return short_number(*score.mean) + mark;
  const std::string flagged = score.flagged > 0 ? fmt::format(", {} !", score.flagged) : "";
  const std::string spread =
      score.interval
          ? fmt::format("{:.3g} % {} .. {}", 100.0 * statistics::k_interval_level,
                        short_number(score.interval->low), short_number(score.interval->high))
          : fmt::format("range {} .. {}", short_number(score.lowest), short_number(score.highest));
  return fmt::format("mean {}{}, {} ({} of {}{})", short_number(*score.mean), mark, spread,
                     score.with_value, score.cells, flagged);
}

std::vector<std::string> flag_lines(std::span<const Block> blocks) {
  std::vector<std::string> lines;
  std::set<std::string> seen;
  for (const Block& block : blocks) {
    for (std::size_t c = 0; c < block.contenders.size(); ++c) {
      const auto& scores = block.scores[c];
      const auto worst = std::ranges::max_element(scores, {}, &Score::flagged);
      const std::string label = block.contenders[c].label();
      if (worst == scores.end() || worst->flagged == 0 || !seen.insert(label).second) continue;
      lines.push_back(fmt::format("! {}: {}", label, worst->validity));
      if (worst->cells > 1) {
        lines.back() +=
            fmt::format(" (the first of {} flagged among {} cells)", worst->flagged, worst->cells);
      }
    }
  }
  return lines;
}

}  // namespace brickbench
