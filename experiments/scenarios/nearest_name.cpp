#include "experiments/scenarios/nearest_name.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace brickbench {
namespace {

// Letters of the longest piece that both words contain.
std::size_t common_run(std::string_view a, std::string_view b) {
  std::size_t longest = 0;
  std::vector<std::size_t> row(b.size() + 1, 0);
  for (const char letter : a) {
    std::size_t diagonal = 0;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t run = letter == b[j - 1] ? diagonal + 1 : 0;
      diagonal = row[j];
      row[j] = run;
      longest = std::max(longest, run);
    }
  }
  return longest;
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

std::string nearest_name(std::string_view name, std::span<const std::string> known) {
  constexpr std::size_t k_least_run = 3;
  const auto distance = [&](const std::string& candidate) {
    return edit_distance(name, candidate);
  };
  const auto nearest = std::ranges::min_element(known, {}, distance);
  if (nearest == known.end()) return {};
  if (3 * distance(*nearest) <= std::max(name.size(), k_least_run)) return *nearest;
  const auto kinship = [&](const std::string& candidate) {
    return std::pair(common_run(name, candidate),
                     -static_cast<std::ptrdiff_t>(distance(candidate)));
  };
  const auto kin = std::ranges::max_element(known, {}, kinship);
  return common_run(name, *kin) >= k_least_run ? *kin : *nearest;
}

}  // namespace brickbench
