// Result file: what one cell yielded, as one small file with a checksum. Its presence is the only
// record that the cell is done.
//
// One line
//   brickbench-cell 3 <id> <outcome> <bytes of reason> <of rows> <of timings> <of series>
//   <XXH3-128>
// then reason, rows, timings and series, the latter three as the lines of CSV without the header.
// The checksum is that of everything else in the file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "experiments/run/run_cell.hpp"

namespace brickbench {

struct CellFile {
  std::string id;
  std::string outcome;
  std::string reason;
  std::string rows;     // lines of rows.csv
  std::string timings;  // lines of timings.csv
  std::string series;   // lines of series.csv; empty unless the cell is recorded
};

// The curves go into the file only where `with_series`: they are some hundred kilobytes.
CellFile cell_file(const CellResult& result, bool with_series = false);

std::string to_text(const CellFile& file);

// Fault::invalid, with what is wrong, unless the text is whole, undamaged and that of cell `id`.
Expected<CellFile> parse_cell_file(std::string_view text, std::string_view id);

// Where results and the output of failed cells are, in 256 subfolders each: cells/ab/<id>.cell,
// logs/ab/<id>.log.
std::filesystem::path result_path(const std::filesystem::path& sweep, std::string_view id);
std::filesystem::path log_path(const std::filesystem::path& sweep, std::string_view id);

// XXH3-128, 32 hexadecimal digits.
std::string checksum(std::string_view text);

// Whether `--retry-failed` runs a cell of this outcome again.
bool is_retried(std::string_view outcome);

}  // namespace brickbench
