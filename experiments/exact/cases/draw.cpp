#include "experiments/exact/cases/draw.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <random>

namespace brickbench::exact {
namespace {

constexpr double k_edge_share = 1.0 / 6.0;
constexpr double k_least_steps = 10.0;
constexpr double k_decade = 10.0;

// A generator of its own for every drawing: the sequence of std::seed_seq is prescribed.
std::mt19937_64 generator_of(const ExactCase& exact_case, std::uint64_t seed, std::size_t index) {
  std::vector<std::uint32_t> words = {static_cast<std::uint32_t>(seed),
                                      static_cast<std::uint32_t>(seed >> 32),
                                      static_cast<std::uint32_t>(index)};
  for (const char letter : exact_case.id) words.push_back(static_cast<std::uint8_t>(letter));
  std::seed_seq sequence(words.begin(), words.end());
  return std::mt19937_64(sequence);
}

double unit(std::mt19937_64& generator) { return static_cast<double>(generator() >> 11) * 0x1p-53; }

double rounded(double value) {
  const std::string text = fmt::format("{:.{}g}", value, k_drawn_digits);
  double out = value;
  std::from_chars(text.data(), text.data() + text.size(), out);
  return out;
}

double spread(double low, double high, std::mt19937_64& generator) {
  const double share = unit(generator);
  if (low > 0.0 && high >= k_decade * low) return low * std::pow(high / low, share);
  return low + share * (high - low);
}

double drawn(const Parameter& parameter, double low, double high, std::mt19937_64& generator) {
  low = std::max(low, parameter.minimum);
  high = std::max(low, std::min(high, parameter.maximum));
  const double edge = unit(generator);
  double value = spread(low, high, generator);
  if (edge < k_edge_share) value = low;
  if (edge > 1.0 - k_edge_share) value = high;
  if (parameter.kind == ParameterKind::integer) value = std::round(value);
  return std::clamp(rounded(value), parameter.minimum, parameter.maximum);
}

const Parameter& named(const ExactCase& exact_case, std::string_view name) {
  return *std::ranges::find(exact_case.parameters, name, &Parameter::name);
}

// With this step and the other values as given.
double duration_of(const ExactCase& exact_case, ParameterValues values, double step_s) {
  values["step_s"] = step_s;
  return value_of(complete(exact_case, values).value(), "duration_s");
}

}  // namespace

ParameterValues draw(const ExactCase& exact_case, std::uint64_t seed, std::size_t index) {
  std::mt19937_64 generator = generator_of(exact_case, seed, index);
  ParameterValues values;
  for (const Parameter& parameter : exact_case.parameters) {
    if (parameter.name == "step_s" || parameter.name == "duration_s") continue;
    values[parameter.name] = drawn(parameter, parameter.minimum, parameter.maximum, generator);
  }
  const Parameter& step = named(exact_case, "step_s");
  const Parameter& duration = named(exact_case, "duration_s");
  double duration_s = value_of(complete(exact_case, values).value(), "duration_s");
  if (exact_case.own_time_s == nullptr) {
    duration_s = drawn(duration, 0.5 * duration_s, 2.0 * duration_s, generator);
    values["duration_s"] = duration_s;
  }
  double least_s = step.minimum, most_s = step.maximum;
  const bool counts_steps =
      duration_of(exact_case, values, least_s) != duration_of(exact_case, values, most_s);
  if (!counts_steps) {
    ParameterValues all = complete(exact_case, values).value();
    const auto bodies = static_cast<double>(exact_case.make(all).world.bodies.size());
    least_s = duration_s * bodies / k_most_body_steps;
    most_s = duration_s / k_least_steps;
  }
  values["step_s"] = drawn(step, least_s, most_s, generator);
  return values;
}

}  // namespace brickbench::exact
