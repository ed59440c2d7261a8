// Range: many values of an axis, said in three numbers.
#pragma once

#include <string_view>
#include <vector>

#include "experiments/input/input.hpp"

namespace brickbench {

// The values of a table { from, to, count [, scale = "linear" | "log"] }: both ends exactly, and
// count - 2 values between at equal distances (linear, the default) or ratios (log; rounded to 12
// significant digits, so that the last bit of a power decides nothing). Whole numbers are whole
// values, and so fit parameters that count things. Throws InputError for anything else, for fewer
// than 2 or more than 1000000 values, equal ends, and for a log scale with an end that is not
// positive.
std::vector<InputValue> range_values(const InputValue& table, std::string_view name);

}  // namespace brickbench
