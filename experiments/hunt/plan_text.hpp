// Findings as files: a plan that shows the breach again in one command.
#pragma once

#include <optional>
#include <string>

#include "experiments/hunt/judge.hpp"
#include "experiments/run/plan.hpp"

namespace brickbench::hunt {

// The plan of one trial that breaks `oracle`: what was expected and what was seen stand in
// `analysis`, and the commands in comments above. `file` is the name under which the commands find
// it.
std::string plan_text(const Trial& trial, const Verdict& verdict, std::string_view oracle,
                      const std::string& file, const std::string& origin);

// The trial in a file of an exact case, which is no plan: `case_text` wrote it. nullopt: not such
// a file.
Checked<std::optional<Trial>> case_trial(const std::string& text, const std::string& file,
                                         const Catalogues& catalogues);

// The trials that the cells of a plan are, in its order; seeds and excluded cells are refused.
Checked<std::vector<Trial>> trials_of(const Plan& plan, const Catalogues& catalogues);

}  // namespace brickbench::hunt
