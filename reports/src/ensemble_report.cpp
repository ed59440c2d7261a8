#include "reports/src/ensemble_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "experiments/record/schema.hpp"
#include "experiments/statistics/bootstrap.hpp"
#include "reports/src/ensemble_words.hpp"
#include "reports/src/html_sections.hpp"
#include "reports/src/markup.hpp"
#include "reports/src/summary.hpp"

namespace brickbench {
namespace {

constexpr std::size_t k_figures_first = 6;  // the others wait behind a line
constexpr std::size_t k_full_fans = 3;
constexpr std::array<std::string_view, 3> k_first_curves = {"kinetic_energy_j", "penetration_m",
                                                            "displaced_count"};

double mean(const StartSample& sample) { return statistics::moments(sample.values).mean; }

std::string runs_text(const StartSample& sample) {
  return sample.without_value == 0 ? fmt::format("{}", sample.values.size())
                                   : fmt::format("{} of {}", sample.values.size(),
                                                 sample.values.size() + sample.without_value);
}

// Different first, then what is open, then what is the same.
int rank(const EnsemblePair& pair) {
  switch (pair.verdict.word) {
    case EnsembleWord::different:
      return 0;
    case EnsembleWord::not_enough_runs:
    case EnsembleWord::untested:
      return 1;
    case EnsembleWord::same:
      return 2;
    case EnsembleWord::identical:
      return 3;
  }
  return 3;
}

bool ranks_before(const EnsemblePair* a, const EnsemblePair* b) {
  if (rank(*a) != rank(*b)) return rank(*a) < rank(*b);
  return a->verdict.p_value < b->verdict.p_value;
}

std::vector<const EnsemblePair*> ranked(const Ensembles& ensembles) {
  std::vector<const EnsemblePair*> order;
  for (const EnsemblePair& pair : ensembles.pairs) order.push_back(&pair);
  std::ranges::stable_sort(order, ranks_before);
  return order;
}

std::string place(const std::string& scene, const std::string& subject) {
  return subject.empty() ? scene : subject + ", " + scene;
}

// The share of the runs up to x, as a staircase.
Curve staircase(const StartSample& sample, Palette& palette) {
  Curve curve;
  curve.label = sample.label;
  curve.colour = palette.index(sample.label);
  curve.note = runs_text(sample) + " runs";
  std::vector<double> values = sample.values;
  std::ranges::sort(values);
  const auto count = static_cast<double>(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    curve.x.insert(curve.x.end(), {values[i], values[i]});
    curve.y.insert(curve.y.end(),
                   {static_cast<double>(i) / count, static_cast<double>(i + 1) / count});
  }
  return curve;
}

Curve band(const Fan& fan, const std::vector<double>& low, const std::vector<double>& high,
           const std::string& what, Palette& palette) {
  Curve curve;
  curve.label = fan.label;
  curve.colour = palette.index(fan.label);
  curve.note = what;
  curve.x = fan.time_s;
  curve.y = fan.median;
  curve.low = low;
  curve.high = high;
  return curve;
}

bool comes_first(const Figure& figure) {
  return std::ranges::find(k_first_curves, figure.heading) != k_first_curves.end();
}

// The page's script replaces figures that it knows; these are drawings for good.
std::string figure_html(const Figure& figure) {
  return fmt::format(
      "<figure>{}<figcaption>{} <a href=\"figures/{}.svg\">SVG</a> <a "
      "href=\"figures/{}.csv\">CSV</a></figcaption></figure>\n",
      to_svg(figure, false), escape_markup(figure.caption), figure.id, figure.id);
}

std::string figures_html(const std::vector<Figure>& figures, const std::string& title,
                         bool by_curve) {
  if (figures.empty()) return "";
  const bool any_first = by_curve && std::ranges::any_of(figures, comes_first);
  std::string first;
  std::string rest;
  std::size_t shown = 0;
  std::size_t waiting = 0;
  for (const Figure& figure : figures) {
    const bool now = shown < k_figures_first && (!any_first || comes_first(figure));
    ++(now ? shown : waiting);
    (now ? first : rest) += figure_html(figure);
  }
  std::string out =
      fmt::format("<h3>{}</h3>\n<div class=\"figures\">\n{}</div>\n", escape_markup(title), first);
  if (waiting > 0) {
    out += fmt::format(
        "<details class=\"more\"><summary>{} more figures</summary>\n<div "
        "class=\"figures\">\n{}</div>\n</details>\n",
        waiting, rest);
  }
  return out;
}

std::string csv_text(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c == '\n' || c == '\r' ? ' ' : c;
  }
  return out + '"';
}

}  // namespace

