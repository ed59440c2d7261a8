// Overrides of a plan from the command line, applied to the tree before it is read, so that they
// are checked like everything else; their complaints point into the option.
#pragma once

#include "experiments/run/plan.hpp"

namespace brickbench {

// Throws InputError. A key is one of step_s, duration_s, time_limit_s, seeds, or a parameter of the
// scenario; "experiment.key" reaches one experiment only. The value is TOML; a bare word is a
// string.
void override_values(InputValue& plan, const Overrides& overrides, const Catalogues& catalogues);

}  // namespace brickbench
