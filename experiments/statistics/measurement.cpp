#include "experiments/statistics/measurement.hpp"

namespace brickbench::statistics {

bool is_share_of(std::string_view share, std::string_view count) {
  constexpr std::string_view k_share_suffix = "_relative";
  if (!share.ends_with(k_share_suffix) || share == count) return false;
  const std::string_view stem = share.substr(0, share.size() - k_share_suffix.size() + 1);
  if (!count.starts_with(stem)) return false;
  // What follows the stem is a unit and nothing else: "j", "ns", "nms".
  const std::string_view unit = count.substr(stem.size());
  return !unit.empty() && unit.find('_') == std::string_view::npos;
}

}  // namespace brickbench::statistics
