#include "experiments/input/input.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "experiments/record/schema.hpp"
#include "experiments/scenarios/nearest_name.hpp"

namespace brickbench {
namespace {

constexpr double k_exact_integer_limit = 9007199254740992.0;  // 2^53

SourcePosition position(std::string_view file, const toml::source_region& region) {
  return {std::string(file), region.begin.line, region.begin.column};
}

InputValue to_value(const toml::node& node, std::string_view file);

InputValue table_value(const toml::table& table, std::string_view file) {
  InputValue value;
  value.kind = ValueKind::table;
  for (const auto& [key, node] : table) {
    value.entries.push_back(
        {std::string(key.str()), position(file, key.source()), to_value(node, file)});
  }
  std::ranges::sort(value.entries, {},
                    [](const Entry& entry) { return std::pair(entry.at.line, entry.at.column); });
  return value;
}

InputValue number_value(ValueKind kind, double number) {
  InputValue value;
  value.kind = kind;
  value.number = number;
  return value;
}

InputValue to_value(const toml::node& node, std::string_view file) {
  const SourcePosition at = position(file, node.source());
  InputValue value;
  if (const auto* table = node.as_table()) {
    value = table_value(*table, file);
  } else if (const auto* array = node.as_array()) {
    value.kind = ValueKind::array;
    for (const toml::node& item : *array) value.items.push_back(to_value(item, file));
  } else if (const auto* text = node.as_string()) {
    value.kind = ValueKind::text;
    value.text = text->get();
  } else if (const auto* integer = node.as_integer()) {
    value = number_value(ValueKind::integer, static_cast<double>(integer->get()));
    if (std::abs(value.number) > k_exact_integer_limit) {
      reject(at, fmt::format("{} is beyond the whole numbers that a double holds exactly",
                             integer->get()));
    }
  } else if (const auto* number = node.as_floating_point()) {
    value = number_value(ValueKind::number, number->get());
  } else if (const auto* boolean = node.as_boolean()) {
    value = number_value(ValueKind::boolean, boolean->get() ? 1.0 : 0.0);
  } else {
    reject(at, "dates and times are not used here");
  }
  value.at = at;
  return value;
}

}  // namespace

std::string InputError::text() const {
  if (at.line == 0) return fmt::format("{}: {}", at.file, reason);
  return fmt::format("{}:{}:{}: {}", at.file, at.line, at.column, reason);
}

tl::unexpected<InputError> file_error(const std::string& file, std::string reason) {
  InputError error;
  error.at.file = file;
  error.reason = std::move(reason);
  return tl::unexpected<InputError>(std::move(error));
}

const InputValue* InputValue::find(std::string_view name) const {
  const auto found = std::ranges::find(entries, name, &Entry::name);
  return found == entries.end() ? nullptr : &found->value;
}

Checked<InputValue> parse_toml(std::string_view text, std::string_view file) {
  try {
    const toml::table table = toml::parse(text, file);
    return to_value(table, file);
  } catch (const toml::parse_error& error) {
    return tl::unexpected(
        InputError{position(file, error.source()), std::string(error.description())});
  } catch (const InputError& error) {
    return tl::unexpected(error);
  }
}

std::string_view kind_name(ValueKind kind) {
  switch (kind) {
    case ValueKind::boolean:
      return "true or false";
    case ValueKind::integer:
      return "a whole number";
    case ValueKind::number:
      return "a number";
    case ValueKind::text:
      return "a string";
    case ValueKind::array:
      return "an array";
    case ValueKind::table:
      return "a table";
  }
  return "a value";
}

void reject(const SourcePosition& at, std::string reason) {
  throw InputError{at, std::move(reason)};
}

std::string known_names(std::string_view name, const std::vector<std::string>& known) {
  if (known.empty()) return "; there are none";
  return fmt::format("; did you mean '{}'? Known: {}", nearest_name(name, known),
                     fmt::join(known, ", "));
}

void reject_unknown(const InputValue& table, std::string_view what,
                    const std::vector<std::string>& known) {
  for (const Entry& entry : table.entries) {
    if (std::ranges::find(known, entry.name) != known.end()) continue;
    reject(entry.at,
           fmt::format("{} has no key '{}'{}", what, entry.name, known_names(entry.name, known)));
  }
}

const InputValue& expect(const InputValue& value, std::string_view name, ValueKind kind) {
  if (value.kind != kind) {
    reject(value.at,
           fmt::format("{} must be {}, not {}", name, kind_name(kind), kind_name(value.kind)));
  }
  return value;
}

std::optional<double> number_or_quotient(std::string_view text) {
  const auto slash = text.find('/');
  const auto top = parse_number(text.substr(0, slash));
  if (slash == std::string_view::npos) return top ? std::optional(*top) : std::nullopt;
  const auto bottom = parse_number(text.substr(slash + 1));
  if (!top || !bottom || *bottom == 0.0) return std::nullopt;
  return *top / *bottom;
}

double finite_number(const InputValue& value, std::string_view name) {
  double number = value.number;
  if (value.kind == ValueKind::text) {
    const auto quotient = number_or_quotient(value.text);
    if (!quotient || value.text.find('/') == std::string::npos) {
      reject(value.at, fmt::format("{} must be a number or a fraction like \"1/240\", not \"{}\"",
                                   name, value.text));
    }
    number = *quotient;
  } else if (value.kind != ValueKind::number && value.kind != ValueKind::integer) {
    reject(value.at, fmt::format("{} must be a number, not {}", name, kind_name(value.kind)));
  }
  if (!std::isfinite(number)) {
    reject(value.at, fmt::format("{} = {} must be finite", name, number));
  }
  return number;
}

double positive_number(const InputValue& value, std::string_view name) {
  const double number = finite_number(value, name);
  if (number <= 0.0) reject(value.at, fmt::format("{} = {} must be positive", name, number));
  return number;
}

const std::string& filled_text(const InputValue& value, std::string_view name) {
  expect(value, name, ValueKind::text);
  if (value.text.empty()) reject(value.at, fmt::format("{} must not be empty", name));
  return value.text;
}

const std::string& file_word(const InputValue& value, std::string_view name) {
  constexpr std::size_t k_most_bytes = 100;
  constexpr std::string_view k_signs = "_-+. ";
  const std::string& text = filled_text(value, name);
  const auto fits = [&](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x80 || std::isalnum(byte) != 0 || k_signs.find(c) != std::string_view::npos;
  };
  const bool begins = std::string_view("-. ").find(text.front()) == std::string_view::npos;
  const bool keeps_free = text != "knob" && !text.ends_with(".knob");
  if (!std::ranges::all_of(text, fits) || !begins || !keeps_free || text.size() > k_most_bytes) {
    reject(
        value.at,
        fmt::format("{} \"{}\" must be of letters, digits, blanks and _ - + . alone, begin with a "
                    "letter, digit, _ or +, not be or end in a knob, and have at most {} bytes",
                    name, text, k_most_bytes));
  }
  return text;
}

std::vector<const InputValue*> one_or_more(const InputValue& value, std::string_view name) {
  if (value.kind != ValueKind::array) return {&value};
  if (value.items.empty()) reject(value.at, fmt::format("{} is an empty list", name));
  std::vector<const InputValue*> items;
  for (const InputValue& item : value.items) items.push_back(&item);
  return items;
}

}  // namespace brickbench
