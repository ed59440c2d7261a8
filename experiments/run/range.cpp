#include "experiments/run/range.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "experiments/record/schema.hpp"

namespace brickbench {
namespace {

constexpr double k_most_values = 1e6;

const InputValue& required(const InputValue& table, std::string_view name, const char* key) {
  const InputValue* value = table.find(key);
  if (value == nullptr) reject(table.at, fmt::format("the range of {} needs '{}'", name, key));
  return *value;
}

InputValue number_at(const SourcePosition& at, double number) {
  InputValue value;
  value.kind = number == std::floor(number) ? ValueKind::integer : ValueKind::number;
  value.at = at;
  value.number = number;
  return value;
}

double rounded(double number) { return *parse_number(fmt::format("{:.12g}", number)); }

}  // namespace

std::vector<InputValue> range_values(const InputValue& table, std::string_view name) {
  reject_unknown(table, fmt::format("the range of {}", name), {"from", "to", "count", "scale"});
  const double from = finite_number(required(table, name, "from"), "from");
  const double to = finite_number(required(table, name, "to"), "to");
  const InputValue& count_value =
      expect(required(table, name, "count"), "count", ValueKind::integer);
  const double count = count_value.number;
  if (count < 2.0 || count > k_most_values) {
    reject(count_value.at, fmt::format("count = {} must be from 2 to {}", count, k_most_values));
  }
  if (from == to) reject(table.at, fmt::format("the range of {} has equal ends", name));
  bool log = false;
  if (const InputValue* scale = table.find("scale")) {
    const std::string& word = filled_text(*scale, "scale");
    if (word != "linear" && word != "log") {
      reject(scale->at, fmt::format("no scale '{}'{}", word, known_names(word, {"linear", "log"})));
    }
    log = word == "log";
  }
  if (log && (from <= 0.0 || to <= 0.0)) {
    reject(table.at,
           fmt::format("the range of {}: on a log scale both ends must be positive", name));
  }
  std::vector<InputValue> values = {number_at(table.at, from)};
  for (double i = 1.0; i < count - 1.0; ++i) {
    const double share = i / (count - 1.0);
    const double number =
        log ? rounded(from * std::pow(to / from, share)) : from + (to - from) * i / (count - 1.0);
    values.push_back(number_at(table.at, number));
  }
  values.push_back(number_at(table.at, to));
  return values;
}

}  // namespace brickbench
