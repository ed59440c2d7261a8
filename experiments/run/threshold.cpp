#include "experiments/run/threshold.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace brickbench {
namespace {

bool speaks_of_outcome(const Condition& condition) {
  return std::ranges::find(condition, "outcome", &Term::name) != condition.end();
}

// What the rows of a run say, by the names of their numbers.
ParameterValues numbers_of(const CellResult& result) {
  ParameterValues values;
  for (const Row& row : result.rows) {
    if (row.value) values.insert_or_assign(row.metric, *row.value);
  }
  values.insert_or_assign("outcome", result.outcome);
  return values;
}

// The name of a number of the condition that the run did not yield; "" if it has all.
std::string missing_in(const Condition& condition, const ParameterValues& values) {
  for (const Term& term : condition) {
    if (!values.contains(term.name)) return term.name;
  }
  return {};
}

class ThresholdSearch {
 public:
  ThresholdSearch(const ThresholdQuestion& question, const Catalogues& catalogues,
                  const Origin& origin, const ThresholdProgress& progress)
      : question_(question), catalogues_(catalogues), origin_(origin), progress_(progress) {}

  ThresholdAnswer run() {
    answer_.low = question_.low;
    answer_.high = question_.high;
    const bool low = holds_at(question_.low, 0.0);
    if (answer_.outcome != "ok") return answer_;
    answer_.held_at_high = holds_at(question_.high, 0.0);
    if (answer_.outcome != "ok") return answer_;
    if (low == answer_.held_at_high) {
      answer_.outcome = "no_change";
      answer_.reason =
          fmt::format("the condition {} at both ends", low ? "holds" : "does not hold");
      return answer_;
    }
    while (answer_.outcome == "ok") {
      const double middle = next();
      if (!(middle > answer_.low && middle < answer_.high)) break;
      if (question_.whole ? answer_.high - answer_.low <= 1.0
                          : answer_.high - answer_.low <= smallest_width()) {
        break;
      }
      const bool held = holds_at(middle, share());
      if (answer_.outcome != "ok") break;
      (held == answer_.held_at_high ? answer_.high : answer_.low) = middle;
    }
    return answer_;
  }

 private:
  double smallest_width() const { return question_.width * (question_.high - question_.low); }

  double next() const {
    const double middle = answer_.low + 0.5 * (answer_.high - answer_.low);
    return question_.whole ? std::floor(middle) : middle;
  }

  double share() const {
    const double target = question_.whole ? 1.0 : smallest_width();
    const double all = std::log((question_.high - question_.low) / target);
    const double done = std::log((question_.high - question_.low) / (answer_.high - answer_.low));
    return all > 0.0 ? std::clamp(done / all, 0.0, 1.0) : 1.0;
  }

  bool holds_at(double value, double share) {
    Cell cell = question_.cell;
    cell.parameters[question_.parameter] = value;
    const CellResult result = run_cell(cell, catalogues_, origin_);
    answer_.cpu_s += result.timing.steps_total_cpu_s;
    const ParameterValues numbers = numbers_of(result);
    const bool held = holds(question_.until, numbers);
    answer_.trials.push_back({value, held, result.outcome, result.validity});
    if (!result.validity.empty()) ++answer_.flagged;
    if (progress_) progress_(answer_.trials.back(), share);
    if (speaks_of_outcome(question_.until)) return held;
    const std::string missing = missing_in(question_.until, numbers);
    if (result.outcome != "ok") {
      answer_.outcome = result.outcome;
      answer_.reason = fmt::format("at {} = {}: {}", question_.parameter, value, result.reason);
    } else if (!missing.empty()) {
      answer_.outcome = "not_applicable";
      answer_.reason =
          fmt::format("at {} = {} the run has no {}", question_.parameter, value, missing);
    }
    return held;
  }

  const ThresholdQuestion& question_;
  const Catalogues& catalogues_;
  const Origin& origin_;
  const ThresholdProgress& progress_;
  ThresholdAnswer answer_;
};

}  // namespace

ThresholdAnswer find_threshold(const ThresholdQuestion& question, const Catalogues& catalogues,
                               const Origin& origin, const ThresholdProgress& progress) {
  return ThresholdSearch(question, catalogues, origin, progress).run();
}

Checked<ThresholdCondition> threshold_condition(const std::string& text, const std::string& option,
                                                const Catalogues& catalogues) {
  std::vector<std::string> known = {"outcome"};
  for (const MetricInfo& metric : catalogues.metrics) {
    for (const OutputInfo& output : metric.outputs) known.push_back(output.name);
  }
  try {
    ThresholdCondition result;
    result.condition = parse_condition(text, {option, 0, 0}, known);
    for (const MetricInfo& metric : catalogues.metrics) {
      const bool needed = std::ranges::any_of(metric.outputs, [&](const OutputInfo& output) {
        return std::ranges::find(result.condition, output.name, &Term::name) !=
               result.condition.end();
      });
      if (needed) result.metrics.push_back(metric.name);
    }
    return result;
  } catch (const InputError& error) {
    return tl::unexpected(error);
  }
}

}  // namespace brickbench
