// Compares what was obtained with the references: one finding per record, worst first.
#pragma once

#include "experiments/regression/reference.hpp"
#include "experiments/statistics/equivalence.hpp"

namespace brickbench::gate {

enum class Finding {
  fine,            // within the bound, equal, identical or equivalent
  open,            // no difference found, equivalence not shown: more runs would tell
  not_comparable,  // a hash of another engine version, precision or platform
  flagged,         // the run, its reference or both are not to be trusted
  no_number,       // neither side has one: the outcome is the same
  deviation,
  missing,  // a reference that nothing was obtained for
  fresh,    // obtained, but no reference yet
};

enum class Trend { none, better, worse };

struct Comparison {
  std::string experiment;
  Record reference;
  Record obtained;
  Finding finding = Finding::fine;
  Trend trend = Trend::none;     // by the metric's good direction
  double reference_value = 0.0;  // for distributions the mean
  double obtained_value = 0.0;
  double difference = 0.0;
  double bound = 0.0;   // of |difference|; for distributions the threshold of p
  double factor = 0.0;  // how many times over the bound; for p-values bound / p
  double p_value = 1.0;
  bool identical = false;  // a distribution, bit for bit, start by start
  std::string message;     // one sentence with all of the above
};

// Levels of the questions about distributions. Each number of each experiment, engine and step is a
// family of its own, so that no verdict depends on what else was run.
struct ComparePlan {
  // Chance of a false "different" in one number, over all looks: a suite of 400 numbers raises a
  // false alarm in at most 1 % of the checks. Of references with 8 or 9 starts it is the least that
  // they can show, that of ranges which do not overlap.
  double alpha_different = 2.5e-5;
  double alpha_same = 0.05;  // chance of a false "same" in one number, over all looks
  // Sizes of the growing samples before the last, which is that of the reference. Each look spends
  // an equal share of both alphas, so that the chances hold however early one stops (Bonferroni
  // over the looks: safe under any dependence between them).
  std::vector<std::size_t> looks = {8, 16};
  statistics::PermutationPlan permutation = {};
};

// The levels of one look at samples of which the reference has `starts`; relabellings are so many
// that p can get below them.
statistics::LookPlan look_plan(const ComparePlan& plan, std::size_t starts);

// Without the shares of numbers that are there as counts of the same engine and axes
// (statistics::is_share_of): one measurement, told once.
Suite counted_once(const Suite& suite);

// `complete`: everything that the references hold was to be obtained, so that what is missing is a
// failure. Both are taken counted_once().
std::vector<Comparison> compare(const Suite& reference, const Suite& obtained,
                                const ComparePlan& plan, bool complete);

// Whether two numbers were compared: not of findings that say why there was nothing to compare.
bool is_compared(const Comparison& comparison);

// Whether the gate is red: a deviation, or something missing.
bool is_red(const Comparison& comparison);

std::string_view to_word(Finding finding);
std::string_view to_word(Trend trend);

}  // namespace brickbench::gate
