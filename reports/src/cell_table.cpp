#include "reports/src/cell_table.hpp"

#include <algorithm>
#include <set>

#include "experiments/record/csv_text.hpp"
#include "experiments/record/schema.hpp"

namespace brickbench {
namespace {

std::map<std::string, std::string> axes_in(const std::string& text) {
  std::map<std::string, std::string> axes;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(';', at), text.size());
    const std::string axis = text.substr(at, end - at);
    const std::size_t equals = std::min(axis.find('='), axis.size());
    axes[axis.substr(0, equals)] = equals < axis.size() ? axis.substr(equals + 1) : "";
    at = end + 1;
  }
  return axes;
}

CellLine line_of(const Row& row, const std::string& folder) {
  CellLine line;
  line.folder = folder;
  line.experiment = row.experiment;
  line.cell = row.cell;
  line.scenario = row.scenario;
  line.engine = row.engine + '/' + row.variant;
  line.step_s = row.step_s;
  line.duration_s = row.duration_s;
  line.seed = row.seed;
  line.axes = axes_in(row.axes);
  // A number that a scene has not is no end of the cell.
  line.outcome = row.state_hash.empty() ? row.outcome : "ok";
  line.reason = row.state_hash.empty() ? row.reason : "";
  line.validity = row.validity;
  return line;
}

void add_source(const ReportSource& source, CellTable& table, std::set<std::string>& axes) {
  std::map<std::string, std::size_t> known;
  for (const Row& row : source.rows) {
    const auto [place, is_new] = known.emplace(row.cell, table.lines.size());
    if (is_new) table.lines.push_back(line_of(row, source.name));
    CellLine& line = table.lines[place->second];
    if (is_new) {
      for (const auto& [name, value] : line.axes) axes.insert(name);
    }
    if (table.find(row.metric) == nullptr) table.numbers.push_back({row.metric, row.unit, ""});
    if (row.value) line.numbers[row.metric] = *row.value;
  }
  for (const Timing& timing : source.timings) {
    const auto place = known.find(timing.cell);
    if (place != known.end() && timing.steps > 0)
      table.lines[place->second].cpu_s = timing.steps_total_cpu_s;
  }
  for (const MetricRecord& metric : source.provenance.metrics) {
    const auto number = std::ranges::find(table.numbers, metric.name, &NumberName::name);
    if (number != table.numbers.end()) number->meaning = metric.meaning;
  }
}

FlatTable with_header(const CellTable& table) {
  FlatTable flat;
  const auto add = [&](const std::string& name, bool is_number) {
    flat.header.push_back(name);
    flat.is_number.push_back(is_number);
  };
  for (const char* name : {"folder", "experiment", "cell", "scenario", "engine"}) add(name, false);
  for (const char* name : {"step_s", "duration_s", "seed"}) add(name, true);
  for (const std::string& axis : table.axes) {
    const bool is_number = std::ranges::all_of(table.lines, [&](const CellLine& line) {
      const auto found = line.axes.find(axis);
      return found == line.axes.end() || parse_number(found->second).has_value();
    });
    add(axis, is_number);
  }
  for (const char* name : {"outcome", "validity"}) add(name, false);
  return flat;
}

std::vector<std::string> settings_of(const CellLine& line, const CellTable& table) {
  std::vector<std::string> row = {line.folder,
                                  line.experiment,
                                  line.cell,
                                  line.scenario,
                                  line.engine,
                                  shortest(line.step_s),
                                  shortest(line.duration_s),
                                  std::to_string(line.seed)};
  for (const std::string& axis : table.axes) {
    const auto found = line.axes.find(axis);
    row.push_back(found == line.axes.end() ? "" : found->second);
  }
  row.insert(row.end(), {line.outcome, line.validity});
  return row;
}

std::string number_text(const CellLine& line, const std::string& name) {
  const auto found = line.numbers.find(name);
  return found == line.numbers.end() ? "" : shortest(found->second);
}

std::string csv_line(const std::vector<std::string>& row) {
  std::string line;
  for (std::size_t i = 0; i < row.size(); ++i) line += (i == 0 ? "" : ",") + csv_field(row[i]);
  return line + '\n';
}

}  // namespace

const NumberName* CellTable::find(const std::string& number) const {
  const auto found = std::ranges::find(numbers, number, &NumberName::name);
  return found == numbers.end() ? nullptr : &*found;
}

CellTable cell_table(std::span<const ReportSource> sources) {
  CellTable table;
  std::set<std::string> axes;
  for (const ReportSource& source : sources) add_source(source, table, axes);
  table.axes.assign(axes.begin(), axes.end());
  return table;
}

FlatTable long_table(const CellTable& table) {
  FlatTable flat = with_header(table);
  for (const char* name : {"number", "unit", "value"}) flat.header.emplace_back(name);
  flat.is_number.insert(flat.is_number.end(), {false, false, true});
  for (const CellLine& line : table.lines) {
    for (const NumberName& number : table.numbers) {
      std::vector<std::string> row = settings_of(line, table);
      row.insert(row.end(), {number.name, number.unit, number_text(line, number.name)});
      flat.rows.push_back(std::move(row));
    }
  }
  return flat;
}

FlatTable wide_table(const CellTable& table) {
  FlatTable flat = with_header(table);
  flat.header.emplace_back("steps_total_cpu_s");
  for (const NumberName& number : table.numbers) flat.header.push_back(number.name);
  flat.is_number.resize(flat.header.size(), true);
  for (const CellLine& line : table.lines) {
    std::vector<std::string> row = settings_of(line, table);
    row.push_back(line.cpu_s ? shortest(*line.cpu_s) : "");
    for (const NumberName& number : table.numbers) row.push_back(number_text(line, number.name));
    flat.rows.push_back(std::move(row));
  }
  return flat;
}

std::string to_csv(const FlatTable& table) {
  std::string out = csv_line(table.header);
  for (const auto& row : table.rows) out += csv_line(row);
  return out;
}

}  // namespace brickbench
