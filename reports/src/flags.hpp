// Flags as the column `validity` of the rows tells them: "unsolved in 31 of 240 steps from step 12;
// clamped in ...".
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "experiments/record/row.hpp"

namespace brickbench {

// Their words: {"unsolved", "clamped"}; empty for a run that raised none.
std::vector<std::string> flag_words(const std::string& validity);

// The first step that raised one of them; 0: none did.
std::uint64_t first_flagged_step(const std::string& validity);

// A row of each cell that ran to its end and is flagged, in the order of the rows.
std::vector<const Row*> flagged_cells(std::span<const Row> rows);

}  // namespace brickbench
