#include "reports/src/figures.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "reports/src/flags.hpp"
#include "reports/src/replay_source.hpp"
#include "reports/src/scene_names.hpp"

namespace brickbench {
namespace {

struct CellFacts {
  std::string scene;
  std::string contender;
  std::uint64_t seed = 0;
  double step_s = 0.0;
  std::string validity;
  std::string outcome;  // of a run that did not go to its end
};

std::map<std::string, CellFacts> facts_by_cell(const ReportSource& source) {
  std::map<std::string, CellFacts> facts;
  for (const Row& row : source.rows) {
    if (!facts.contains(row.cell))
      facts.emplace(row.cell, CellFacts{scene_of(row), contender_of(row), row.seed, row.step_s,
                                        row.validity, row.state_hash.empty() ? row.outcome : ""});
  }
  return facts;
}

// "energy_created_j" is told by "energy_created_relative" where both exist.
bool has_relative_twin(const Block& block, const std::string& name) {
  const std::string twin = name.substr(0, name.rfind('_')) + "_relative";
  return twin != name &&
         std::ranges::any_of(block.numbers, [&](const Number& n) { return n.name == twin; });
}

bool should_be_small(const Block& block, const Number& number) {
  return number.better == "lower" && !has_relative_twin(block, number.name);
}

// The time of a run that failed or is flagged is no cost of anything.
bool is_timed(const Timing& timing) { return timing.outcome == "ok" && timing.validity.empty(); }

struct Place {
  std::string family;
  std::string group;
  std::string number;
  auto operator<=>(const Place&) const = default;
};

template <typename Key>
Figure& figure_of(std::vector<Figure>& figures, std::map<Key, std::size_t>& known, const Key& key) {
  const auto [place, is_new] = known.emplace(key, figures.size());
  if (is_new) figures.emplace_back();
  return figures[place->second];
}

// Marks the curve of a flagged run.
void mark(Curve& curve, const CellFacts& cell) {
  if (cell.validity.empty()) return;
  curve.flagged_from = static_cast<double>(first_flagged_step(cell.validity)) * cell.step_s;
}

// Who is missing among the curves of a scene, and why: " No curve of bee/v (blown_up)."
std::string missing_note(const Figure& figure, const std::map<std::string, CellFacts>& facts) {
  std::map<std::string, std::string> missing;
  for (const auto& [id, cell] : facts) {
    const bool is_drawn =
        std::ranges::find(figure.curves, cell.contender, &Curve::label) != figure.curves.end();
    if (cell.scene == figure.scene && !is_drawn && !cell.outcome.empty()) {
      missing[cell.contender] = cell.outcome;
    }
  }
  std::string text;
  for (const auto& [who, why] : missing) {
    text += fmt::format("{}{} ({})", text.empty() ? "No curve of " : ", ", who, why);
  }
  return text.empty() ? "" : text + ". ";
}

// What a flag is in a figure over time, with the words of the runs.
std::string flags_note(const Figure& figure, const std::map<std::string, CellFacts>& facts) {
  std::set<std::string> told;
  for (const auto& [id, cell] : facts) {
    if (cell.scene != figure.scene || cell.validity.empty()) continue;
    told.insert(fmt::format("{} {}", cell.contender, cell.validity));
  }
  if (told.empty()) return "";
  return fmt::format("Faint, with a cross at the first step: not to be trusted. {}. ",
                     fmt::join(told, "; "));
}

Curve& curve_of(Figure& figure, const std::string& label, Palette& palette) {
  const auto found = std::ranges::find(figure.curves, label, &Curve::label);
  if (found != figure.curves.end()) return *found;
  Curve curve;
  curve.label = label;
  curve.colour = palette.index(label);
  figure.curves.push_back(std::move(curve));
  return figure.curves.back();
}

void sort_by_x(Curve& curve) {
  std::vector<std::size_t> order(curve.x.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return curve.x[i]; });
  const auto permute = [&](std::vector<double>& values) {
    if (values.empty()) return;
    std::vector<double> sorted;
    for (const std::size_t i : order) sorted.push_back(values[i]);
    values = std::move(sorted);
  };
  permute(curve.y);
  permute(curve.low);
  permute(curve.high);
  permute(curve.x);
}

// Slope of the least-squares line through (log x, log y) of the positive points; none with fewer
// than two steps.
std::optional<double> order_of(const Curve& curve) {
  double n = 0.0;
  double sx = 0.0;
  double sy = 0.0;
  double sxx = 0.0;
  double sxy = 0.0;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (!(curve.x[i] > 0.0) || !(curve.y[i] > 0.0)) continue;
    const double x = std::log(curve.x[i]);
    const double y = std::log(curve.y[i]);
    n += 1.0;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  const double spread = n * sxx - sx * sx;
  if (n < 2.0 || spread <= 1e-12 * n * sxx) return {};
  return (n * sxy - sx * sy) / spread;
}

bool any_positive(const Figure& figure) {
  return std::ranges::any_of(figure.curves, [](const Curve& curve) {
    return std::ranges::any_of(curve.y, [](double y) { return y > 0.0; });
  });
}

std::string hidden_note(const Figure& figure) {
  const std::size_t hidden = hidden_points(figure);
  return hidden == 0 ? ""
                     : fmt::format("{} points that are not above zero are not shown. ", hidden);
}

// Adds to the caption who is not drawn because its number is flagged or missing.
void note_left_out(const Score& score, const std::string& who, Figure& figure) {
  if (score.is_valid() || score.outcome == "not_applicable") return;
  const bool is_flagged = score.flagged > 0;
  const std::string why =
      is_flagged ? fmt::format("{} !", fmt::join(flag_words(score.validity), ", ")) : score.outcome;
  figure.caption += fmt::format("{}{} ({})", figure.caption.empty() ? "" : ", ", who, why);
}

std::string left_out_text(const std::string& who) {
  return who.empty() ? "" : fmt::format("Not drawn: {}. ", who);
}

}  // namespace