std::vector<std::string> ensemble_headline(const Ensembles& ensembles) {
  std::array<std::size_t, 5> counts{};
  std::size_t fewest = SIZE_MAX;
  std::size_t most = 0;
  std::size_t without = 0;
  for (const EnsemblePair& pair : ensembles.pairs) {
    ++counts[static_cast<std::size_t>(pair.verdict.word)];
    fewest = std::min({fewest, pair.reference.values.size(), pair.judged.values.size()});
    most = std::max({most, pair.reference.values.size(), pair.judged.values.size()});
    without += pair.reference.without_value + pair.judged.without_value;
  }
  const auto count = [&](EnsembleWord w) { return counts[static_cast<std::size_t>(w)]; };
  const std::size_t asked = ensembles.pairs.size() - count(EnsembleWord::identical);
  std::vector<std::string> lines = {
      fmt::format("{} pairs of ensembles: {} different, {} same within {}, {} open, {} identical.",
                  ensembles.pairs.size(), count(EnsembleWord::different), count(EnsembleWord::same),
                  percent_text(k_equivalence_share), count(EnsembleWord::not_enough_runs),
                  count(EnsembleWord::identical)),
      fmt::format(
          "Each rests on {} runs per side, from perturbed starts. Numbers are means over the "
          "starts, with {} bootstrap intervals in brackets.",
          fewest == most ? fmt::format("{}", most) : fmt::format("{} to {}", fewest, most),
          percent_text(statistics::k_interval_level)),
      fmt::format(
          "Each number of each scene and pair is a question of its own, so no verdict depends on "
          "what "
          "else was run. Different: energy distance of the two samples, p by relabelling (all "
          "relabellings of small samples), at {}: chance alone would call about {:.2g} of these {} "
          "different. Same: the {} bootstrap interval of the difference of the means lies within "
          "{} "
          "of the reference's mean. Open: neither was shown.",
          percent_text(k_alpha_different), k_alpha_different * static_cast<double>(asked), asked,
          percent_text(1.0 - 2.0 * k_alpha_same), percent_text(k_equivalence_share))};
  if (without > 0) {
    lines.push_back(fmt::format(
        "{} values are missing, because runs ended early or the number is not finite: the verdicts "
        "are about the others.",
        without));
  }
  return lines;
}

