// Figures: the rows and curves of a run as plots.
#pragma once

#include <vector>

#include "reports/src/figure.hpp"
#include "reports/src/palette.hpp"
#include "reports/src/report_source.hpp"

namespace brickbench {

// One figure per scene and curve of series.csv; of several seeds the lowest is drawn.
std::vector<Figure> figures_over_time(const ReportSource& source, Palette& palette);

// Where a scene was run with several steps: each number that should be small against the step, with
// the order (slope of a least-squares line through the logarithms) in the legend and the range over
// the seeds as a band.
std::vector<Figure> figures_against_step(const ReportSource& source, Palette& palette);

// Each number that should be small against CPU seconds per simulated second: the first of each
// metric. The caption names those that no other beats in both.
std::vector<Figure> figures_against_cost(const ReportSource& source, Palette& palette);

}  // namespace brickbench
