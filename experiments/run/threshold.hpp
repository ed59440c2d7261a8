// Where something begins: the value of one parameter at which a condition on a run's numbers turns,
// found by bisection.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/run/cell.hpp"
#include "experiments/run/run_cell.hpp"

namespace brickbench {

struct ThresholdQuestion {
  Cell cell;              // everything but the parameter; its metrics hold what `until` names
  std::string parameter;  // a number of the scene
  double low = 0.0;       // the ends of the search, low < high
  double high = 1.0;
  bool whole = false;  // only whole numbers are tried
  Condition until;     // of the numbers of the metrics, and of the word `outcome`
  // The bracket is narrowed to this share of its first width; whole numbers to 1.
  double width = 1e-3;
};

// One run of the search.
struct ThresholdTrial {
  double value = 0.0;
  bool held = false;
  std::string outcome;
  std::string validity;
};

struct ThresholdAnswer {
  std::string outcome = "ok";  // or why there is none
  std::string reason;
  // The condition differs between these two, and the search did not look between them.
  double low = 0.0;
  double high = 0.0;
  bool held_at_high = true;            // and so not at low
  std::vector<ThresholdTrial> trials;  // in their order
  double cpu_s = 0.0;                  // of the engine
  std::size_t flagged = 0;             // trials whose numbers are not to be trusted
};

// Called after each trial with the share of the search that is done.
using ThresholdProgress = std::function<void(const ThresholdTrial& trial, double share)>;

// `outcome` of the answer: "no_change" where the condition is the same at both ends, the run's own
// where one ends otherwise than ok and the condition does not speak of `outcome`. The condition
// need not be monotone: the answer is one place where it turns.
ThresholdAnswer find_threshold(const ThresholdQuestion& question, const Catalogues& catalogues,
                               const Origin& origin, const ThresholdProgress& progress = {});

// The metrics that a condition needs, of all that there are; InputError for a name that no metric
// yields.
struct ThresholdCondition {
  Condition condition;
  std::vector<std::string> metrics;
};
Checked<ThresholdCondition> threshold_condition(const std::string& text, const std::string& option,
                                                const Catalogues& catalogues);

}  // namespace brickbench