Table ensemble_table(const Ensembles& ensembles) {
  // A column that says the same in every row stays away.
  const bool scenes = std::ranges::any_of(ensembles.pairs, [&](const EnsemblePair& pair) {
    return pair.scene != ensembles.pairs.front().scene;
  });
  Table table;
  table.header = {"judged",
                  "against",
                  "verdict",
                  "number",
                  "mean of judged",
                  "mean of against",
                  "difference of means",
                  "p",
                  "runs"};
  if (scenes) table.header.emplace_back("scene");
  for (const EnsemblePair* pair : ranked(ensembles)) {
    const EnsembleVerdict& v = pair->verdict;
    if (v.word == EnsembleWord::identical) continue;
    std::vector<TableCell> row = {
        {name_of(*pair, pair->judged)},
        {name_of(*pair, pair->reference)},
        {verdict_sentence(*pair), is_worse(*pair) ? Mark::worst : Mark::plain},
        {pair->number},
        {mean_text(pair->judged)},
        {mean_text(pair->reference)},
        {fmt::format("{} [{} .. {}]", short_number(v.difference), short_number(v.low),
                     short_number(v.high))},
        {fmt::format("{:.2g}", v.p_value)},
        {runs_text(pair->judged) + " / " + runs_text(pair->reference)}};
    if (scenes) row.push_back({pair->scene});
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<Figure> distribution_figures(const Ensembles& ensembles, Palette& palette,
                                         const std::string& prefix) {
  std::vector<Figure> figures;
  for (const EnsemblePair* pair : ranked(ensembles)) {
    if (pair->verdict.word == EnsembleWord::identical) continue;
    const std::string scene = place(pair->scene, pair->subject);
    auto figure = std::ranges::find_if(
        figures, [&](const Figure& f) { return f.scene == scene && f.heading == pair->number; });
    if (figure == figures.end()) {
      Figure fresh;
      fresh.id = prefix + file_id(fmt::format("spread-{}-{}", figures.size() + 1, pair->number));
      fresh.title = fmt::format("{}: {}", pair->number, scene);
      fresh.scene = scene;
      fresh.heading = pair->number;
      fresh.x = {pair->number, pair->unit, false};
      fresh.y = {"share of the runs up to here", "1", false};
      fresh.curves.push_back(staircase(pair->reference, palette));
      figures.push_back(std::move(fresh));
      figure = std::prev(figures.end());
    }
    figure->curves.push_back(staircase(pair->judged, palette));
    figure->caption += fmt::format("{}{} (p = {:.2g}).", figure->caption.empty() ? "" : " ",
                                   verdict_sentence(*pair), pair->verdict.p_value);
  }
  return figures;
}

std::vector<Figure> fan_figures(const Ensembles& ensembles, Palette& palette,
                                const std::string& prefix) {
  std::vector<Figure> figures;
  for (const FanGroup& group : ensembles.fans) {
    if (group.fans.size() < 2) continue;
    const Fan& reference = group.fans.front();
    const bool identical = std::ranges::all_of(group.fans, [&](const Fan& fan) {
      return fan.q05 == reference.q05 && fan.median == reference.median && fan.q95 == reference.q95;
    });
    if (identical) continue;
    Figure figure;
    figure.id = prefix + file_id(fmt::format("fan-{}-{}", figures.size() + 1, group.curve));
    figure.scene = place(group.scene, group.subject);
    figure.title = fmt::format("{}: {}", group.curve, figure.scene);
    figure.heading = group.curve;
    figure.x = {"time_s", "s", false};
    figure.y = {group.curve, group.unit, false};
    const bool full = group.fans.size() <= k_full_fans;
    std::string runs;
    for (const Fan& fan : group.fans) {
      if (full) figure.curves.push_back(band(fan, fan.q05, fan.q95, "5 to 95 %", palette));
      figure.curves.push_back(band(fan, fan.q25, fan.q75, "middle half", palette));
      runs += fmt::format("{}{} {}", runs.empty() ? "" : ", ", fan.label, fan.runs);
    }
    figure.caption = "Lines: medians. Runs: " + runs + '.';
    figures.push_back(std::move(figure));
  }
  return figures;
}

std::vector<Figure> ensemble_figures(const Ensembles& ensembles, Palette& palette,
                                     const std::string& prefix) {
  std::vector<Figure> figures = distribution_figures(ensembles, palette, prefix);
  std::ranges::move(fan_figures(ensembles, palette, prefix), std::back_inserter(figures));
  return figures;
}

std::string ensemble_verdicts_csv(const Ensembles& ensembles) {
  std::string out =
      "scene,subject,judged,reference,number,unit,better,mean,mean_low,mean_high,reference_mean,"
      "reference_mean_low,reference_mean_high,difference,low,high,margin,p_value,p_threshold,runs,"
      "reference_runs,without_value,reference_without_value,more_runs_for_difference,"
      "more_runs_for_same,verdict,sentence\n";
  for (const EnsemblePair* pair : ranked(ensembles)) {
    const EnsembleVerdict& v = pair->verdict;
    for (const std::string* text : {&pair->scene, &pair->subject, &pair->judged.label,
                                    &pair->reference.label, &pair->number, &pair->unit})
      out += csv_text(*text) + ',';
    out += csv_text(pair->better);
    for (const StartSample* sample : {&pair->judged, &pair->reference}) {
      const statistics::Interval interval = statistics::mean_interval(sample->values);
      for (const double value : {mean(*sample), interval.low, interval.high})
        out += ',' + shortest(value);
    }
    for (const double value : {v.difference, v.low, v.high, v.margin, v.p_value, k_alpha_different})
      out += ',' + shortest(value);
    out += fmt::format(",{},{},{},{},{},{},{},{}\n", pair->judged.values.size(),
                       pair->reference.values.size(), pair->judged.without_value,
                       pair->reference.without_value, v.more_for_difference, v.more_for_same,
                       to_word(v.word), csv_text(verdict_sentence(*pair)));
  }
  return out;
}

std::string ensemble_values_csv(const Ensembles& ensembles) {
  std::string out = "scene,subject,ensemble,number,unit,start,value\n";
  const auto add = [&](const EnsemblePair& pair, const StartSample& sample) {
    for (std::size_t i = 0; i < sample.values.size(); ++i) {
      out += fmt::format("{},{},{},{},{},{},{}\n", csv_text(pair.scene), csv_text(pair.subject),
                         csv_text(sample.label), csv_text(pair.number), csv_text(pair.unit),
                         sample.starts[i], shortest(sample.values[i]));
    }
  };
  for (auto pair = ensembles.pairs.begin(); pair != ensembles.pairs.end(); ++pair) {
    const bool is_known = std::any_of(ensembles.pairs.begin(), pair, [&](const EnsemblePair& p) {
      return p.scene == pair->scene && p.subject == pair->subject && p.number == pair->number;
    });
    if (!is_known) add(*pair, pair->reference);
    add(*pair, pair->judged);
  }
  return out;
}

std::string html_ensembles(const Ensembles& ensembles, Palette& palette,
                           const std::string& prefix) {
  if (ensembles.pairs.empty()) return "";
  std::string out = "<ul>\n";
  for (const std::string& line : ensemble_headline(ensembles))
    out += "<li>" + escape_markup(line) + "</li>\n";
  out += fmt::format(
      "</ul>\n<p>CSV: <a href=\"figures/{0}ensemble_verdicts.csv\">verdicts</a>, <a "
      "href=\"figures/{0}ensemble_values.csv\">values</a></p>\n",
      prefix);
  const auto distributions = distribution_figures(ensembles, palette, prefix);
  const auto fans = fan_figures(ensembles, palette, prefix);
  const Table table = ensemble_table(ensembles);
  if (!table.rows.empty()) out += html_table(table, palette);
  out += figures_html(distributions, "Distributions over the starts", false);
  return out + figures_html(fans, "Spread over time", true);
}

std::string markdown_ensembles(const Ensembles& ensembles, Palette& palette,
                               const std::string& prefix) {
  if (ensembles.pairs.empty()) return "";
  std::string out = "\n## Ensembles\n\n";
  for (const std::string& line : ensemble_headline(ensembles))
    out += "- " + markdown_cell(line) + '\n';
  const Table table = ensemble_table(ensembles);
  if (!table.rows.empty()) out += '\n' + to_markdown(table);
  const auto list = [&](const std::string& title, const std::vector<Figure>& figures) {
    if (figures.empty()) return;
    out += fmt::format("\n{}:\n\n", title);
    for (const Figure& figure : figures) {
      out += fmt::format("- [{}](figures/{}.svg)\n", markdown_cell(figure.title), figure.id);
    }
  };
  list("Distributions over the starts", distribution_figures(ensembles, palette, prefix));
  list("Spread over time", fan_figures(ensembles, palette, prefix));
  return out;
}

std::vector<OutputFile> ensemble_files(const Ensembles& ensembles, Palette& palette,
                                       const std::string& prefix) {
  if (ensembles.pairs.empty()) return {};
  std::vector<OutputFile> files = {
      {"figures/" + prefix + "ensemble_verdicts.csv", ensemble_verdicts_csv(ensembles)},
      {"figures/" + prefix + "ensemble_values.csv", ensemble_values_csv(ensembles)}};
  for (const Figure& figure : ensemble_figures(ensembles, palette, prefix)) {
    files.push_back({"figures/" + figure.id + ".svg", to_svg(figure, true)});
    files.push_back({"figures/" + figure.id + ".csv", to_csv(figure)});
  }
  return files;
}

}  // namespace brickbench