std::vector<Figure> figures_over_time(const ReportSource& source, Palette& palette) {
  const auto facts = facts_by_cell(source);
  std::map<std::pair<std::string, std::string>, std::uint64_t> first_seed;
  for (const auto& [cell, fact] : facts) {
    const auto [place, is_new] =
        first_seed.emplace(std::pair{fact.scene, fact.contender}, fact.seed);
    if (!is_new) place->second = std::min(place->second, fact.seed);
  }
  std::vector<Figure> figures;
  std::map<std::pair<std::string, std::string>, std::size_t> known;
  for (const SeriesPoint& point : source.series) {
    const auto fact = facts.find(point.cell);
    if (fact == facts.end()) continue;
    const CellFacts& cell = fact->second;
    if (first_seed.at({cell.scene, cell.contender}) != cell.seed) continue;
    Figure& figure = figure_of(figures, known, std::pair{cell.scene, point.curve});
    if (figure.id.empty()) {
      figure.id =
          file_id(fmt::format("time-{}-{}-{}", point.experiment, figures.size(), point.curve));
      figure.title = fmt::format("{}: {}", point.curve, cell.scene);
      figure.scene = cell.scene;
      figure.heading = point.curve;
      figure.x = {"time_s", "s", false};
      figure.y = {point.curve, point.unit, false};
      figure.over_time = true;
    }
    Curve& curve = curve_of(figure, cell.contender, palette);
    curve.x.push_back(point.time_s);
    curve.y.push_back(point.value);
    mark(curve, cell);
  }
  for (Figure& figure : figures) {
    figure.caption = flags_note(figure, facts) + missing_note(figure, facts);
  }
  return figures;
}

