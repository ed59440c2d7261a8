// Input with a place: TOML as a tree whose every value knows its file, line and column, so that
// each complaint can point at what it speaks of.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

namespace brickbench {

struct SourcePosition {
  std::string file;
  std::size_t line = 0;  // from 1; 0: the file as a whole
  std::size_t column = 0;
};

// What is wrong with an input, where, and what is allowed instead.
struct InputError {
  SourcePosition at;
  std::string reason;

  // "file:line:column: reason"
  std::string text() const;
};

template <typename T>
using Checked = tl::expected<T, InputError>;

enum class ValueKind { boolean, integer, number, text, array, table };

struct Entry;

struct InputValue {
  ValueKind kind = ValueKind::table;
  SourcePosition at;
  double number = 0.0;  // of booleans (0 or 1), integers and numbers
  std::string text;
  std::vector<InputValue> items;  // of an array
  std::vector<Entry> entries;     // of a table, in the order of the file

  // The entry's value, or nullptr.
  const InputValue* find(std::string_view name) const;
};

struct Entry {
  std::string name;
  SourcePosition at;
  InputValue value;
};

// The complaint about a file as a whole.
tl::unexpected<InputError> file_error(const std::string& file, std::string reason);

// The table that the TOML text says; `file` stands in the messages. Duplicate keys, dates and
// integers beyond 2^53 are errors.
Checked<InputValue> parse_toml(std::string_view text, std::string_view file);

// "a string", "a table" ...
std::string_view kind_name(ValueKind kind);

// The rest is for readers of such trees: they throw InputError, and the public function of the
// reader turns it into a value.
[[noreturn]] void reject(const SourcePosition& at, std::string reason);

// Rejects every entry that is not `known`, with the nearest known name.
void reject_unknown(const InputValue& table, std::string_view what,
                    const std::vector<std::string>& known);

// ". Did you mean 'x'? Known: a, b, c"
std::string known_names(std::string_view name, const std::vector<std::string>& known);

const InputValue& expect(const InputValue& value, std::string_view name, ValueKind kind);
// What "0.004" or "1/240" says; nullopt for anything else, and where the divisor is 0.
std::optional<double> number_or_quotient(std::string_view text);
// A finite number; a string "1/240" counts as the quotient.
double finite_number(const InputValue& value, std::string_view name);
double positive_number(const InputValue& value, std::string_view name);
// A string that is not empty.
const std::string& filled_text(const InputValue& value, std::string_view name);
// A name that may become part of a file's name and of a command: letters, digits, '_', '-', '+',
// '.', blanks and letters beyond ASCII, at most 100 bytes; it begins with none of '.', '-' and
// blank, and is not "knob", which --set keeps for itself.
const std::string& file_word(const InputValue& value, std::string_view name);
// The items of an array that is not empty, or the value itself.
std::vector<const InputValue*> one_or_more(const InputValue& value, std::string_view name);

}  // namespace brickbench
