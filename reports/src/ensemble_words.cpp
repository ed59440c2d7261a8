#include "reports/src/ensemble_words.hpp"

#include <fmt/format.h>

#include "experiments/statistics/bootstrap.hpp"
#include "reports/src/summary.hpp"

namespace brickbench {
namespace {

std::string difference_sentence(const EnsemblePair& pair) {
  const std::string judged = name_of(pair, pair.judged);
  const std::string reference = name_of(pair, pair.reference);
  const double difference = pair.verdict.difference;
  if (difference == 0.0) {
    return fmt::format("different: {} and {} scatter differently", judged, reference);
  }
  const std::string_view side = pair.better == "neither" ? ""
                                : is_worse(pair)         ? " (worse)"
                                                         : " (better)";
  return fmt::format("different: {} has {} than {}{}", judged, difference > 0.0 ? "more" : "less",
                     reference, side);
}

std::string open_sentence(const EnsemblePair& pair) {
  const EnsembleVerdict& v = pair.verdict;
  std::string text =
      fmt::format("open: a difference of this size would be shown by {} more runs of each",
                  runs_wanted(v.more_for_difference));
  if (v.margin > 0.0) {
    return text + fmt::format(", 'same within {}' by {}", percent_text(k_equivalence_share),
                              runs_wanted(v.more_for_same));
  }
  return text + fmt::format("; nothing shows 'same', for the mean of {} is zero",
                            name_of(pair, pair.reference));
}

}  // namespace

std::string_view to_word(EnsembleWord word) {
  switch (word) {
    case EnsembleWord::untested:
      return "not_tested";
    case EnsembleWord::identical:
      return "identical";
    case EnsembleWord::same:
      return "same";
    case EnsembleWord::different:
      return "different";
    case EnsembleWord::not_enough_runs:
      return "open";
  }
  return "not_tested";
}

std::string name_of(const EnsemblePair& pair, const StartSample& sample) {
  return pair.subject.empty() ? sample.label : pair.subject + " in " + sample.label;
}

std::string verdict_sentence(const EnsemblePair& pair) {
  switch (pair.verdict.word) {
    case EnsembleWord::untested:
      return "not tested";
    case EnsembleWord::identical:
      return fmt::format("{} and {} are identical", name_of(pair, pair.judged),
                         name_of(pair, pair.reference));
    case EnsembleWord::same:
      return fmt::format("{} and {} are the same within {}", name_of(pair, pair.judged),
                         name_of(pair, pair.reference), percent_text(k_equivalence_share));
    case EnsembleWord::different:
      return difference_sentence(pair);
    case EnsembleWord::not_enough_runs:
      return open_sentence(pair);
  }
  return "";
}

bool is_worse(const EnsemblePair& pair) {
  if (pair.verdict.word != EnsembleWord::different) return false;
  return pair.better == "lower" ? pair.verdict.difference > 0.0
                                : pair.better == "higher" && pair.verdict.difference < 0.0;
}

std::string runs_wanted(std::size_t more) {
  constexpr std::size_t k_nobody_runs = 10000;
  return more > k_nobody_runs ? fmt::format("over {}", k_nobody_runs) : fmt::format("{}", more);
}

std::string percent_text(double share) { return fmt::format("{:.3g} %", 100.0 * share); }

std::string mean_text(const StartSample& sample) {
  const statistics::Interval interval = statistics::mean_interval(sample.values);
  return fmt::format("{} [{} .. {}]", short_number(statistics::moments(sample.values).mean),
                     short_number(interval.low), short_number(interval.high));
}

}  // namespace brickbench
