// Instruments: everything with which the harness could notice that an engine is wrong.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "experiments/hunt/judge.hpp"

namespace brickbench::testing {

// What each of them says of one fault.
struct Caught {
  bool audit = false;              // the facts that are read back from the live engine
  std::vector<std::string> cases;  // exact cases that fail on motion and forces alone
  std::string run;                 // outcome or first flag of the first ordinary run that has one
  std::string hunt;                // oracle and number of the trial of the hunt
  bool any() const { return audit || !cases.empty() || !run.empty() || !hunt.empty(); }
};

// The exact cases that are looked at: few and short ones that together look at every fact, setting
// and read-out.
const std::vector<std::string>& judged_cases();

// What ordinary runs of the fault say: the first word of an outcome or of flags that no sound run
// has, and the run; empty: nothing.
std::string said_by_runs(std::size_t index);

class Instruments {
 public:
  // Fault number `index` of the seeded faults.
  Caught look_at(std::size_t index);

 private:
  // What the trial shows with the correct engine; nullptr where it makes no scene.
  const hunt::Verdict* innocent(const std::string& scenes, std::uint64_t number);
  std::string hunt_for(std::size_t index);

  std::map<std::pair<std::string, std::uint64_t>, std::optional<hunt::Verdict>> innocent_;
};

}  // namespace brickbench::testing
