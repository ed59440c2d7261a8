#include "experiments/hunt/knobs.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/hunt/dice.hpp"
#include "experiments/hunt/digits.hpp"

namespace brickbench::hunt {
namespace {

constexpr double k_turned_share = 0.12;  // of the trials
constexpr double k_factor = 10.0;
// Up to this many values, all are as likely: switches and choices.
constexpr double k_few = 8.0;

double draw_value(Dice& dice, const Knob& knob) {
  if (knob.whole && knob.max - knob.min < k_few) {
    return std::floor(dice.uniform(knob.min, knob.max + 1.0));
  }
  const double size = knob.engine_default == 0.0 ? 1.0 : std::abs(knob.engine_default);
  const double low = std::max(knob.min, knob.engine_default < 0.0 ? -k_factor * size : 0.0);
  const double high = std::min(knob.max, std::max(low, k_factor * size));
  const bool by_decades = low >= 0.0 && high > k_factor * low;
  const double drawn = by_decades ? dice.decades(std::max(low, high / (k_factor * k_factor)), high)
                                  : dice.uniform(low, high);
  const double value = knob.whole ? std::round(drawn) : with_digits(drawn, 2);
  return std::clamp(value, knob.min, knob.max);
}

}  // namespace

void draw_knob(Trial& trial, const Catalogues& catalogues, std::uint64_t seed,
               std::uint64_t case_number) {
  const Adapter* adapter = find_adapter(catalogues, trial.engine.engine);
  Dice dice({seed, case_number}, trial.engine.label());
  if (adapter == nullptr || adapter->knobs.empty() || !dice.chance(k_turned_share)) return;
  const Knob& knob = adapter->knobs[dice.below(adapter->knobs.size())];
  // A variant that lacks the knob refuses it.
  trial.knobs[knob.name] = draw_value(dice, knob);
}

}  // namespace brickbench::hunt
