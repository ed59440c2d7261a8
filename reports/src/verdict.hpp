// The verdict: what a run says, in plain words with the numbers.
#pragma once

#include <string>
#include <vector>

#include "reports/src/report_source.hpp"
#include "reports/src/summary.hpp"

namespace brickbench {

// One sentence each. First what our own engines lose, then who was best and worst per scene and
// number, then what did not finish.
std::vector<std::string> verdict(const ReportSource& source, const std::vector<Block>& blocks);

}  // namespace brickbench
