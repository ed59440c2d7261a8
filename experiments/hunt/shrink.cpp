#include "experiments/hunt/shrink.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "experiments/hunt/digits.hpp"

namespace brickbench::hunt {
namespace {

// One search; each of its moves returns whether it changed something.
class Search {
 public:
  Search(Shrunk& best, std::string_view oracle, std::vector<Parameter> parameters,
         const Judge& judge, std::size_t most_probes)
      : best_(best),
        oracle_(oracle),
        parameters_(std::move(parameters)),
        judge_(judge),
        most_probes_(most_probes) {}

  bool is_spent() const { return best_.probes >= most_probes_; }

  bool drop_knobs() {
    bool any = false;
    const KnobValues knobs = best_.trial.knobs;
    if (knobs.size() > 1) {
      Trial candidate = best_.trial;
      candidate.knobs.clear();
      if (accept(candidate)) return true;
    }
    for (const auto& [name, value] : knobs) {
      Trial candidate = best_.trial;
      candidate.knobs.erase(name);
      any = accept(candidate) || any;
    }
    return any;
  }

  // A count below its default stays: fewer bodies are worth more than one parameter less.
  bool drop_parameters() {
    Trial bare = best_.trial;
    for (const Parameter& parameter : parameters_) {
      if (!is_lowered_count(parameter)) bare.parameters.erase(parameter.name);
    }
    if (accept(bare)) return true;
    bool any = false;
    for (const Parameter& parameter : parameters_) {
      if (!best_.trial.parameters.contains(parameter.name)) continue;
      if (is_lowered_count(parameter)) continue;
      Trial candidate = best_.trial;
      candidate.parameters.erase(parameter.name);
      any = accept(candidate) || any;
    }
    return any;
  }

  bool lower_counts() {
    bool any = false;
    for (const Parameter& parameter : parameters_) {
      if (parameter.kind != ParameterKind::integer) continue;
      const double now = value_of(parameter);
      for (const double count : {1.0, 2.0, 3.0, std::floor(now / 2), now - 1}) {
        if (count < parameter.minimum || count >= now) continue;
        if (try_value(parameter, count)) {
          any = true;
          break;
        }
      }
    }
    return any;
  }

  // The breach's own step first: what comes after it is of no use.
  bool shorten() {
    bool any = false;
    const Breach* breach = best_.verdict.find(oracle_);
    const std::size_t at = breach == nullptr ? 0 : breach->step;
    for (const std::size_t steps : {at, best_.trial.steps / 2, at / 2, at / 4}) {
      if (steps < 1 || steps >= best_.trial.steps) continue;
      Trial candidate = best_.trial;
      candidate.steps = steps;
      any = accept(candidate) || any;
    }
    return any;
  }

  bool round_step() {
    if (best_.trial.source == Source::exact_case) return false;
    constexpr std::array round_s = {1.0 / 60, 0.01, 1.0 / 240, 0.001, 1e-4};
    const double now_s = best_.trial.step_s;
    if (now_s == round_s.front()) return false;
    const double duration_s = now_s * static_cast<double>(best_.trial.steps);
    for (const double step_s : round_s) {
      const bool is_round = std::ranges::find(round_s, now_s) != round_s.end();
      if (step_s == now_s || (is_round && step_s < now_s)) continue;
      Trial candidate = best_.trial;
      candidate.step_s = step_s;
      candidate.steps = static_cast<std::size_t>(std::max(1.0, std::round(duration_s / step_s)));
      if (accept(candidate)) return true;
    }
    return false;
  }

  bool round_numbers() {
    bool any = false;
    for (const Parameter& parameter : parameters_) {
      if (parameter.kind != ParameterKind::number) continue;
      if (!best_.trial.parameters.contains(parameter.name)) continue;
      const double now = value_of(parameter);
      for (const double value : {0.0, 1.0, with_digits(now, 1), with_digits(now, 2)}) {
        if (value == now || value < parameter.minimum || value > parameter.maximum) continue;
        if (now == 0.0 || (now == 1.0 && value != 0.0)) break;
        if (try_value(parameter, value)) {
          any = true;
          break;
        }
      }
    }
    return any;
  }

 private:
  double value_of(const Parameter& parameter) const {
    const auto found = best_.trial.parameters.find(parameter.name);
    return std::get<double>(found == best_.trial.parameters.end() ? parameter.default_value
                                                                  : found->second);
  }

  bool is_lowered_count(const Parameter& parameter) const {
    return parameter.kind == ParameterKind::integer &&
           value_of(parameter) < std::get<double>(parameter.default_value);
  }

  bool try_value(const Parameter& parameter, double value) {
    Trial candidate = best_.trial;
    set_parameter(candidate, parameter, value);
    return accept(candidate);
  }

  bool accept(const Trial& candidate) {
    if (is_spent() || candidate == best_.trial) return false;
    ++best_.probes;
    Verdict verdict = judge_(candidate);
    if (verdict.is_told() || verdict.find(oracle_) == nullptr) return false;
    best_.trial = candidate;
    best_.verdict = std::move(verdict);
    return true;
  }

  Shrunk& best_;
  std::string_view oracle_;
  std::vector<Parameter> parameters_;
  const Judge& judge_;
  std::size_t most_probes_;
};

}  // namespace

Shrunk shrink(const Trial& trial, const Verdict& verdict, std::string_view oracle,
              const Catalogues& catalogues, const Judge& judge, std::size_t most_probes) {
  Shrunk best{trial, verdict, 0};
  Search search(best, oracle, parameters_of(trial, catalogues), judge, most_probes);
  bool any = true;
  while (any && !search.is_spent()) {
    any = search.shorten();
    any = search.drop_knobs() || any;
    any = search.drop_parameters() || any;
    any = search.lower_counts() || any;
    any = search.round_step() || any;
    any = search.round_numbers() || any;
  }
  return best;
}

}  // namespace brickbench::hunt
