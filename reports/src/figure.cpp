#include "reports/src/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/record/schema.hpp"
#include "reports/src/palette.hpp"

namespace brickbench {
namespace {

std::string csv_text(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '\n' || c == '\r')
      out += ' ';
    else
      out += c == '"' ? std::string("\"\"") : std::string(1, c);
  }
  return out + '"';
}

std::string gnuplot_text(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\n' || c == '\r')
      out += ' ';
    else
      out += c == '\'' ? std::string("''") : std::string(1, c);
  }
  return out + '\'';
}

// " dashtype (7,3)"; "" for a solid line.
std::string gnuplot_dash(std::size_t colour) {
  std::string dash = palette_dash(colour);
  if (dash.empty()) return "";
  std::ranges::replace(dash, ' ', ',');
  return " dashtype (" + dash + ')';
}

nlohmann::ordered_json rounded(const std::vector<double>& values) {
  auto array = nlohmann::ordered_json::array();
  for (const double value : values) {
    if (std::isfinite(value))
      array.push_back(std::stod(fmt::format("{:.7g}", value)));
    else
      array.push_back(nullptr);
  }
  return array;
}

}  // namespace

std::string Curve::legend() const {
  if (flagged_from) return label + " !";
  return note.empty() ? label : label + ", " + note;
}

std::size_t Curve::first_flagged() const {
  if (!flagged_from) return x.size();
  const auto first = std::ranges::find_if(x, [&](double at) { return at >= *flagged_from; });
  return static_cast<std::size_t>(first - x.begin());
}

std::string FigureAxis::text() const {
  return unit == "1" ? label : fmt::format("{} ({})", label, unit);
}

std::string file_id(const std::string& text) {
  std::string id;
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '_' || c == '-';
    if (plain)
      id += c;
    else if (id.empty() || id.back() != '-')
      id += '-';
  }
  if (id.size() > k_longest_id) {
    id = id.substr(0, k_longest_id / 2 - 1) + "--" + id.substr(id.size() - k_longest_id / 2 + 1);
  }
  return id.empty() ? "figure" : id;
}

std::size_t hidden_points(const Figure& figure) {
  std::size_t hidden = 0;
  for (const Curve& curve : figure.curves) {
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      const bool hides_x = figure.x.logarithmic && !(curve.x[i] > 0.0);
      const bool hides_y = figure.y.logarithmic && !(curve.y[i] > 0.0);
      if (hides_x || hides_y) ++hidden;
    }
  }
  return hidden;
}

std::string to_csv(const Figure& figure) {
  std::string out = fmt::format("curve,{},{},low,high,flagged\n", csv_text(figure.x.text()),
                                csv_text(figure.y.text()));
  for (const Curve& curve : figure.curves) {
    const std::string label = csv_text(curve.label);
    const std::size_t flagged = curve.first_flagged();
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      const bool band = !curve.low.empty();
      out += fmt::format("{},{},{},{},{},{}\n", label, shortest(curve.x[i]), shortest(curve.y[i]),
                         band ? shortest(curve.low[i]) : "", band ? shortest(curve.high[i]) : "",
                         i < flagged ? 0 : 1);
    }
  }
  return out;
}

std::string to_gnuplot(const Figure& figure, const std::string& data, const std::string& pdf) {
  std::string out = fmt::format(
      "set terminal pdfcairo noenhanced size 12cm,8cm font 'DejaVu Sans,8'\nset output {}\n"
      "set datafile separator comma\nset title {}\nset xlabel {}\nset ylabel {}\n"
      "set key outside below\nset grid\n",
      gnuplot_text(pdf), gnuplot_text(figure.title), gnuplot_text(figure.x.text()),
      gnuplot_text(figure.y.text()));
  if (figure.x.logarithmic) out += "set logscale x\n";
  if (figure.y.logarithmic) out += "set logscale y\n";
  const char* style = figure.lines ? (figure.markers ? "linespoints" : "lines") : "points";
  std::string plots;
  std::size_t first = 1;  // line of the file, after the header
  for (const Curve& curve : figure.curves) {
    if (curve.x.empty()) continue;
    const std::string rows =
        fmt::format("{} every ::{}::{}", gnuplot_text(data), first, first + curve.x.size() - 1);
    const std::string colour = palette_colour(curve.colour);
    plots += plots.empty() ? "plot " : ", \\\n  ";
    if (!curve.low.empty()) {
      plots += fmt::format(
          "{} using 2:4:5 with filledcurves fillcolor rgb '{}' fillstyle transparent solid 0.15 "
          "noborder notitle, \\\n  ",
          rows, colour);
    }
    // Faint where the run is flagged.
    std::string look = fmt::format("{} linecolor rgb '{}{}'", style,
                                   curve.flagged_from ? "#90" : "#", colour.substr(1));
    if (figure.lines) look += gnuplot_dash(curve.colour);
    if (figure.markers || !figure.lines)
      look += fmt::format(" pointtype {}", 4 + curve.colour % 10);
    plots += fmt::format("{} using 2:3 with {} title {}", rows, look, gnuplot_text(curve.legend()));
    first += curve.x.size();
  }
  return out + plots + '\n';
}

nlohmann::ordered_json to_json(const Figure& figure) {
  auto curves = nlohmann::ordered_json::array();
  for (const Curve& curve : figure.curves) {
    nlohmann::ordered_json json = {{"label", curve.label},
                                   {"legend", curve.legend()},
                                   {"colour", palette_colour(curve.colour)},
                                   {"dash", palette_dash(curve.colour)},
                                   {"marker", curve.colour},
                                   {"x", rounded(curve.x)},
                                   {"y", rounded(curve.y)}};
    if (curve.flagged_from) json["flagged_from"] = *curve.flagged_from;
    if (!curve.low.empty()) {
      json["low"] = rounded(curve.low);
      json["high"] = rounded(curve.high);
    }
    curves.push_back(std::move(json));
  }
  return {{"id", figure.id},
          {"title", figure.heading.empty() ? figure.title : figure.heading},
          {"scene", figure.scene},
          {"x", {{"text", figure.x.text()}, {"log", figure.x.logarithmic}}},
          {"y", {{"text", figure.y.text()}, {"log", figure.y.logarithmic}}},
          {"over_time", figure.over_time},
          {"lines", figure.lines},
          {"markers", figure.markers},
          {"curves", curves}};
}

}  // namespace brickbench
