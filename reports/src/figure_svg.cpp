#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "reports/src/figure.hpp"
#include "reports/src/markup.hpp"
#include "reports/src/palette.hpp"

namespace brickbench {
namespace {

constexpr double k_width = 720.0;
constexpr double k_left = 84.0;
constexpr double k_right = 18.0;
constexpr double k_top = 34.0;
constexpr double k_plot_height = 300.0;
constexpr double k_bottom = 48.0;
constexpr double k_legend_row = 18.0;
constexpr std::size_t k_legend_columns = 2;

// A range of data mapped linearly or by logarithm onto pixels.
struct Scale {
  bool logarithmic = false;
  double low = 0.0;  // of the value, or of its decadic logarithm
  double high = 1.0;
  double from_px = 0.0;
  double to_px = 1.0;

  double inner(double value) const { return logarithmic ? std::log10(value) : value; }
  bool shows(double value) const { return std::isfinite(value) && (!logarithmic || value > 0.0); }
  double px(double value) const {
    return from_px + (inner(value) - low) / (high - low) * (to_px - from_px);
  }
};

class Range {
 public:
  void add(double inner) {
    low_ = std::min(low_, inner);
    high_ = std::max(high_, inner);
  }
  // Widened where it is empty or a single point.
  void finish(Scale& scale) const {
    if (low_ > high_) return;
    const double pad = high_ > low_ ? 0.03 * (high_ - low_)
                                    : (scale.logarithmic ? 0.5 : std::max(std::abs(low_), 1.0) / 2);
    scale.low = low_ - pad;
    scale.high = high_ + pad;
  }

 private:
  double low_ = std::numeric_limits<double>::infinity();
  double high_ = -std::numeric_limits<double>::infinity();
};

void fit(const Figure& figure, Scale& x, Scale& y) {
  Range xs;
  Range ys;
  for (const Curve& curve : figure.curves) {
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      if (!x.shows(curve.x[i]) || !y.shows(curve.y[i])) continue;
      xs.add(x.inner(curve.x[i]));
      ys.add(y.inner(curve.y[i]));
      if (curve.low.empty()) continue;
      if (y.shows(curve.low[i])) ys.add(y.inner(curve.low[i]));
      if (y.shows(curve.high[i])) ys.add(y.inner(curve.high[i]));
    }
  }
  xs.finish(x);
  ys.finish(y);
}

struct Tick {
  double value;
  std::string text;
};

// 1, 2 or 5 times a power of ten, so that about `wanted` steps fit.
double nice_step(double span, double wanted) {
  const double raw = span / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw) return factor * power;
  }
  return 10.0 * power;
}

std::vector<Tick> ticks(const Scale& scale) {
  std::vector<Tick> out;
  const double span = scale.high - scale.low;
  const bool decades = scale.logarithmic && span >= 1.0;
  if (scale.logarithmic && !decades) {
    // Less than a decade: nice numbers between the ends.
    const double low = std::pow(10.0, scale.low);
    const double high = std::pow(10.0, scale.high);
    const double step = nice_step(high - low, 5.0);
    for (double v = std::ceil(low / step) * step; v <= high; v += step) {
      if (v > 0.0) out.push_back({v, fmt::format("{:.4g}", v)});
    }
    return out;
  }
  const double step = decades ? std::max(1.0, std::ceil(span / 8.0)) : nice_step(span, 6.0);
  for (double at = std::ceil(scale.low / step); at * step <= scale.high; at += 1.0) {
    const double value = at * step;
    if (decades)
      out.push_back({std::pow(10.0, value), fmt::format("1e{:.0f}", value)});
    else
      out.push_back({value, fmt::format("{:.6g}", std::abs(value) < 1e-9 * span ? 0.0 : value)});
  }
  return out;
}

std::string axes(const Figure& figure, const Scale& x, const Scale& y) {
  std::string out;
  for (const Tick& tick : ticks(x)) {
    const double at = x.px(tick.value);
    out += fmt::format(
        "<line class=\"grid\" x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{0:.1f}\" y2=\"{2:.1f}\"/>"
        "<text x=\"{0:.1f}\" y=\"{3:.1f}\" text-anchor=\"middle\">{4}</text>\n",
        at, y.to_px, y.from_px, y.from_px + 16.0, tick.text);
  }
  for (const Tick& tick : ticks(y)) {
    const double at = y.px(tick.value);
    out += fmt::format(
        "<line class=\"grid\" x1=\"{1:.1f}\" y1=\"{0:.1f}\" x2=\"{2:.1f}\" y2=\"{0:.1f}\"/>"
        "<text x=\"{3:.1f}\" y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>\n",
        at, x.from_px, x.to_px, x.from_px - 6.0, at + 4.0, tick.text);
  }
  const double middle_px = (y.from_px + y.to_px) / 2;
  out += fmt::format(
      "<rect class=\"frame\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>\n"
      "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n"
      "<text transform=\"translate(16 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n"
      "<text class=\"title\" x=\"{:.1f}\" y=\"20\">{}</text>\n",
      x.from_px, y.to_px, x.to_px - x.from_px, y.from_px - y.to_px, (x.from_px + x.to_px) / 2,
      y.from_px + 36.0, escape_markup(figure.x.text()), middle_px, escape_markup(figure.y.text()),
      x.from_px, escape_markup(figure.title));
  return out;
}

