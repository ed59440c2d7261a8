// CSV: records to text and back, exactly.
//
// One record per line, a header always. A field with a comma or a quote stands in double quotes, in
// which a quote is doubled; within any field a line feed, a carriage return and a backslash are
// written \n, \r and \\, so that a record never spans lines.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "experiments/record/planned_cell.hpp"
#include "experiments/record/row.hpp"
#include "experiments/record/series.hpp"
#include "experiments/record/timing.hpp"

namespace brickbench {

// The whole file: header and one line per record.
template <typename Record>
std::string to_csv(std::span<const Record> records);
extern template std::string to_csv<Row>(std::span<const Row>);
extern template std::string to_csv<Timing>(std::span<const Timing>);
extern template std::string to_csv<SeriesPoint>(std::span<const SeriesPoint>);
extern template std::string to_csv<PlannedCell>(std::span<const PlannedCell>);

// Fault::invalid with file:line: for a missing file, a column missing, unknown or given twice, a
// wrong number of fields, a field that is not a value of its column. Columns may stand in any
// order.
template <typename Record>
Expected<std::vector<Record>> read_csv(const std::filesystem::path& file);
extern template Expected<std::vector<Row>> read_csv<Row>(const std::filesystem::path&);
extern template Expected<std::vector<Timing>> read_csv<Timing>(const std::filesystem::path&);
extern template Expected<std::vector<SeriesPoint>> read_csv<SeriesPoint>(
    const std::filesystem::path&);
extern template Expected<std::vector<PlannedCell>> read_csv<PlannedCell>(
    const std::filesystem::path&);

}  // namespace brickbench
