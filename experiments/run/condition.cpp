#include "experiments/run/condition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>

#include "experiments/record/schema.hpp"

namespace brickbench {
namespace {

struct Operator {
  std::string_view text;
  Relation relation;
};
constexpr std::array<Operator, 6> k_operators = {{{"<", Relation::less},
                                                  {"<=", Relation::at_most},
                                                  {">", Relation::greater},
                                                  {">=", Relation::at_least},
                                                  {"==", Relation::equal},
                                                  {"!=", Relation::unequal}}};

Term parse_term(const std::vector<std::string>& words, const std::string& text,
                const SourcePosition& at, const std::vector<std::string>& known) {
  const auto op = words.size() == 3 ? std::ranges::find(k_operators, words[1], &Operator::text)
                                    : k_operators.end();
  if (op == k_operators.end()) {
    reject(at, fmt::format("'{}' is not of the form: name op value [and name op value]..., op one "
                           "of < <= > >= == !=, with spaces between",
                           text));
  }
  if (std::ranges::find(known, words[0]) == known.end()) {
    reject(at,
           fmt::format("'{}': no quantity '{}'{}", text, words[0], known_names(words[0], known)));
  }
  const auto number = parse_number(words[2]);
  return {words[0], op->relation, number ? ParameterValue(*number) : ParameterValue(words[2])};
}

bool compare(double a, Relation relation, double b) {
  switch (relation) {
    case Relation::less:
      return a < b;
    case Relation::at_most:
      return a <= b;
    case Relation::greater:
      return a > b;
    case Relation::at_least:
      return a >= b;
    case Relation::equal:
      return a == b;
    case Relation::unequal:
      return a != b;
  }
  return false;
}

bool holds(const Term& term, const ParameterValue& value) {
  const auto* a = std::get_if<double>(&value);
  const auto* b = std::get_if<double>(&term.value);
  if (a != nullptr && b != nullptr) return compare(*a, term.relation, *b);
  return term.relation == Relation::equal     ? value == term.value
         : term.relation == Relation::unequal ? value != term.value
                                              : false;
}

}  // namespace

Condition parse_condition(const std::string& text, const SourcePosition& at,
                          const std::vector<std::string>& known) {
  Condition condition;
  std::istringstream stream(text + " and");
  std::vector<std::string> words;
  for (std::string word; stream >> word;) {
    if (word != "and") {
      words.push_back(word);
      continue;
    }
    condition.push_back(parse_term(words, text, at, known));
    words.clear();
  }
  return condition;
}

bool holds(const Condition& condition, const ParameterValues& values) {
  return std::ranges::all_of(condition, [&](const Term& term) {
    const auto found = values.find(term.name);
    return found != values.end() && holds(term, found->second);
  });
}

}  // namespace brickbench
