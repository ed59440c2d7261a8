#include "experiments/record/csv.hpp"

#include <csv.h>
#include <fmt/core.h>

#include <array>
#include <utility>

#include "experiments/record/csv_text.hpp"

namespace brickbench {
namespace {

Expected<std::string> unescaped(std::string_view field) {
  std::string text;
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (field[i] != '\\') {
      text += field[i];
      continue;
    }
    const char next = ++i < field.size() ? field[i] : '\0';
    if (next == 'n')
      text += '\n';
    else if (next == 'r')
      text += '\r';
    else if (next == '\\')
      text += '\\';
    else
      return fail(Fault::invalid, fmt::format("unknown escape in '{}'", field));
  }
  return text;
}

template <typename Reader, std::size_t N, std::size_t... I>
bool read_fields(Reader& reader, std::array<char*, N>& fields, std::index_sequence<I...>) {
  return reader.read_row(fields[I]...);
}

template <typename Reader, typename Columns, std::size_t... I>
void read_names(Reader& reader, const Columns& columns, std::index_sequence<I...>) {
  reader.read_header(io::ignore_no_column, std::string(columns[I].name)...);
}

template <typename Record, typename Columns, typename Fields>
Expected<Record> to_record(const Columns& columns, const Fields& fields) {
  Record record;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    auto text = unescaped(fields[i]);
    if (!text)
      return fail(text.error().fault, fmt::format("{}: {}", columns[i].name, text.error().reason));
    if (auto ok = columns[i].parse(record, *text); !ok) {
      return fail(ok.error().fault, fmt::format("{}: {}", columns[i].name, ok.error().reason));
    }
  }
  return record;
}

}  // namespace

std::string csv_field(std::string_view text) {
  std::string out;
  bool quote = false;
  for (const char c : text) {
    switch (c) {
      case '\n':
        out += "\\n";
        break;
      case '\r':
        out += "\\r";
        break;
      case '\\':
        out += "\\\\";
        break;
      case '"':
        out += "\"\"";
        quote = true;
        break;
      case ',':
        out += ',';
        quote = true;
        break;
      default:
        out += c;
    }
  }
  return quote ? '"' + out + '"' : out;
}

template <typename Record>
std::string to_csv(std::span<const Record> records) {
  const auto columns = Schema<Record>::columns();
  std::string text;
  for (const auto& column : columns) {
    if (!text.empty()) text += ',';
    text += column.name;
  }
  text += '\n';
  for (const Record& record : records) {
    bool first = true;
    for (const auto& column : columns) {
      if (!first) text += ',';
      text += csv_field(column.text(record));
      first = false;
    }
    text += '\n';
  }
  return text;
}

namespace {

// `name` stands in messages; the source is what the reader is made from.
template <typename Record, typename... Source>
Expected<std::vector<Record>> read_all(const std::string& name, const Source&... source) {
  constexpr std::size_t n = Schema<Record>::size;
  const auto columns = Schema<Record>::columns();
  try {
    io::CSVReader<n, io::trim_chars<>, io::double_quote_escape<',', '"'>> reader(name, source...);
    read_names(reader, columns, std::make_index_sequence<n>{});
    std::vector<Record> records;
    std::array<char*, n> fields{};
    while (read_fields(reader, fields, std::make_index_sequence<n>{})) {
      auto record = to_record<Record>(columns, fields);
      if (!record) {
        return fail(Fault::invalid,
                    fmt::format("{}:{}: {}", name, reader.get_file_line(), record.error().reason));
      }
      records.push_back(std::move(*record));
    }
    return records;
  } catch (const std::exception& error) {
    const auto* place = dynamic_cast<const io::error::with_file_line*>(&error);
    const std::string at = place != nullptr && place->file_line > 0
                               ? fmt::format("{}:{}", name, place->file_line)
                               : name;
    const bool other = dynamic_cast<const io::error::missing_column_in_header*>(&error) != nullptr;
    return fail(Fault::invalid,
                fmt::format("{}: {}{}", at, error.what(),
                            other ? fmt::format("; this program reads schema version {}: files of "
                                                "an earlier one are to be made anew",
                                                Schema<Record>::version)
                                  : ""));
  }
}

}  // namespace

template <typename Record>
Expected<std::vector<Record>> read_csv(const std::filesystem::path& file) {
  return read_all<Record>(file.string());
}

Expected<std::vector<Row>> rows_from_csv(std::string_view text, const std::string& name) {
  return read_all<Row>(name, text.data(), text.data() + text.size());
}

template std::string to_csv<Row>(std::span<const Row>);
template std::string to_csv<Timing>(std::span<const Timing>);
template std::string to_csv<SeriesPoint>(std::span<const SeriesPoint>);
template std::string to_csv<PlannedCell>(std::span<const PlannedCell>);
template Expected<std::vector<Row>> read_csv<Row>(const std::filesystem::path&);
template Expected<std::vector<Timing>> read_csv<Timing>(const std::filesystem::path&);
template Expected<std::vector<SeriesPoint>> read_csv<SeriesPoint>(const std::filesystem::path&);
template Expected<std::vector<PlannedCell>> read_csv<PlannedCell>(const std::filesystem::path&);

}  // namespace brickbench
