#include "reports/src/flags.hpp"

#include <algorithm>
#include <charconv>
#include <set>

namespace brickbench {
namespace {

std::vector<std::string> flag_parts(const std::string& validity) {
  constexpr std::string_view k_between = "; ";
  std::vector<std::string> parts;
  for (std::size_t at = 0; at < validity.size();) {
    const std::size_t end = std::min(validity.find(k_between, at), validity.size());
    parts.push_back(validity.substr(at, end - at));
    at = end + k_between.size();
  }
  return parts;
}

}  // namespace

std::vector<std::string> flag_words(const std::string& validity) {
  std::vector<std::string> words;
  for (const std::string& part : flag_parts(validity)) {
    words.push_back(part.substr(0, part.find(' ')));
  }
  return words;
}

std::uint64_t first_flagged_step(const std::string& validity) {
  constexpr std::string_view k_before = " from step ";
  std::uint64_t first = 0;
  for (const std::string& part : flag_parts(validity)) {
    const std::size_t at = part.find(k_before);
    if (at == std::string::npos) continue;
    std::uint64_t step = 0;
    const char* begin = part.data() + at + k_before.size();
    if (std::from_chars(begin, part.data() + part.size(), step).ec != std::errc()) continue;
    first = first == 0 ? step : std::min(first, step);
  }
  return first;
}

std::vector<const Row*> flagged_cells(std::span<const Row> rows) {
  std::vector<const Row*> cells;
  std::set<std::string> seen;
  for (const Row& row : rows) {
    if (!row.validity.empty() && seen.insert(row.cell).second) cells.push_back(&row);
  }
  return cells;
}

}  // namespace brickbench
