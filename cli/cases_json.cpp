#include "cli/cases_json.hpp"

#include "experiments/exact/cases/exact_case.hpp"

namespace brickbench {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> needs_words(const exact::Needs& needs) {
  std::vector<std::string> words;
  if (needs.contacts == exact::Contacts::one) words.emplace_back("one contact");
  if (needs.contacts == exact::Contacts::several) words.emplace_back("contacts");
  if (needs.spheres) words.emplace_back("spheres");
  if (needs.friction) words.emplace_back("friction");
  if (needs.restitution) words.emplace_back("restitution");
  if (needs.contact_forces) words.emplace_back("contact forces");
  if (needs.applied_forces) words.emplace_back("applied forces");
  return words;
}

}  // namespace

Json cases_json() {
  auto array = Json::array();
  for (const exact::ExactCase& exact_case : exact::exact_cases()) {
    auto parameters = Json::array();
    for (const Parameter& parameter : exact_case.parameters) {
      parameters.push_back(
          {{"id", parameter.name},
           {"unit", parameter.unit},
           {"kind", parameter.kind == ParameterKind::integer ? "integer" : "number"},
           {"default", std::get<double>(parameter.default_value)},
           {"minimum", parameter.minimum},
           {"maximum", parameter.maximum},
           {"meaning", parameter.meaning}});
    }
    auto outputs = Json::array();
    for (const exact::Observable& observable : exact_case.observables) {
      outputs.push_back(
          {{"id", observable.name}, {"unit", observable.unit}, {"meaning", observable.meaning}});
    }
    array.push_back({{"id", exact_case.id},
                     {"title", exact_case.title},
                     {"meaning", exact_case.claim},
                     {"formula", exact_case.formula},
                     {"source", exact_case.source},
                     {"needs", needs_words(exact_case.needs)},
                     {"expected_violation", exact_case.expected_violation},
                     {"threshold", exact_case.threshold ? exact_case.threshold->parameter : ""},
                     {"parameters", parameters},
                     {"outputs", outputs}});
  }
  return array;
}

}  // namespace brickbench
