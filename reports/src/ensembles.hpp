// Ensembles: one number of many perturbed starts, beside the same number of something else: another
// engine, or the same engine before a change. From rows and curves alone; verdicts are passed in.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reports/src/report_source.hpp"

namespace brickbench {

// So many starts make an ensemble.
inline constexpr std::size_t k_least_starts = 8;
// Means are the same where they differ by less than this share of the reference's mean.
inline constexpr double k_equivalence_share = 0.05;
// Chance of a false "different", and of a false "same", in one number of one pair: each is a family
// of its own.
inline constexpr double k_alpha_different = 0.01;
inline constexpr double k_alpha_same = 0.05;

enum class EnsembleWord { untested, identical, same, different, not_enough_runs };

struct EnsembleVerdict {
  EnsembleWord word = EnsembleWord::untested;
  double p_value = 1.0;     // of one distribution
  double difference = 0.0;  // of the means, judged minus reference
  double low = 0.0;         // interval of the difference that the equivalence rests on
  double high = 0.0;
  double margin = 0.0;  // of equivalence, in the unit of the values; 0: none can be stated
  // With not_enough_runs: of each of the two, to show a difference of the size seen, and to show
  // that there is none beyond the margin.
  std::size_t more_for_difference = 0;
  std::size_t more_for_same = 0;
};

// The valid, finite values of one ensemble, in order of their starts.
struct StartSample {
  std::string label;  // of an engine, or of a folder
  std::vector<std::uint64_t> starts;
  std::vector<double> values;
  std::size_t without_value = 0;  // starts that ended without a finite number, or flagged
};

struct EnsemblePair {
  std::string scene;
  std::string subject;  // the engine where folders are compared; empty where engines are
  std::string number;
  std::string unit;
  std::string better;  // lower, higher or neither
  StartSample reference;
  StartSample judged;
  EnsembleVerdict verdict;
};

// The spread of a curve over the starts at each time.
struct Fan {
  std::string label;
  std::size_t runs = 0;
  std::vector<double> time_s;
  std::vector<double> q05, q25, median, q75, q95;
};

// Fans of one curve that belong into one picture.
struct FanGroup {
  std::string scene;
  std::string subject;
  std::string curve;
  std::string unit;
  std::vector<Fan> fans;
};

struct Ensembles {
  std::vector<EnsemblePair> pairs;
  std::vector<FanGroup> fans;
};

// Quantile of sorted values by linear interpolation between order statistics (Hyndman and Fan,
// Sample quantiles in statistical packages, American Statistician 50, 1996, definition 7).
double quantile(const std::vector<double>& sorted, double probability);

// Shares of numbers that are there as counts (statistics::is_share_of) are left out: one
// measurement is judged once.
//
// The engines of one folder against one of them: `reference` by label, or the first of each scene
// if it is empty or was not run there. Ensembles of fewer than k_least_starts are left out.
Ensembles ensembles_within(const ReportSource& source, const std::string& reference);

// Each engine of `b` against itself in `a`. Scenes are those of equal label; where an axis was set
// differently, those of the same experiment, if each folder has one.
Ensembles ensembles_between(const ReportSource& a, const ReportSource& b,
                            const std::string& label_a, const std::string& label_b);

}  // namespace brickbench
