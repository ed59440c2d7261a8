// A paper figure as CSV and as a gnuplot script.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "experiments/record/csv_text.hpp"
#include "experiments/record/schema.hpp"
#include "reports/src/palette.hpp"
#include "reports/src/paper_figure.hpp"

namespace brickbench {
namespace {

constexpr double k_panel_height_cm = 5.2;
constexpr double k_key_line_cm = 0.42;
constexpr double k_left_cm = 1.55;
constexpr double k_right_cm = 0.25;
constexpr double k_below_cm = 1.15;
constexpr double k_above_cm = 0.55;
constexpr double k_widest_in_a_row_cm = 6.0;
constexpr std::array<int, k_most_styles> k_points = {7, 5, 9, 11, 13, 6, 4, 8};
constexpr std::size_t k_most_own_ticks = 8;

// For gnuplot's enhanced text, in single quotes.
std::string paper_text(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') {
      out += "''";
    } else if (std::string_view("_^{}@&~\\").find(c) != std::string_view::npos) {
      out += std::string("\\") + c;
    } else {
      out += c;
    }
  }
  return out + "'";
}

std::string block_name(std::size_t panel, std::size_t curve, const char* what) {
  return fmt::format("$panel{}_{}_{}", panel, curve, what);
}

void add_data(const PaperFigure& figure, std::string& out) {
  for (std::size_t p = 0; p < figure.panels.size(); ++p) {
    for (std::size_t c = 0; c < figure.panels[p].curves.size(); ++c) {
      std::string points;
      std::string runs;
      for (const PaperPoint& point : figure.panels[p].curves[c].points) {
        const std::string x = shortest(point.x * figure.x.factor);
        points += fmt::format("{} {} {} {}\n", x, shortest(point.mean * figure.y.factor),
                              shortest(point.low * figure.y.factor),
                              shortest(point.high * figure.y.factor));
        for (const double run : point.runs)
          runs += fmt::format("{} {}\n", x, shortest(run * figure.y.factor));
      }
      out += fmt::format("{} << EOD\n{}EOD\n{} << EOD\n{}EOD\n", block_name(p, c, "points"), points,
                         block_name(p, c, "runs"), runs);
    }
  }
}

// Ticks at the very values where these are few: decades would miss most of them.
std::string x_ticks(const PaperFigure& figure) {
  if (!figure.categories.empty()) {
    std::string ticks;
    for (std::size_t i = 0; i < figure.categories.size(); ++i) {
      ticks += fmt::format("{}{} {}", i == 0 ? "" : ", ", paper_text(figure.categories[i]), i + 1);
    }
    return fmt::format("set xtics ({}) nomirror\nset xrange [0.5:{}.5]\n", ticks,
                       figure.categories.size());
  }
  std::set<double> values;
  for (const PaperPanel& panel : figure.panels) {
    for (const PaperCurve& curve : panel.curves) {
      for (const PaperPoint& point : curve.points) values.insert(point.x * figure.x.factor);
    }
  }
  if (values.size() > k_most_own_ticks) return "set xtics nomirror\n";
  std::string ticks;
  for (const double value : values)
    ticks += fmt::format("{}'{:.3g}' {}", ticks.empty() ? "" : ", ", value, shortest(value));
  std::string out = fmt::format("set xtics ({}) nomirror\n", ticks);
  const double low = *values.begin();
  const double high = *values.rbegin();
  if (low == high)
    return out + fmt::format("set xrange [{}:{}]\n", 0.5 * low - 0.5, 1.5 * low + 0.5);
  const double rim = 0.05 * (high - low);
  return out +
         (figure.x.logarithmic
              ? fmt::format("set xrange [{}:{}]\n", shortest(low / 1.2), shortest(high * 1.2))
              : fmt::format("set xrange [{}:{}]\n", shortest(low - rim), shortest(high + rim)));
}

std::string terminal(PaperFormat format, double width_cm, double height_cm) {
  constexpr double k_px_per_cm = 300.0 / 2.54;
  constexpr double k_svg_px_per_cm = 96.0 / 2.54;
  switch (format) {
    case PaperFormat::pdf:
      return fmt::format(
          "set terminal pdfcairo enhanced size {:.2f}cm,{:.2f}cm font 'DejaVu Sans,7'\n", width_cm,
          height_cm);
    case PaperFormat::svg:
      return fmt::format(
          "set terminal svg enhanced size {:.0f},{:.0f} font 'DejaVu Sans,9' background "
          "'#ffffff'\n",
          width_cm * k_svg_px_per_cm, height_cm * k_svg_px_per_cm);
    case PaperFormat::png:
      return fmt::format(
          "set terminal pngcairo enhanced size {:.0f},{:.0f} font 'DejaVu Sans,7' "
          "fontscale 3.125 linewidth 3 pointscale 3\n",
          width_cm * k_px_per_cm, height_cm * k_px_per_cm);
  }
  return "";
}

