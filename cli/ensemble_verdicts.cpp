#include "cli/ensemble_verdicts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "experiments/regression/equivalence.hpp"

namespace brickbench {
namespace {

bool is_identical(const EnsemblePair& pair) {
  return pair.reference.values == pair.judged.values && pair.reference.starts == pair.judged.starts;
}

EnsembleVerdict verdict_of(const EnsemblePair& pair, const gate::PermutationPlan& plan) {
  const std::vector<double>& reference = pair.reference.values;
  const std::vector<double>& judged = pair.judged.values;
  EnsembleVerdict verdict;
  verdict.margin =
      k_equivalence_share * std::abs(std::accumulate(reference.begin(), reference.end(), 0.0) /
                                     static_cast<double>(reference.size()));
  if (is_identical(pair)) {
    verdict.word = EnsembleWord::identical;
    return verdict;
  }
  // A margin of zero shows no equivalence, whatever the spread.
  const double margin = std::max(verdict.margin, 1e-300);
  const gate::Equivalence means = gate::equivalence(reference, judged, margin, k_alpha_same);
  verdict.p_value = gate::energy_test(reference, judged, plan).p_value;
  verdict.difference = means.difference;
  verdict.low = means.low;
  verdict.high = means.high;
  if (verdict.margin > 0.0 && means.equivalent) {
    verdict.word = EnsembleWord::same;
    return verdict;
  }
  verdict.word = EnsembleWord::not_enough_runs;
  const std::size_t present = std::min(reference.size(), judged.size());
  if (verdict.margin > 0.0) {
    verdict.more_runs = means.runs_needed > present ? means.runs_needed - present : 1;
  }
  return verdict;
}

}  // namespace

void judge(Ensembles& ensembles) {
  const auto identical = std::ranges::count_if(ensembles.pairs, is_identical);
  gate::PermutationPlan plan;
  plan.permutations =
      gate::relabellings_for(ensembles.pairs.size() - static_cast<std::size_t>(identical),
                             k_alpha_different, plan.permutations);
  std::vector<EnsemblePair*> tested;
  std::vector<double> p_values;
  for (EnsemblePair& pair : ensembles.pairs) {
    pair.verdict = verdict_of(pair, plan);
    if (pair.verdict.word == EnsembleWord::identical) continue;
    tested.push_back(&pair);
    p_values.push_back(pair.verdict.p_value);
  }
  const std::vector<bool> rejected = gate::holm(p_values, k_alpha_different);
  for (std::size_t i = 0; i < tested.size(); ++i) {
    if (!rejected[i]) continue;
    tested[i]->verdict.word = EnsembleWord::different;
    tested[i]->verdict.more_runs = 0;
  }
}

}  // namespace brickbench
