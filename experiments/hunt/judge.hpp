// Judge: runs a trial and asks every oracle.
#pragma once

#include <string>
#include <vector>

#include "experiments/hunt/motion.hpp"
#include "experiments/hunt/oracles.hpp"
#include "experiments/hunt/trial.hpp"

namespace brickbench::hunt {

struct Verdict {
  // Of the run, or a word of to_outcome(); where a law is broken in a run that had raised a flag by
  // then, the word of the flag.
  std::string outcome = "ok";
  std::string reason;
  std::vector<Breach> breaches;  // in the order of oracles()

  // A run that ended without "ok" has said so itself: its breaches are told, not found. A process
  // that died has said nothing.
  bool is_told() const { return outcome != "ok" && find("process") == nullptr; }
  const Breach* find(std::string_view oracle) const;
};

// Runs the trial in this process, a second time for the repetition.
Verdict judge(const Trial& trial, const Catalogues& catalogues);

// Makes the outcome "ok" the word of the flag that the motion raised, if every breach was worst in
// that step or later: a run that raised a flag before it broke a law has told so, whichever law.
void read_flags(const Motion& motion, Verdict& verdict);

// The verdict on a trial whose process ended without an answer.
Verdict judge_crash(const std::string& reason);

}  // namespace brickbench::hunt
