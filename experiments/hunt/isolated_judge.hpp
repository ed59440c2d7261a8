// Judging and shrinking in processes of their own: an engine may do what it likes.
#pragma once

#include "experiments/hunt/shrink.hpp"
#include "experiments/process/isolate.hpp"

namespace brickbench::hunt {

// A trial takes a moment; what takes longer than this CPU time has run away.
inline constexpr unsigned k_trial_cpu_s = 20;
inline constexpr std::size_t k_shrink_probes = 120;

// Starts the process that judges, or shrinks.
Expected<Isolated> start_judging(const Trial& trial, const Catalogues& catalogues);
Expected<Isolated> start_shrinking(const Trial& trial, const Verdict& verdict,
                                   const std::string& oracle, const Catalogues& catalogues);

// What its end means.
Verdict verdict_of(const Ended& ended);
// Where the process did not come to its end: the trial as it was.
Shrunk shrunk_of(const Ended& ended, const Trial& trial, const Verdict& verdict);

// judge() in a process of its own, waited for.
Verdict judge_isolated(const Trial& trial, const Catalogues& catalogues);

}  // namespace brickbench::hunt
