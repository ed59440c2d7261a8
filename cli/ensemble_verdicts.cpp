#include "cli/ensemble_verdicts.hpp"

#include <cmath>

#include "experiments/statistics/equivalence.hpp"

namespace brickbench {
namespace {

EnsembleWord word_of(statistics::Verdict verdict) {
  switch (verdict) {
    case statistics::Verdict::identical:
      return EnsembleWord::identical;
    case statistics::Verdict::same:
      return EnsembleWord::same;
    case statistics::Verdict::different:
      return EnsembleWord::different;
    case statistics::Verdict::not_enough_runs:
      return EnsembleWord::not_enough_runs;
  }
  return EnsembleWord::untested;
}

}  // namespace

void judge(Ensembles& ensembles) {
  const statistics::LookPlan plan{.level_different = k_alpha_different, .level_same = k_alpha_same};
  for (EnsemblePair& pair : ensembles.pairs) {
    EnsembleVerdict& verdict = pair.verdict;
    const double mean = statistics::moments(pair.reference.values).mean;
    verdict.margin = k_equivalence_share * std::abs(mean);
    const statistics::Look look =
        statistics::look_at(pair.reference.values, pair.judged.values, verdict.margin, plan);
    verdict.word = word_of(look.verdict);
    verdict.p_value = look.test.p_value;
    verdict.difference = look.mean.difference;
    verdict.low = look.mean.low;
    verdict.high = look.mean.high;
    verdict.more_for_difference = look.more_for_difference;
    verdict.more_for_same = look.more_for_same;
  }
}

}  // namespace brickbench
