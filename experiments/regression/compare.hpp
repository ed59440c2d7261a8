// Compares what was obtained with the references: one finding per record, worst first.
#pragma once

#include "experiments/regression/equivalence.hpp"
#include "experiments/regression/reference.hpp"

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
  double bound = 0.0;   // of |difference|; for distributions the level of p
  double factor = 0.0;  // how many times over the bound; for p-values bound / p
  double p_value = 1.0;
  bool identical = false;  // a distribution, bit for bit, start by start
  std::string message;     // one sentence with all of the above
};

struct ComparePlan {
  double alpha = 0.01;  // chance of any false "different" in the whole suite
  SequentialPlan sequential;
};

// All samples of the suite that are not identical stand in one family (Holm): what did not change
// by a bit cannot be rejected, and whether it did is decided by the change and not by chance. So
// many relabellings are drawn that the smallest p-value can reject in that family. `complete`:
// everything that the references hold was to be obtained, so that what is missing is a failure.
std::vector<Comparison> compare(const Suite& reference, const Suite& obtained,
                                const ComparePlan& plan, bool complete);

// Whether two numbers were compared: not of findings that say why there was nothing to compare.
bool is_compared(const Comparison& comparison);

// Whether the gate is red: a deviation, or something missing.
bool is_red(const Comparison& comparison);

std::string_view to_word(Finding finding);
std::string_view to_word(Trend trend);

}  // namespace brickbench::gate
