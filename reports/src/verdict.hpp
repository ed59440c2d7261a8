// The verdict: what a run says, in plain words with the numbers.
#pragma once

#include <string>
#include <vector>

#include "reports/src/report_source.hpp"
#include "reports/src/scene_names.hpp"

namespace brickbench {

// One sentence each. First what our own engines lose, then what did not finish, then how many
// exact cases follow their scheme.
std::vector<std::string> verdict(const ReportSource& source, const std::vector<Block>& blocks,
                                 const SceneNames& names);

// Who was best and worst, and where our own engines stand, in one telling number per scene and
// group; how many had it. Contenders that the best leads by rounding only share its place.
Table verdict_table(const ReportSource& source, const std::vector<Block>& blocks,
                    const SceneNames& names);

}  // namespace brickbench
