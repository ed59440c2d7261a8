// Figure: curves with axes. The same value becomes SVG, CSV, gnuplot input and the interactive plot
// of the page.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace brickbench {

struct Curve {
  std::string label;
  std::size_t colour = 0;  // index into the palette
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> low;   // empty, or a band as long as y
  std::vector<double> high;  // empty, or as long as y
  std::string note;          // shown after the label in the legend: "order 1.02"
  // Where a run is flagged: from this x on it is not to be trusted; the curve is drawn faint, with
  // a cross there; the caption says why.
  std::optional<double> flagged_from = {};

  // The first of its points that is flagged; x.size() if none is.
  std::size_t first_flagged() const;
  // What the legend says: "bee/v, order 1.02"; "bee/v !" where the run is flagged.
  std::string legend() const;
};

struct FigureAxis {
  std::string label;
  std::string unit;  // "1" for pure numbers
  bool logarithmic = false;

  // "penetration_m (m)"
  std::string text() const;
};

struct Figure {
  std::string id;       // a file name: [a-z0-9_-]+
  std::string title;    // what is seen
  std::string scene;    // label of the scene, or of the scene without its step; may be empty
  std::string heading;  // the title on a page that groups by scene; empty: the title
  std::string caption;  // may be empty
  FigureAxis x;
  FigureAxis y;
  bool over_time = false;  // x is the replay's time
  bool lines = true;
  bool markers = false;
  std::vector<Curve> curves;
};

// File systems take names of 255 bytes; what is longer than this keeps its beginning and its end.
inline constexpr std::size_t k_longest_id = 140;

// Characters other than letters, digits, '_' and '-' become '-'; never empty.
std::string file_id(const std::string& text);

// Points that a logarithmic axis cannot show.
std::size_t hidden_points(const Figure& figure);

// Byte-stable. A standalone file has its own background and text colour; otherwise both are the
// page's.
std::string to_svg(const Figure& figure, bool standalone);

// curve,x,y,low,high,flagged with the axes' names as header; shortest numbers that read back
// exactly. flagged: 1 for points that are not to be trusted.
std::string to_csv(const Figure& figure);

// A gnuplot script that draws `data` (the figure's CSV) into `pdf`.
std::string to_gnuplot(const Figure& figure, const std::string& data, const std::string& pdf);

// For the page: seven significant digits.
nlohmann::ordered_json to_json(const Figure& figure);

}  // namespace brickbench