// Dots, then bars, then the line with its points; only the last has a place in the key.
std::string plots_of(const PaperPanel& panel, std::size_t p) {
  std::string plots;
  const auto add = [&](const std::string& text) {
    plots += (plots.empty() ? "plot " : ", \\\n  ") + text;
  };
  for (std::size_t c = 0; c < panel.curves.size(); ++c) {
    const std::string colour = palette_colour(panel.curves[c].style).substr(1);
    add(fmt::format(
        "{} using 1:2 with points pointtype 7 pointsize 0.15 linecolor rgb '#b0{}' notitle",
        block_name(p, c, "runs"), colour));
    add(
        fmt::format("{} using 1:2:3:4 with yerrorbars pointsize 0 linewidth 1 linecolor rgb '#{}' "
                    "notitle",
                    block_name(p, c, "points"), colour));
    std::string dash = palette_dash(panel.curves[c].style);
    std::ranges::replace(dash, ' ', ',');
    add(fmt::format(
        "{} using 1:2 with linespoints pointtype {} pointsize 0.5 linewidth 1.5{} linecolor "
        "rgb '#{}' title {}",
        block_name(p, c, "points"), k_points[panel.curves[c].style],
        dash.empty() ? "" : " dashtype (" + dash + ')', colour, paper_text(panel.curves[c].group)));
  }
  return plots + '\n';
}

}  // namespace

std::string to_csv(const PaperFigure& figure) {
  std::string out = "facet,group,x,mean,low,high,runs\n";
  for (const PaperPanel& panel : figure.panels) {
    for (const PaperCurve& curve : panel.curves) {
      for (const PaperPoint& point : curve.points) {
        const std::string x =
            figure.categories.empty()
                ? shortest(point.x)
                : csv_field(figure.categories[static_cast<std::size_t>(point.x) - 1]);
        out += fmt::format("{},{},{},{},{},{},{}\n", csv_field(panel.facet), csv_field(curve.group),
                           x, shortest(point.mean), shortest(point.low), shortest(point.high),
                           point.runs.size());
      }
    }
  }
  return out;
}

std::string to_gnuplot(const PaperFigure& figure, PaperFormat format, const std::string& file,
                       double width_cm) {
  const std::size_t count = figure.panels.size();
  const auto fitting = static_cast<std::size_t>(std::max(1.0, width_cm / k_widest_in_a_row_cm));
  const std::size_t columns = std::min(count, fitting);
  const std::size_t rows = (count + columns - 1) / columns;
  // The key stands above all panels, as many groups a line as their longest name lets.
  std::size_t longest = 1;
  for (const std::string& group : figure.groups) longest = std::max(longest, group.size());
  const double entry_cm = 1.1 + 0.15 * static_cast<double>(longest);
  const auto per_line = static_cast<std::size_t>(std::max(1.0, (width_cm - 0.5) / entry_cm));
  const std::size_t key_lines = (figure.groups.size() + per_line - 1) / per_line;
  const double key_cm = 0.2 + k_key_line_cm * static_cast<double>(key_lines);
  const double height_cm = key_cm + k_panel_height_cm * static_cast<double>(rows);
  std::string out = terminal(format, width_cm, height_cm);
  out += fmt::format("set output {}\n", paper_text(file));
  add_data(figure, out);
  out +=
      "set multiplot\nset border 3\nset grid linecolor rgb '#e0e0e0' linewidth 0.5\n"
      "set tics scale 0.5\n";
  if (figure.x.logarithmic) out += "set logscale x\n";
  out +=
      figure.y.logarithmic ? "set logscale y\nset format y '10^{%L}'\n" : "set format y '%.4g'\n";
  out += x_ticks(figure) +
         "set ytics nomirror\nset offsets graph 0, graph 0, graph 0.05, graph 0.05\n";
  for (std::size_t p = 0; p < count; ++p) {
    const double panel_cm = width_cm / static_cast<double>(columns);
    const double left = panel_cm * static_cast<double>(p % columns);
    const double top = height_cm - key_cm - k_panel_height_cm * static_cast<double>(p / columns);
    out += fmt::format(
        "set lmargin at screen {:.4f}\nset rmargin at screen {:.4f}\nset tmargin at screen {:.4f}\n"
        "set bmargin at screen {:.4f}\n",
        (left + k_left_cm) / width_cm, (left + panel_cm - k_right_cm) / width_cm,
        (top - k_above_cm) / height_cm, (top - k_panel_height_cm + k_below_cm) / height_cm);
    const PaperPanel& panel = figure.panels[p];
    out += figure.facet_label.empty()
               ? "unset title\n"
               : fmt::format("set title {} offset 0,-0.7\n",
                             paper_text(figure.facet_label + ": " + panel.facet));
    out += fmt::format("set xlabel {} offset 0,0.5\nset ylabel {} offset 0.3,0\nunset key\n",
                       paper_text(figure.x.label), paper_text(figure.y.label));
    out += plots_of(panel, p);
  }
  // The key of all groups: curves without a point in range, over the whole picture.
  out += fmt::format(
      "set lmargin at screen 0\nset rmargin at screen 1\nset tmargin at screen 1\nset bmargin at "
      "screen "
      "0\nunset title\nunset xlabel\nunset ylabel\nunset border\nunset tics\nunset grid\nunset "
      "logscale\nset xrange [0:1]\nset yrange [0:1]\nset offsets 0, 0, 0, 0\n"
      "set key at screen 0.5,{:.4f} center top horizontal maxcols {} samplen 2 Left reverse\n",
      1.0 - 0.1 / height_cm, per_line);
  std::string keys;
  for (std::size_t g = 0; g < figure.groups.size(); ++g) {
    std::string dash = palette_dash(g);
    std::ranges::replace(dash, ' ', ',');
    keys += fmt::format(
        "{}NaN with linespoints pointtype {} pointsize 0.5 linewidth 1.5{} linecolor rgb "
        "'{}' title {}",
        keys.empty() ? "plot " : ", \\\n  ", k_points[g],
        dash.empty() ? "" : " dashtype (" + dash + ')', palette_colour(g),
        paper_text(figure.groups[g]));
  }
  return out + keys + "\nunset multiplot\nunset output\n";
}

}  // namespace brickbench
