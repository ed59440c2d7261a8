#include "experiments/hunt/draw.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "experiments/hunt/dice.hpp"
#include "experiments/hunt/digits.hpp"
#include "experiments/hunt/extent.hpp"

namespace brickbench::hunt {
namespace {

// Of a parameter that is drawn.
constexpr int k_digits = 4;

// A size between the ends, by decades: a range that begins at 0 is taken to span six of them.
double size_within(Dice& dice, double low, double high) {
  constexpr double k_decades = 1e-6;
  return dice.decades(std::max(low, high * k_decades), high);
}

// Within a factor of about 30 of the default; about 1 where that is 0.
double near_default(Dice& dice, double normal) {
  constexpr double k_spread = 30.0;
  const double size = normal == 0.0 ? 1.0 : std::abs(normal);
  return dice.decades(size / k_spread, size * k_spread);
}

double draw_number(Dice& dice, const Parameter& p) {
  const double low = p.minimum;
  const double high = p.maximum;
  const double normal = std::get<double>(p.default_value);
  if (dice.chance(0.2)) {
    const std::array edges = {0.0, 1.0, low, high, 0.0, 1.0};
    const double edge = edges[dice.below(edges.size())];
    return std::clamp(edge, low, high);
  }
  const bool both_signs = low < 0.0;
  const double sign = both_signs && dice.chance(0.5) ? -1.0 : 1.0;
  const bool narrow = low >= 0.0 && high <= 2.0;
  const double size = narrow              ? dice.uniform(low, high)
                      : dice.chance(0.65) ? near_default(dice, normal)
                                          : size_within(dice, std::max(low, 0.0), high);
  return std::clamp(sign * with_digits(size, k_digits), low, high);
}

// Small numbers are as likely as large ones: a fault in a crowd mostly lives in a few as well.
double draw_count(Dice& dice, const Parameter& p) {
  constexpr double k_crowd = 40.0;
  if (p.maximum > 1000.0) return std::floor(dice.uniform(p.minimum, p.maximum));  // seeds
  const double high = std::min(p.maximum, k_crowd);
  return std::clamp(std::floor(dice.decades(std::max(1.0, p.minimum), high + 0.999)), p.minimum,
                    p.maximum);
}

ParameterValue draw_value(Dice& dice, const Parameter& p) {
  switch (p.kind) {
    case ParameterKind::choice:
      return p.choices[dice.below(p.choices.size())];
    case ParameterKind::boolean:
      return dice.chance(0.5) ? 1.0 : 0.0;
    case ParameterKind::integer:
      return draw_count(dice, p);
    case ParameterKind::number:
      break;
  }
  return draw_number(dice, p);
}

double draw_step_s(Dice& dice) {
  constexpr std::array usual = {1.0 / 60, 1.0 / 100, 1.0 / 240, 0.001, 1.0 / 60, 0.002, 1e-4};
  if (dice.chance(0.8)) return usual[dice.below(usual.size())];
  return with_digits(dice.decades(1e-5, 0.016), k_digits);
}

// Long enough that what flies meets something, and something happens then.
std::size_t draw_steps(Dice& dice, const World& world, double step_s, const DrawLimits& limits) {
  double moving = 0.0;
  for (const Body& body : world.bodies) moving += body.fixed ? 0.0 : 1.0;
  const double most = std::min(static_cast<double>(limits.most_steps),
                               limits.body_steps / std::pow(std::max(moving, 1.0), 1.3));
  const double few = static_cast<double>(limits.fewest_steps);
  const double meeting = soonest_meeting_s(world) / step_s;
  const double after = dice.decades(few, std::max(few, most));
  const double steps = std::isfinite(meeting) ? std::ceil(meeting) + after : after;
  return static_cast<std::size_t>(std::clamp(std::round(steps), few, std::max(few, most)));
}

}  // namespace

std::optional<Trial> draw_scene(const std::vector<Scenario>& scenarios, std::uint64_t seed,
                                std::uint64_t number, const DrawLimits& limits) {
  constexpr int k_attempts = 100;
  Dice dice({seed, number}, "scene");
  for (int attempt = 0; attempt < k_attempts; ++attempt) {
    const Scenario& scenario = scenarios[dice.below(scenarios.size())];
    constexpr std::array k_calm = {0.0, 0.3, 0.6, 0.9};
    const double calm = k_calm[dice.below(k_calm.size())];
    Trial trial;
    trial.scene = scenario.name;
    for (const Parameter& parameter : scenario.parameters) {
      if (dice.chance(calm)) continue;
      set_parameter(trial, parameter, draw_value(dice, parameter));
    }
    trial.step_s = draw_step_s(dice);
    const auto scene = build(scenario, trial.parameters);
    if (!scene) continue;
    const auto moving = std::ranges::count(scene->world.bodies, false, &Body::fixed);
    if (static_cast<std::size_t>(moving) > limits.bodies) continue;
    trial.steps = draw_steps(dice, scene->world, trial.step_s, limits);
    return trial;
  }
  return std::nullopt;
}

Trial draw_case(const std::vector<std::string>& cases, std::uint64_t seed, std::uint64_t number) {
  constexpr double k_least = 0.7;
  constexpr double k_most = 1.4;
  Dice dice({seed, number}, "case");
  Trial trial;
  trial.source = Source::exact_case;
  trial.scene = cases[dice.below(cases.size())];
  for (const Parameter& parameter : parameters_of(trial, {})) {
    if (parameter.name == "step_s" || parameter.name == "duration_s" || dice.chance(0.3)) continue;
    const double normal = std::get<double>(parameter.default_value);
    const double drawn = with_digits(normal * dice.decades(k_least, k_most), k_digits);
    const double value = parameter.kind == ParameterKind::number ? drawn : std::round(drawn);
    set_parameter(trial, parameter, std::clamp(value, parameter.minimum, parameter.maximum));
  }
  return trial;
}

}  // namespace brickbench::hunt
