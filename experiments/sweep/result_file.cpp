#include "experiments/sweep/result_file.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <vector>

#include "experiments/record/csv.hpp"

namespace brickbench {
namespace {

constexpr std::string_view k_magic = "brickbench-cell";
constexpr std::string_view k_version = "3";

// The lines of a CSV text without its header.
std::string without_header(const std::string& csv) { return csv.substr(csv.find('\n') + 1); }

std::string start_of(const CellFile& file) {
  return fmt::format("{} {} {} {} {} {} {} {} ", k_magic, k_version, file.id, file.outcome,
                     file.reason.size(), file.rows.size(), file.timings.size(), file.series.size());
}

std::string checksum_of(std::string_view start, std::string_view body) {
  XXH3_state_t state;
  XXH3_128bits_reset(&state);
  XXH3_128bits_update(&state, start.data(), start.size());
  XXH3_128bits_update(&state, body.data(), body.size());
  const XXH128_hash_t hash = XXH3_128bits_digest(&state);
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  while (!line.empty()) {
    const auto space = line.find(' ');
    words.push_back(line.substr(0, space));
    line.remove_prefix(space == line.npos ? line.size() : space + 1);
  }
  return words;
}

std::filesystem::path path_of(const std::filesystem::path& sweep, const char* kind,
                              std::string_view id, const char* extension) {
  // As one text: a hundred thousand of these are made before a sweep goes on.
  return fmt::format("{}/{}/{}/{}{}", sweep.native(), kind, id.substr(0, 2), id, extension);
}

}  // namespace

CellFile cell_file(const CellResult& result, bool with_series) {
  return {result.timing.cell,
          result.outcome,
          result.reason,
          without_header(to_csv<Row>(result.rows)),
          without_header(to_csv<Timing>({&result.timing, 1})),
          with_series ? without_header(to_csv<SeriesPoint>(result.series)) : ""};
}

std::string to_text(const CellFile& file) {
  const std::string start = start_of(file);
  const std::string body = file.reason + file.rows + file.timings + file.series;
  return start + checksum_of(start, body) + '\n' + body;
}

Expected<CellFile> parse_cell_file(std::string_view text, std::string_view id) {
  const auto end = text.find('\n');
  if (end == text.npos) return fail(Fault::invalid, "it has no complete first line");
  const std::string_view line = text.substr(0, end);
  const std::string_view body = text.substr(end + 1);
  const auto words = words_of(line);
  if (words.size() < 2 || words[0] != k_magic) return fail(Fault::invalid, "not a result file");
  if (words[1] != k_version) {
    return fail(Fault::invalid, fmt::format("format {}, not {}", words[1], k_version));
  }
  if (words.size() != 9) return fail(Fault::invalid, "its first line is damaged");
  std::array<std::uint64_t, 4> sizes{};
  std::uint64_t total = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const auto size = parse_count(words[4 + i]);
    if (!size || *size > body.size()) return fail(Fault::invalid, "it is cut off");
    sizes[i] = *size;
    total += *size;
  }
  if (total != body.size()) {
    return fail(Fault::invalid, fmt::format("it has {} bytes of {}", body.size(), total));
  }
  if (checksum_of(line.substr(0, line.size() - words[8].size()), body) != words[8]) {
    return fail(Fault::invalid, "the checksum does not fit");
  }
  if (words[2] != id) return fail(Fault::invalid, fmt::format("it is of cell {}", words[2]));
  std::array<std::string, 4> parts;
  std::size_t at = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i] = body.substr(at, sizes[i]);
    at += sizes[i];
  }
  return CellFile{.id = std::string(words[2]),
                  .outcome = std::string(words[3]),
                  .reason = std::move(parts[0]),
                  .rows = std::move(parts[1]),
                  .timings = std::move(parts[2]),
                  .series = std::move(parts[3])};
}

std::filesystem::path result_path(const std::filesystem::path& sweep, std::string_view id) {
  return path_of(sweep, "cells", id, ".cell");
}

std::filesystem::path log_path(const std::filesystem::path& sweep, std::string_view id) {
  return path_of(sweep, "logs", id, ".log");
}

std::string checksum(std::string_view text) { return checksum_of(text, ""); }

bool is_retried(std::string_view outcome) {
  constexpr std::array<std::string_view, 6> retried = {"diverged",  "blown_up",      "crashed",
                                                       "timed_out", "out_of_memory", "invalid"};
  return std::ranges::find(retried, outcome) != retried.end();
}

}  // namespace brickbench
