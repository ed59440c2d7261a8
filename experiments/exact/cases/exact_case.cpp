#include "experiments/exact/cases/exact_case.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "adapters/seam/unit.hpp"

namespace brickbench::exact {

Parameter real(std::string name, std::string unit, double default_value, double minimum,
               double maximum, std::string meaning) {
  Parameter parameter;
  parameter.name = std::move(name);
  parameter.unit = std::move(unit);
  parameter.default_value = default_value;
  parameter.minimum = minimum;
  parameter.maximum = maximum;
  parameter.meaning = std::move(meaning);
  return parameter;
}

std::vector<Parameter> with_time(std::vector<Parameter> own, double step_s, double duration_s) {
  own.push_back(real("step_s", "s", step_s, 1e-6, 0.1, "time step"));
  own.push_back(real("duration_s", "s", duration_s, 1e-6, 1e4, "simulated time"));
  return own;
}

namespace {

void follow_own_time(const ExactCase& exact_case, ParameterValues& values) {
  ParameterValues defaults;
  for (const Parameter& parameter : exact_case.parameters) {
    defaults[parameter.name] = parameter.default_value;
  }
  const double share = exact_case.own_time_s(values) / exact_case.own_time_s(defaults);
  const double wanted_s = share * value_of(defaults, "duration_s");
  const auto duration = std::ranges::find(exact_case.parameters, "duration_s", &Parameter::name);
  values["duration_s"] = std::clamp(wanted_s, duration->minimum, duration->maximum);
}

}  // namespace

Expected<ParameterValues> complete(const ExactCase& exact_case, const ParameterValues& given) {
  ParameterValues values;
  for (const Parameter& parameter : exact_case.parameters) {
    values[parameter.name] = parameter.default_value;
  }
  for (const auto& [name, value] : given) {
    const auto found = std::ranges::find(exact_case.parameters, name, &Parameter::name);
    if (found == exact_case.parameters.end()) {
      return fail(Fault::invalid,
                  fmt::format("case {} has no parameter '{}'", exact_case.id, name));
    }
    const double* number = std::get_if<double>(&value);
    if (number == nullptr || !(*number >= found->minimum && *number <= found->maximum)) {
      return fail(Fault::invalid,
                  fmt::format("case {}: {} must be a number in {} .. {}{}", exact_case.id, name,
                              found->minimum, found->maximum, unit_suffix(found->unit)));
    }
    values[name] = *number;
  }
  if (exact_case.own_time_s != nullptr && !given.contains("duration_s")) {
    follow_own_time(exact_case, values);
  }
  return values;
}

double value_of(const ParameterValues& values, std::string_view name) {
  return std::get<double>(values.find(name)->second);
}

Expected<ExactRun> build(const ExactCase& exact_case, const ParameterValues& given) {
  auto values = complete(exact_case, given);
  if (!values) return tl::unexpected(values.error());
  if (exact_case.outside != nullptr) {
    if (const std::string why = exact_case.outside(*values); !why.empty()) {
      return fail(Fault::invalid, fmt::format("case {} says nothing where {}", exact_case.id, why));
    }
  }
  ExactRun run = exact_case.make(*values);
  if (auto ok = validate(run.world); !ok) return tl::unexpected(ok.error());
  return run;
}

Recorder::Recorder(const ExactRun& run, std::size_t observables)
    : measure_(run.measure), values_(observables, std::numeric_limits<double>::quiet_NaN()) {}

}  // namespace brickbench::exact
