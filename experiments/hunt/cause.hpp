// Cause: which findings are one and the same fault, as far as one can tell from outside.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiments/hunt/trial.hpp"

namespace brickbench::hunt {

// What had to be there for the breach: the parameters and knobs that could not be left out, without
// their values, edges and axes counted as one; sorted, joined by ", "; "nothing" if the scene as it
// is breaks the law.
std::string needed(const Trial& shrunk);

// oracle | engine/variant | scene | needed: equal for what counts as one cause.
std::string cause_key(std::string_view oracle, const Trial& shrunk);

// How hard the trial is to look at: bodies count most, then parameters, then steps.
double burden(const Trial& trial, const Catalogues& catalogues);

}  // namespace brickbench::hunt
