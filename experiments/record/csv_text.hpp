// CSV that is in memory.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiments/record/row.hpp"

namespace brickbench {

// A field as csv.hpp writes it: in quotes where it has to be, on one line.
std::string csv_field(std::string_view text);

// The rows of a whole table, header included; faults as of read_csv(). `name` stands for the file
// in messages.
Expected<std::vector<Row>> rows_from_csv(std::string_view text, const std::string& name);

}  // namespace brickbench
