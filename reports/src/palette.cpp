#include "reports/src/palette.hpp"

#include <algorithm>
#include <array>

namespace brickbench {
namespace {

constexpr std::array k_colours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9",
                                  "#e69f00", "#8878d8", "#aa4466", "#999933", "#888888"};
constexpr std::array k_dashes = {"", "7 3", "2 3", "9 3 2 3"};

}  // namespace

std::string palette_colour(std::size_t index) { return k_colours[index % k_colours.size()]; }
std::string palette_dash(std::size_t index) {
  // Neighbours differ in dash as well as in colour.
  return k_dashes[(index + index / k_colours.size()) % k_dashes.size()];
}

std::size_t Palette::index(const std::string& label) {
  const auto found = std::ranges::find(labels_, label);
  if (found != labels_.end()) return static_cast<std::size_t>(found - labels_.begin());
  labels_.push_back(label);
  return labels_.size() - 1;
}

}  // namespace brickbench
