// A figure for a paper: one number against one setting, grouped and faceted, with intervals and the
// runs behind them.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adapters/seam/failure.hpp"
#include "reports/src/cell_table.hpp"

namespace brickbench {

enum class ErrorBars { interval, range, none };

struct FigureAsk {
  std::string y;
  std::string x = "step_s";
  std::string facet;                                       // empty: one panel
  std::string group = "engine";                            // one curve each
  std::vector<std::pair<std::string, std::string>> where;  // setting = value, as the table has it
  std::vector<std::string> engines;                        // labels; empty: all
  ErrorBars error = ErrorBars::interval;
  bool log_x = false;
  bool log_y = false;
};

struct PaperPoint {
  double x = 0.0;
  double mean = 0.0;
  double low = 0.0;  // of the error bar; equal to the mean where there is none
  double high = 0.0;
  std::vector<double> runs;
};

struct PaperCurve {
  std::string group;
  std::size_t style = 0;  // the same for equal groups in all panels
  std::vector<PaperPoint> points;
};

struct PaperPanel {
  std::string facet;  // the value; empty without facets
  std::vector<PaperCurve> curves;
};

// What stands beside an axis: "Deepest penetration / mm"; values are multiplied by `factor`.
struct PaperAxis {
  std::string label;
  double factor = 1.0;
  bool logarithmic = false;
};

struct PaperFigure {
  PaperAxis x;
  PaperAxis y;
  std::vector<std::string> categories;  // of an x of words: the names of 1, 2 ...
  std::string facet_label;
  std::vector<std::string> groups;  // in the order of styles
  std::vector<PaperPanel> panels;
  std::string caption;  // what points, bars and dots are, and what was left out
};

// More curves than this nobody tells apart.
inline constexpr std::size_t k_most_styles = 8;

// Names that --x, --facet, --group and --where may have.
std::vector<std::string> setting_names(const CellTable& table);

// Fault::invalid where nothing is left, where cells differ in a setting that is none of those asked
// for (they would be averaged together), where there are too many groups, or where a logarithmic
// axis has values that are not positive.
Expected<PaperFigure> paper_figure(const CellTable& table, const FigureAsk& ask);

// "Deepest penetration / mm" of penetration_max_m in m, with the factor for values up to `largest`.
PaperAxis paper_axis(const std::string& name, const std::string& unit, double largest);

// facet, group, x, mean, low, high, runs: the points as drawn, in SI units.
std::string to_csv(const PaperFigure& figure);

enum class PaperFormat { pdf, svg, png };

// A gnuplot script that draws into `file`. Width in cm; the height follows from the panels.
std::string to_gnuplot(const PaperFigure& figure, PaperFormat format, const std::string& file,
                       double width_cm);

}  // namespace brickbench
