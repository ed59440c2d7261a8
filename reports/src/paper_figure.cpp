#include "reports/src/paper_figure.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "experiments/record/schema.hpp"
#include "experiments/statistics/bootstrap.hpp"

namespace brickbench {
namespace {

// A setting as text; none where the cell has no such setting.
std::optional<std::string> setting_text(const CellLine& line, const std::string& name) {
  if (name == "folder") return line.folder;
  if (name == "experiment") return line.experiment;
  if (name == "scenario") return line.scenario;
  if (name == "engine") return line.engine;
  if (name == "step_s") return shortest(line.step_s);
  if (name == "duration_s") return shortest(line.duration_s);
  const auto found = line.axes.find(name);
  if (found == line.axes.end()) return std::nullopt;
  return found->second;
}

bool is_wanted(const CellLine& line, const FigureAsk& ask) {
  if (!ask.engines.empty() && std::ranges::count(ask.engines, line.engine) == 0) return false;
  return std::ranges::all_of(ask.where, [&](const auto& condition) {
    return setting_text(line, condition.first) == condition.second;
  });
}

// Numbers by size, words by letters.
bool comes_before(const std::string& a, const std::string& b) {
  const auto left = parse_number(a);
  const auto right = parse_number(b);
  return left && right ? *left < *right : a < b;
}

std::vector<std::string> values_of(const std::vector<const CellLine*>& lines,
                                   const std::string& name) {
  std::set<std::string> seen;
  for (const CellLine* line : lines) seen.insert(setting_text(*line, name).value_or(""));
  std::vector<std::string> values(seen.begin(), seen.end());
  std::ranges::sort(values, comes_before);
  return values;
}

// A setting in which the cells differ although the figure does not ask for it.
std::string mixed_setting(const CellTable& table, const std::vector<const CellLine*>& lines,
                          const FigureAsk& ask) {
  for (const std::string& name : setting_names(table)) {
    if (name == ask.x || name == ask.facet || name == ask.group) continue;
    if (name == "scenario") continue;  // follows from the experiment
    const auto values = values_of(lines, name);
    if (values.size() > 1) {
      return fmt::format(
          "cells differ in {} ({}) and would be averaged together; choose one by --where "
          "{}={}, or name it by --facet or --group",
          name, fmt::join(values, ", "), name, values.front());
    }
  }
  return "";
}

PaperPoint point_of(double x, std::vector<double> runs, ErrorBars error) {
  PaperPoint point;
  point.x = x;
  point.mean = statistics::moments(runs).mean;
  point.low = point.high = point.mean;
  const bool few = runs.size() < statistics::k_least_for_interval;
  if (error == ErrorBars::range || (error == ErrorBars::interval && few)) {
    point.low = std::ranges::min(runs);
    point.high = std::ranges::max(runs);
  } else if (error == ErrorBars::interval) {
    const statistics::Interval interval = statistics::mean_interval(runs);
    point.low = interval.low;
    point.high = interval.high;
  }
  point.runs = std::move(runs);
  return point;
}

std::string capital(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string unit_of_setting(const std::string& name) {
  struct Suffix {
    std::string_view end, unit;
  };
  constexpr std::array<Suffix, 9> k_suffixes = {
      Suffix{"_kgpm3", "kg/m3"}, Suffix{"_mps2", "m/s2"}, Suffix{"_mps", "m/s"},
      Suffix{"_radps", "rad/s"}, Suffix{"_rad", "rad"},   Suffix{"_kg", "kg"},
      Suffix{"_m", "m"},         Suffix{"_s", "s"},       Suffix{"_n", "N"}};
  for (const Suffix& suffix : k_suffixes) {
    if (name.ends_with(suffix.end)) return std::string(suffix.unit);
  }
  return "1";
}

struct Prefix {
  std::string_view unit;
  std::string_view scaled;
  double factor;
  double up_to;  // values below it are told in the scaled unit
};
constexpr std::array<Prefix, 4> k_prefixes = {
    Prefix{"m", "um", 1e6, 1e-4}, Prefix{"m", "mm", 1e3, 0.1}, Prefix{"s", "us", 1e6, 1e-4},
    Prefix{"s", "ms", 1e3, 0.1}};

// The words of a name, without its unit: "penetration_max_m" -> "largest penetration".
std::string words_of(std::string name, const std::string& unit) {
  if (name.starts_with("knob.")) name = name.substr(5);
  const bool share = name.ends_with("_relative");
  if (share) {
    name.resize(name.size() - std::string_view("_relative").size());
  } else if (unit != "1" && !unit.empty()) {
    name.resize(std::min(name.size(), name.rfind('_')));
  }
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> k_last = {
      {{"_max", "largest "},
       {"_mean", "mean "},
       {"_rms", "r.m.s. "},
       {"_p99", "99th percentile of "},
       {"_min", "smallest "}}};
  std::string before;
  for (const auto& [last, word] : k_last) {
    if (!name.ends_with(last)) continue;
    name.resize(name.size() - last.size());
    before = word;
    break;
  }
  std::string after;
  constexpr std::array<std::pair<std::string_view, std::string_view>, 2> k_when = {
      {{"_final", " at the end"}, {"_initial", " at the start"}}};
  for (const auto& [last, word] : k_when) {
    if (!name.ends_with(last)) continue;
    name.resize(name.size() - last.size());
    after = word;
  }
  std::ranges::replace(name, '_', ' ');
  return before + name + after + (share ? ", relative" : "");
}

// What was left out, for the caption.
struct LeftOut {
  std::size_t flagged = 0;
  std::size_t without = 0;
};

using Runs =
    std::map<std::string, std::map<std::string, std::map<std::string, std::vector<double>>>>;

Runs collect(const std::vector<const CellLine*>& lines, const FigureAsk& ask, LeftOut& out) {
  Runs runs;
  for (const CellLine* line : lines) {
    const auto number = line->numbers.find(ask.y);
    if (!line->validity.empty()) {
      ++out.flagged;
    } else if (number == line->numbers.end() || !std::isfinite(number->second)) {
      ++out.without;
    } else {
      const std::string facet =
          ask.facet.empty() ? "" : setting_text(*line, ask.facet).value_or("");
      runs[facet][setting_text(*line, ask.group).value_or("")]
          [setting_text(*line, ask.x).value_or("")]
              .push_back(number->second);
    }
  }
  return runs;
}

std::string caption_of(const PaperFigure& figure, const FigureAsk& ask, const LeftOut& out) {
  std::size_t fewest = SIZE_MAX;
  std::size_t most = 0;
  for (const PaperPanel& panel : figure.panels) {
    for (const PaperCurve& curve : panel.curves) {
      for (const PaperPoint& point : curve.points) {
        fewest = std::min(fewest, point.runs.size());
        most = std::max(most, point.runs.size());
      }
    }
  }
  std::string text = most == 1
                         ? "Points: single runs."
                         : fmt::format("Points: means of {} runs.",
                                       fewest == most ? fmt::format("{}", most)
                                                      : fmt::format("{} to {}", fewest, most));
  if (most > 1 && ask.error == ErrorBars::interval) {
    text += fewest < statistics::k_least_for_interval
                ? fmt::format(
                      " Bars: {:.3g} % bootstrap intervals of the mean, of fewer than {} runs "
                      "their range.",
                      100.0 * statistics::k_interval_level, statistics::k_least_for_interval)
                : fmt::format(" Bars: {:.3g} % bootstrap intervals of the mean.",
                              100.0 * statistics::k_interval_level);
  } else if (most > 1 && ask.error == ErrorBars::range) {
    text += " Bars: range of the runs.";
  }
  if (most > 1) text += " Dots: the runs.";
  if (out.flagged + out.without > 0) {
    text += fmt::format(" Left out: {} flagged runs, {} without a finite number.", out.flagged,
                        out.without);
  }
  return text;
}

Expected<void> check_positive(const PaperFigure& figure) {
  for (const PaperPanel& panel : figure.panels) {
    for (const PaperCurve& curve : panel.curves) {
      for (const PaperPoint& point : curve.points) {
        if (figure.x.logarithmic && point.x <= 0.0)
          return fail(Fault::invalid,
                      fmt::format("x = {} has no place on a logarithmic axis", point.x));
        if (figure.y.logarithmic && point.mean <= 0.0)
          return fail(Fault::invalid, fmt::format("y = {} of {} has no place on a logarithmic axis",
                                                  point.mean, curve.group));
      }
    }
  }
  return {};
}

void add_panels(PaperFigure& figure, const Runs& runs, const FigureAsk& ask) {
  const auto place_of = [&](const std::string& x) {
    const auto number = parse_number(x);
    if (figure.categories.empty()) return number.value_or(0.0);
    const auto at = std::ranges::find(figure.categories, x);
    return 1.0 + static_cast<double>(at - figure.categories.begin());
  };
  for (const auto& [facet, groups] : runs) {
    PaperPanel panel{facet, {}};
    for (const auto& [group, points] : groups) {
      const auto at = std::ranges::find(figure.groups, group);
      PaperCurve curve{group, static_cast<std::size_t>(at - figure.groups.begin()), {}};
      for (const auto& [x, values] : points)
        curve.points.push_back(point_of(place_of(x), values, ask.error));
      std::ranges::sort(curve.points, {}, &PaperPoint::x);
      panel.curves.push_back(std::move(curve));
    }
    std::ranges::sort(panel.curves, {}, &PaperCurve::style);
    figure.panels.push_back(std::move(panel));
  }
  std::ranges::sort(figure.panels, comes_before, &PaperPanel::facet);
}

double largest_of(const PaperFigure& figure, double PaperPoint::*part) {
  double largest = 0.0;
  for (const PaperPanel& panel : figure.panels) {
    for (const PaperCurve& curve : panel.curves) {
      for (const PaperPoint& point : curve.points)
        largest = std::max(largest, std::abs(point.*part));
    }
  }
  return largest;
}

}  // namespace

std::vector<std::string> setting_names(const CellTable& table) {
  std::vector<std::string> names = {"engine",     "step_s",   "duration_s",
                                    "experiment", "scenario", "folder"};
  names.insert(names.end(), table.axes.begin(), table.axes.end());
  return names;
}

PaperAxis paper_axis(const std::string& name, const std::string& unit, double largest) {
  PaperAxis axis;
  axis.label = capital(words_of(name, unit));
  if (unit.empty() || unit == "1") return axis;
  std::string told = unit;
  for (const Prefix& prefix : k_prefixes) {
    if (prefix.unit != unit || largest >= prefix.up_to || largest == 0.0) continue;
    told = prefix.scaled;
    axis.factor = prefix.factor;
    break;
  }
  axis.label += " / " + told;
  return axis;
}

Expected<PaperFigure> paper_figure(const CellTable& table, const FigureAsk& ask) {
  std::vector<const CellLine*> lines;
  for (const CellLine& line : table.lines) {
    if (is_wanted(line, ask) && line.outcome == "ok") lines.push_back(&line);
  }
  if (lines.empty()) return fail(Fault::invalid, "no cell that ran to its end is left to draw");
  if (const std::string mixed = mixed_setting(table, lines, ask); !mixed.empty())
    return fail(Fault::invalid, mixed);
  PaperFigure figure;
  LeftOut out;
  const Runs runs = collect(lines, ask, out);
  if (runs.empty()) {
    return fail(Fault::invalid, fmt::format("no cell has a {}: {} are flagged, {} have no finite "
                                            "number",
                                            ask.y, out.flagged, out.without));
  }
  std::set<std::string> groups;
  for (const auto& [facet, of] : runs) {
    for (const auto& [group, points] : of) groups.insert(group);
  }
  figure.groups.assign(groups.begin(), groups.end());
  std::ranges::sort(figure.groups, comes_before);
  if (figure.groups.size() > k_most_styles) {
    return fail(
        Fault::invalid,
        fmt::format("{} curves cannot be told apart, at most {}; choose some by --engine or "
                    "--where. There are: {}",
                    figure.groups.size(), k_most_styles, fmt::join(figure.groups, ", ")));
  }
  const auto xs = values_of(lines, ask.x);
  const bool is_number =
      std::ranges::all_of(xs, [](const std::string& x) { return parse_number(x).has_value(); });
  if (!is_number) figure.categories = xs;
  add_panels(figure, runs, ask);
  figure.x = paper_axis(ask.x, is_number ? unit_of_setting(ask.x) : "1",
                        largest_of(figure, &PaperPoint::x));
  figure.x.logarithmic = ask.log_x && is_number;
  figure.y = paper_axis(ask.y, table.find(ask.y)->unit, largest_of(figure, &PaperPoint::high));
  figure.y.logarithmic = ask.log_y;
  if (!ask.facet.empty()) {
    figure.facet_label = paper_axis(ask.facet, unit_of_setting(ask.facet), HUGE_VAL).label;
  }
  if (auto ok = check_positive(figure); !ok) return tl::unexpected(ok.error());
  figure.caption = caption_of(figure, ask, out);
  return figure;
}

}  // namespace brickbench