// One of four shapes around a point.
std::string marker(std::size_t kind, double x, double y) {
  switch (kind % 4) {
    case 0:
      return fmt::format("M{:.1f} {:.1f}a4 4 0 1 0 8 0a4 4 0 1 0 -8 0", x - 4, y);
    case 1:
      return fmt::format("M{:.1f} {:.1f}h7v7h-7z", x - 3.5, y - 3.5);
    case 2:
      return fmt::format("M{:.1f} {:.1f}l4.5 8h-9z", x, y - 5);
    default:
      return fmt::format("M{:.1f} {:.1f}l5 5l-5 5l-5 -5z", x, y - 5);
  }
}

std::string band(const Curve& curve, const Scale& x, const Scale& y) {
  if (curve.low.empty()) return "";
  std::string there;
  std::string back;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (!x.shows(curve.x[i]) || !y.shows(curve.low[i]) || !y.shows(curve.high[i])) continue;
    there += fmt::format("{:.1f},{:.1f} ", x.px(curve.x[i]), y.px(curve.high[i]));
    back.insert(0, fmt::format("{:.1f},{:.1f} ", x.px(curve.x[i]), y.px(curve.low[i])));
  }
  if (there.empty()) return "";
  return fmt::format("<polygon points=\"{}{}\" fill=\"{}\" opacity=\"0.15\"/>\n", there, back,
                     palette_colour(curve.colour));
}

// A cross where a curve stops to be trusted.
std::string flag_cross(double x, double y, const std::string& colour) {
  return fmt::format(
      "<path class=\"flag\" d=\"M{:.1f} {:.1f}l10 10m0 -10l-10 10\" fill=\"none\" stroke=\"{}\" "
      "stroke-width=\"2.5\"/>\n",
      x - 5, y - 5, colour);
}

std::string drawn(const Figure& figure, const Curve& curve, const Scale& x, const Scale& y) {
  std::string line;
  std::string marks;
  std::string cross;
  const std::size_t flagged = curve.first_flagged();
  bool pen_down = false;
  const std::string colour = palette_colour(curve.colour);
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (!x.shows(curve.x[i]) || !y.shows(curve.y[i])) {
      pen_down = false;
      continue;
    }
    const double px = x.px(curve.x[i]);
    const double py = y.px(curve.y[i]);
    line += fmt::format("{}{:.1f} {:.1f}", pen_down ? 'L' : 'M', px, py);
    pen_down = true;
    if (cross.empty() && i >= flagged) cross = flag_cross(px, py, colour);
    if (figure.markers) marks += marker(curve.colour, px, py);
  }
  if (line.empty()) return "";
  std::string out = band(curve, x, y);
  if (curve.flagged_from) out += "<g opacity=\"0.45\">";
  if (figure.lines) {
    out += fmt::format(
        "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\" stroke-dasharray=\"{}\"/>"
        "\n",
        line, colour, palette_dash(curve.colour));
  }
  if (!marks.empty()) out += fmt::format("<path d=\"{}\" fill=\"{}\"/>\n", marks, colour);
  if (curve.flagged_from) out += "</g>\n";
  return out + cross;
}

std::string legend(const Figure& figure, double top) {
  std::string out;
  const double column_px = (k_width - k_left - k_right) / k_legend_columns;
  for (std::size_t i = 0; i < figure.curves.size(); ++i) {
    const Curve& curve = figure.curves[i];
    const double x = k_left + column_px * static_cast<double>(i % k_legend_columns);
    const double y = top + k_legend_row * static_cast<double>(i / k_legend_columns);
    out += fmt::format(
        "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" "
        "stroke-width=\"2.5\" stroke-dasharray=\"{}\"/>",
        x, y, x + 26, y, palette_colour(curve.colour), palette_dash(curve.colour));
    if (figure.markers) {
      out += fmt::format("<path d=\"{}\" fill=\"{}\"/>", marker(curve.colour, x + 13, y),
                         palette_colour(curve.colour));
    }
    out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", x + 32, y + 4,
                       escape_markup(curve.legend()));
  }
  return out;
}

}  // namespace

std::string to_svg(const Figure& figure, bool standalone) {
  const double bottom_px = k_top + k_plot_height;
  Scale x{figure.x.logarithmic, 0.0, 1.0, k_left, k_width - k_right};
  Scale y{figure.y.logarithmic, 0.0, 1.0, bottom_px, k_top};
  fit(figure, x, y);
  const std::size_t rows = (figure.curves.size() + k_legend_columns - 1) / k_legend_columns;
  const double height = bottom_px + k_bottom + k_legend_row * static_cast<double>(rows) + 6.0;
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" "
      "font-family=\"sans-serif\" font-size=\"12\"{}>\n<title>{}</title>\n",
      k_width, height, standalone ? " color=\"#222222\"" : "", escape_markup(figure.title));
  out +=
      "<style>text{fill:currentColor}.title{font-size:14px;font-weight:600}"
      ".grid{stroke:currentColor;opacity:.13}.frame{fill:none;stroke:currentColor;opacity:.5}"
      "</style>\n";
  if (standalone) out += "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  out += axes(figure, x, y);
  for (const Curve& curve : figure.curves) out += drawn(figure, curve, x, y);
  return out + legend(figure, bottom_px + k_bottom + 6.0) + "</svg>\n";
}

}  // namespace brickbench
