#include "experiments/scenes/scope.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace brickbench {
namespace {

// Where in the file the byte `offset` of the text stands: beyond the quotation mark. Several lines
// of text, or escapes, cannot be counted from here.
SourcePosition place_within(const InputValue& value, std::size_t offset) {
  SourcePosition at = value.at;
  if (value.text.find('\n') == std::string::npos) at.column += 1 + offset;
  return at;
}

}  // namespace

void check_name(const std::string& name, const SourcePosition& at) {
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  const auto fits = [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); };
  if (name.empty() || name.size() > 100 || !is_letter(name.front()) ||
      !std::ranges::all_of(name, fits)) {
    reject(at, fmt::format("the name '{}' must be of letters, digits and _, begin with no digit "
                           "and have at most 100 of them",
                           name));
  }
}

void Scope::add(const std::string& name, double value, const SourcePosition& at) {
  check_name(name, at);
  if (std::ranges::find(formula_words(), name) != formula_words().end()) {
    reject(at, fmt::format("'{}' is taken: formulas know it as their own", name));
  }
  if (std::ranges::find(names, name) != names.end() || words.contains(name)) {
    reject(at, fmt::format("'{}' is taken: the scene has something of that name", name));
  }
  names.push_back(name);
  values.push_back(value);
}

Quantity::Quantity(const InputValue& value, std::string what, const Scope& scope)
    : at_(value.at), what_(std::move(what)) {
  if (value.kind != ValueKind::text) {
    number_ = finite_number(value, what_);
    return;
  }
  auto formula = Formula::parse(value.text, scope.names);
  if (!formula) {
    reject(place_within(value, formula.error().offset),
           fmt::format("{}: {}", what_, formula.error().reason));
  }
  formula_ = std::move(*formula);
}

double Quantity::in(const Scope& scope) const {
  if (!formula_) return number_;
  const double value = (*formula_)(scope.values);
  if (!std::isfinite(value)) {
    reject(at_, fmt::format("{} = {}: the formula has no finite value here", what_, value));
  }
  return value;
}

VectorQuantity::VectorQuantity(const InputValue& value, const std::string& what,
                               const Scope& scope) {
  expect(value, what, ValueKind::array);
  if (value.items.size() != 3) {
    reject(value.at, fmt::format("{} has three numbers, not {}", what, value.items.size()));
  }
  for (const InputValue& item : value.items) parts_.emplace_back(item, what, scope);
}

Eigen::Vector3d VectorQuantity::in(const Scope& scope) const {
  return {parts_[0].in(scope), parts_[1].in(scope), parts_[2].in(scope)};
}

std::optional<VectorQuantity> vector_of(const InputValue& table, const char* key,
                                        const Scope& scope) {
  const InputValue* value = table.find(key);
  if (value == nullptr) return std::nullopt;
  return VectorQuantity(*value, key, scope);
}

std::optional<Quantity> quantity_of(const InputValue& table, const char* key, const Scope& scope) {
  const InputValue* value = table.find(key);
  if (value == nullptr) return std::nullopt;
  return Quantity(*value, key, scope);
}

Template::Template(const InputValue& value, const std::string& what, const Scope& scope)
    : at_(value.at) {
  const std::string& text = filled_text(value, what);
  std::vector<std::string> known = scope.names;
  for (const auto& [name, word] : scope.words) known.push_back(name);
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if ((text[i] == '{' || text[i] == '}') && i + 1 < text.size() && text[i + 1] == text[i]) {
      plain += text[i++];
      continue;
    }
    if (text[i] == '}') reject(place_within(value, i), what + ": a } without {; }} is the sign");
    if (text[i] != '{') {
      plain += text[i];
      continue;
    }
    const std::size_t end = text.find('}', i);
    if (end == std::string::npos) {
      reject(place_within(value, i), what + ": { without }; {{ is the sign");
    }
    const std::string name = text.substr(i + 1, end - i - 1);
    if (std::ranges::find(known, name) == known.end()) {
      reject(place_within(value, i),
             fmt::format("{} knows no '{}'{}", what, name, known_names(name, known)));
    }
    parts_.push_back({std::exchange(plain, {}), false});
    parts_.push_back({name, true});
    i = end;
  }
  parts_.push_back({plain, false});
}

std::string Template::in(const Scope& scope) const {
  std::string text;
  for (const Part& part : parts_) {
    if (!part.is_name) {
      text += part.text;
      continue;
    }
    if (const auto word = scope.words.find(part.text); word != scope.words.end()) {
      text += word->second;
      continue;
    }
    const auto found = std::ranges::find(scope.names, part.text);
    const double value = scope.values[static_cast<std::size_t>(found - scope.names.begin())];
    if (value != std::round(value) || std::abs(value) > 1e15) {
      reject(at_, fmt::format("{} = {} is no whole number: names are made of those and of words",
                              part.text, value));
    }
    text += fmt::format("{}", static_cast<long long>(value));
  }
  return text;
}

}  // namespace brickbench
