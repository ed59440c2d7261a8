// What changed between two texts, line by line.
#pragma once

#include <string>
#include <string_view>

namespace brickbench {

// "- old line" and "+ new line" for every line that is not common to both, in order, found by the
// longest common subsequence; empty if the texts agree. Meant for plans: time and memory grow with
// the product of the numbers of lines.
std::string line_difference(std::string_view before, std::string_view after);

}  // namespace brickbench
