// What a replay shows beyond the recorded states: the only place where reports meet the metrics.
#pragma once

#include <vector>

#include "reports/src/report_source.hpp"

namespace brickbench {

// Thins the replays to what a page holds (`frames` at most each) and fills their penetrations from
// the recorded poses: of each body the deepest overlap with any other, as the metric penetration
// measures it.
void add_replay_depths(std::vector<ReportSource>& sources, std::size_t frames);

}  // namespace brickbench
