// Schema: a record type as a list of named text columns, so that writer, reader, JSON and
// documentation all follow one statement of it.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "adapters/seam/failure.hpp"

namespace brickbench {

template <typename Record>
struct Column {
  std::string_view name;
  std::string_view meaning;  // one line, with the unit where there is one
  bool is_number = false;    // JSON: a number, or null where the text is empty
  std::string (*text)(const Record&) = nullptr;
  // Fault::invalid with a reason if the text is not a value of this column.
  Expected<void> (*parse)(Record&, std::string_view) = nullptr;
};

// Specialised beside each record type: the version, and columns() in file order.
template <typename Record>
struct Schema;

// The shortest text that reads back to the same double; "" for NaN.
std::string shortest(double value);
// The whole text as a finite or infinite number; Fault::invalid otherwise.
Expected<double> parse_number(std::string_view text);
Expected<std::uint64_t> parse_count(std::string_view text);

// Column makers. A column of text holds any characters, line breaks included.
template <auto Member, typename Record>
Column<Record> text_column(std::string_view name, std::string_view meaning) {
  return {name, meaning, false, [](const Record& record) { return record.*Member; },
          [](Record& record, std::string_view text) -> Expected<void> {
            record.*Member = text;
            return {};
          }};
}

template <auto Member, typename Record>
Column<Record> number_column(std::string_view name, std::string_view meaning) {
  return {name, meaning, true, [](const Record& record) { return shortest(record.*Member); },
          [](Record& record, std::string_view text) -> Expected<void> {
            auto value = parse_number(text);
            if (!value) return tl::unexpected(value.error());
            record.*Member = *value;
            return {};
          }};
}

// A number that need not be there: NaN is written as the empty text, and read back from it.
template <auto Member, typename Record>
Column<Record> optional_number_column(std::string_view name, std::string_view meaning) {
  Column<Record> column = number_column<Member, Record>(name, meaning);
  column.parse = [](Record& record, std::string_view text) -> Expected<void> {
    if (!text.empty()) return number_column<Member, Record>("", "").parse(record, text);
    record.*Member = std::numeric_limits<double>::quiet_NaN();
    return {};
  };
  return column;
}

template <auto Member, typename Record>
Column<Record> count_column(std::string_view name, std::string_view meaning) {
  return {name, meaning, true, [](const Record& record) { return std::to_string(record.*Member); },
          [](Record& record, std::string_view text) -> Expected<void> {
            auto value = parse_count(text);
            if (!value) return tl::unexpected(value.error());
            record.*Member = *value;
            return {};
          }};
}

}  // namespace brickbench