std::vector<Figure> figures_against_step(const ReportSource& source, Palette& palette) {
  const std::vector<Block> blocks = summarize(source.rows);
  std::map<std::string, std::set<double>> steps;
  for (const Block& block : blocks) steps[family_label(block)].insert(block.step_s);
  std::vector<Figure> figures;
  std::map<Place, std::size_t> known;
  for (const Block& block : blocks) {
    if (steps[family_label(block)].size() < 2) continue;
    for (std::size_t n = 0; n < block.numbers.size(); ++n) {
      const Number& number = block.numbers[n];
      if (!should_be_small(block, number)) continue;
      Figure& figure =
          figure_of(figures, known, Place{family_label(block), block.group, number.name});
      if (figure.id.empty()) {
        figure.id =
            file_id(fmt::format("step-{}-{}-{}", block.experiment, figures.size(), number.name));
        figure.title = fmt::format("{} against the step: {}", number.name, family_label(block));
        figure.scene = family_label(block);
        figure.heading = number.name;
        figure.x = {"step_s", "s", true};
        figure.y = {number.name, number.unit, true};
        figure.markers = true;
      }
      for (std::size_t c = 0; c < block.contenders.size(); ++c) {
        const Score& score = block.scores[c][n];
        const std::string label = block.contenders[c].label();
        note_left_out(score, fmt::format("{} at {:.4g} s", label, block.step_s), figure);
        if (!score.is_valid()) continue;
        Curve& curve = curve_of(figure, label, palette);
        curve.x.push_back(block.step_s);
        curve.y.push_back(*score.mean);
        curve.low.push_back(score.lowest);
        curve.high.push_back(score.highest);
      }
    }
  }
  std::erase_if(figures, [](const Figure& figure) { return !any_positive(figure); });
  for (Figure& figure : figures) {
    for (Curve& curve : figure.curves) {
      sort_by_x(curve);
      if (const auto order = order_of(curve)) curve.note = fmt::format("order {:.2f}", *order);
      if (curve.low == curve.y && curve.high == curve.y) {
        curve.low.clear();
        curve.high.clear();
      }
    }
    figure.caption = hidden_note(figure) + left_out_text(figure.caption);
  }
  return figures;
}

std::vector<Figure> figures_against_cost(const ReportSource& source, Palette& palette) {
  const auto facts = facts_by_cell(source);
  std::map<std::pair<std::string, std::string>, std::vector<double>> costs;
  for (const Timing& timing : source.timings) {
    const auto fact = facts.find(timing.cell);
    const double simulated_s = timing.step_s * static_cast<double>(timing.steps);
    if (fact == facts.end() || !is_timed(timing) || !(simulated_s > 0.0)) continue;
    costs[{fact->second.scene, fact->second.contender}].push_back(timing.steps_total_cpu_s /
                                                                  simulated_s);
  }
  std::vector<Figure> figures;
  std::map<Place, std::size_t> known;
  for (const Block& block : summarize(source.rows)) {
    const auto first = std::ranges::find_if(
        block.numbers, [&](const Number& number) { return should_be_small(block, number); });
    if (first == block.numbers.end()) continue;
    const auto n = static_cast<std::size_t>(first - block.numbers.begin());
    Figure& figure =
        figure_of(figures, known, Place{family_label(block), block.group, first->name});
    if (figure.id.empty()) {
      figure.id =
          file_id(fmt::format("cost-{}-{}-{}", block.experiment, figures.size(), first->name));
      figure.title = fmt::format("{} against cost: {}", first->name, family_label(block));
      figure.scene = family_label(block);
      figure.heading = first->name;
      figure.x = {"engine CPU seconds per simulated second", "1", true};
      figure.y = {first->name, first->unit, true};
      figure.markers = true;
    }
    for (std::size_t c = 0; c < block.contenders.size(); ++c) {
      const std::string label = block.contenders[c].label();
      auto cost = costs.find({scene_label(block), label});
      note_left_out(block.scores[c][n], fmt::format("{} at {:.4g} s", label, block.step_s), figure);
      if (!block.scores[c][n].is_valid() || cost == costs.end()) continue;
      std::ranges::sort(cost->second);
      Curve& curve = curve_of(figure, label, palette);
      curve.x.push_back(cost->second[cost->second.size() / 2]);
      curve.y.push_back(*block.scores[c][n].mean);
    }
  }
  std::erase_if(figures, [](const Figure& figure) { return !any_positive(figure); });
  for (Figure& figure : figures) {
    std::set<std::string> front;
    for (const Curve& curve : figure.curves) {
      for (std::size_t i = 0; i < curve.x.size(); ++i) {
        bool beaten = false;
        for (const Curve& other : figure.curves) {
          for (std::size_t j = 0; j < other.x.size(); ++j) {
            beaten |= other.x[j] <= curve.x[i] && other.y[j] <= curve.y[i] &&
                      (other.x[j] < curve.x[i] || other.y[j] < curve.y[i]);
          }
        }
        if (!beaten) front.insert(curve.label);
      }
    }
    figure.caption =
        hidden_note(figure) + left_out_text(figure.caption) +
        fmt::format("No other is both cheaper and better than: {}.", fmt::join(front, ", "));
    for (Curve& curve : figure.curves) sort_by_x(curve);
  }
  return figures;
}

}  // namespace brickbench
