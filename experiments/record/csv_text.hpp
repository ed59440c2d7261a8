// CSV that is in memory.
#pragma once

#include <string_view>
#include <vector>

#include "experiments/record/row.hpp"

namespace brickbench {

// The rows of a whole table, header included; faults as of read_csv(). `name` stands for the file
// in messages.
Expected<std::vector<Row>> rows_from_csv(std::string_view text, const std::string& name);

}  // namespace brickbench
