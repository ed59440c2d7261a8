#include "experiments/hunt/codec.hpp"

#include <cmath>
#include <limits>

namespace brickbench::hunt {
namespace {

constexpr const char* k_scenario = "scenario";
constexpr const char* k_exact_case = "exact_case";

// Numbers beyond the finite are words in JSON.
Json number_json(double x) {
  return std::isfinite(x) ? Json(x) : Json(std::isnan(x) ? "nan" : "inf");
}

double number_of(const Json& json) {
  if (json.is_number()) return json.get<double>();
  const bool infinite = json.get<std::string>() == "inf";
  return infinite ? std::numeric_limits<double>::infinity()
                  : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

Json to_json(const Trial& trial) {
  auto parameters = Json::object();
  for (const auto& [name, value] : trial.parameters) {
    std::visit([&, &name = name](const auto& plain) { parameters[name] = plain; }, value);
  }
  auto knobs = Json::object();
  for (const auto& [name, value] : trial.knobs) knobs[name] = value;
  return {{"source", trial.source == Source::scenario ? k_scenario : k_exact_case},
          {"scene", trial.scene},
          {"engine", trial.engine.engine},
          {"variant", trial.engine.variant},
          {"step_s", trial.step_s},
          {"steps", trial.steps},
          {"parameters", parameters},
          {"knobs", knobs}};
}

Json to_json(const Breach& breach) {
  return {{"oracle", breach.oracle},
          {"observed", number_json(breach.observed)},
          {"allowed", number_json(breach.allowed)},
          {"unit", breach.unit},
          {"step", breach.step},
          {"time_s", breach.time_s},
          {"bodies", breach.bodies}};
}

Json to_json(const Verdict& verdict) {
  auto breaches = Json::array();
  for (const Breach& breach : verdict.breaches) breaches.push_back(to_json(breach));
  constexpr std::size_t k_longest = 300;
  return {{"outcome", verdict.outcome},
          {"reason", verdict.reason.substr(0, k_longest)},
          {"breaches", breaches}};
}

Json to_json(const Shrunk& shrunk) {
  return {{"trial", to_json(shrunk.trial)},
          {"verdict", to_json(shrunk.verdict)},
          {"probes", shrunk.probes}};
}

Trial trial_of(const Json& json) {
  Trial trial;
  const bool scenario = json.at("source").get<std::string>() == k_scenario;
  trial.source = scenario ? Source::scenario : Source::exact_case;
  trial.scene = json.at("scene").get<std::string>();
  trial.engine = {json.at("engine").get<std::string>(), json.at("variant").get<std::string>()};
  trial.step_s = json.at("step_s").get<double>();
  trial.steps = json.at("steps").get<std::size_t>();
  for (const auto& [name, value] : json.at("parameters").items()) {
    if (value.is_string()) {
      trial.parameters[name] = value.get<std::string>();
    } else {
      trial.parameters[name] = value.get<double>();
    }
  }
  for (const auto& [name, value] : json.at("knobs").items()) {
    trial.knobs[name] = value.get<double>();
  }
  return trial;
}

Verdict verdict_of(const Json& json) {
  Verdict verdict;
  verdict.outcome = json.at("outcome").get<std::string>();
  verdict.reason = json.at("reason").get<std::string>();
  for (const Json& item : json.at("breaches")) {
    verdict.breaches.push_back({item.at("oracle").get<std::string>(),
                                number_of(item.at("observed")), number_of(item.at("allowed")),
                                item.at("unit").get<std::string>(),
                                item.at("step").get<std::size_t>(), item.at("time_s").get<double>(),
                                item.at("bodies").get<std::string>()});
  }
  return verdict;
}

Shrunk shrunk_of(const Json& json) {
  return {trial_of(json.at("trial")), verdict_of(json.at("verdict")),
          json.at("probes").get<std::size_t>()};
}

}  // namespace brickbench::hunt
