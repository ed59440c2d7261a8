// The report of ensembles: verdicts as tables, distributions and fans as figures.
#pragma once

#include <string>
#include <vector>

#include "reports/src/ensembles.hpp"
#include "reports/src/figure.hpp"
#include "reports/src/html_report.hpp"
#include "reports/src/palette.hpp"
#include "reports/src/table.hpp"

namespace brickbench {

// What the verdicts are, how many of each there are, and how many runs they rest on; sentences.
std::vector<std::string> ensemble_headline(const Ensembles& ensembles);

// One row per pair that is not identical: different first, then open ones, the smallest p first.
Table ensemble_table(const Ensembles& ensembles);

// Empirical distribution functions, side by side: one figure per scene, subject and number in which
// not all samples are identical; the smallest p first. Ids begin with `prefix`.
std::vector<Figure> distribution_figures(const Ensembles& ensembles, Palette& palette,
                                         const std::string& prefix);

// Medians with the band from 5 to 95 % and the middle half; more than three in one picture have the
// middle half alone.
std::vector<Figure> fan_figures(const Ensembles& ensembles, Palette& palette,
                                const std::string& prefix);

// Both.
std::vector<Figure> ensemble_figures(const Ensembles& ensembles, Palette& palette,
                                     const std::string& prefix);

// One line per pair: means, difference, interval, margin, p, runs and verdict.
std::string ensemble_verdicts_csv(const Ensembles& ensembles);
// One line per value: what the verdicts and the figures rest on.
std::string ensemble_values_csv(const Ensembles& ensembles);

// "" without pairs. Figures are drawn in the page; their files lie in figures/.
std::string html_ensembles(const Ensembles& ensembles, Palette& palette, const std::string& prefix);
std::string markdown_ensembles(const Ensembles& ensembles, Palette& palette,
                               const std::string& prefix);

// figures/<id>.svg and .csv of every figure, figures/<prefix>ensemble_verdicts.csv and
// figures/<prefix>ensemble_values.csv; empty without pairs.
std::vector<OutputFile> ensemble_files(const Ensembles& ensembles, Palette& palette,
                                       const std::string& prefix);

}  // namespace brickbench
