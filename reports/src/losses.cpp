#include "reports/src/losses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brickbench {
namespace {

// The best of the contenders that `belongs` accepts in number n; none if none has a value.
template <typename Belongs>
std::optional<std::size_t> best_of(const Block& block, std::size_t n, const Belongs& belongs) {
  const bool lower = block.numbers[n].better == "lower";
  std::optional<std::size_t> best;
  for (std::size_t c = 0; c < block.contenders.size(); ++c) {
    if (!block.scores[c][n].is_valid() || !belongs(block.contenders[c])) continue;
    const auto& mean = block.scores[c][n].mean;
    const double so_far = best ? *block.scores[*best][n].mean : 0.0;
    if (!best || (lower ? *mean < so_far : *mean > so_far)) best = c;
  }
  return best;
}

// Whether each side has a value, valid or not: then flags alone keep them from being compared.
template <typename IsOwn>
bool is_kept_by_flags(const Block& block, std::size_t n, const IsOwn& is_own) {
  bool ours = false;
  bool others = false;
  for (std::size_t c = 0; c < block.contenders.size(); ++c) {
    if (!block.scores[c][n].mean) continue;
    (is_own(block.contenders[c]) ? ours : others) = true;
  }
  return ours && others;
}

double severity(const Loss& loss) {
  if (loss.rounding) return -1.0;
  if (!loss.ratio || *loss.ratio <= 0.0) return std::numeric_limits<double>::infinity();
  return std::abs(std::log(*loss.ratio));
}

}  // namespace

std::vector<std::string> own_engines(const Provenance& provenance) {
  std::vector<std::string> names;
  for (const EngineRecord& engine : provenance.engines) {
    if (engine.own) names.push_back(engine.name);
  }
  return names;
}

std::optional<std::size_t> best_of_own(const Block& block, std::size_t n,
                                       std::span<const std::string> own) {
  return best_of(block, n, [&](const Contender& contender) {
    return std::ranges::find(own, contender.engine) != own.end();
  });
}

LossTable losses(std::span<const Block> blocks, std::span<const std::string> own) {
  const auto is_own = [&](const Contender& contender) {
    return std::ranges::find(own, contender.engine) != own.end();
  };
  LossTable table;
  for (const Block& block : blocks) {
    for (std::size_t n = 0; n < block.numbers.size(); ++n) {
      if (block.numbers[n].better == "neither") continue;
      const auto ours = best_of_own(block, n, own);
      const auto other = best_of(block, n, [&](const Contender& c) { return !is_own(c); });
      if (!ours || !other) {
        table.flagged += is_kept_by_flags(block, n, is_own) ? 1U : 0U;
        continue;
      }
      ++table.compared;
      const double a = *block.scores[*ours][n].mean;
      const double b = *block.scores[*other][n].mean;
      if (block.numbers[n].better == "lower" ? a <= b : a >= b) continue;
      Loss loss{block.numbers[n].name,
                scene_label(block),
                block.contenders[*ours].label(),
                a,
                block.contenders[*other].label(),
                b,
                {},
                false};
      if (b != 0.0) loss.ratio = a / b;
      loss.rounding = std::abs(a - b) <= k_rounding;
      table.rounding += loss.rounding ? 1U : 0U;
      table.rows.push_back(std::move(loss));
    }
  }
  std::ranges::stable_sort(table.rows, std::greater{}, severity);
  return table;
}

}  // namespace brickbench
