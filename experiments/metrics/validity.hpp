// Validity: how often a run raised each flag, and since when.
#pragma once

#include <array>
#include <string>

#include "experiments/metrics/metric.hpp"

namespace brickbench {

class Validity {
 public:
  // Called for step 0, which raises nothing, and after every step.
  void observe(const Sample& sample);

  struct Tally {
    std::size_t steps = 0;  // that raised the flag
    std::size_t first = 0;  // the first of them; 0: none
  };
  const Tally& of(Flag flag) const { return tallies_[static_cast<std::size_t>(flag)]; }
  // Whether a count of 0 means that it did not happen, and not that nobody would have said so.
  bool is_told(Flag flag) const { return tellable_.has(flag); }
  std::size_t steps() const { return steps_; }

  // "unsolved in 31 of 240 steps from step 12; clamped in ..."; empty if no flag was raised.
  std::string text() const;

 private:
  std::array<Tally, k_all_flags.size()> tallies_{};
  Flags tellable_;
  std::string passage_;  // the first
  std::size_t steps_ = 0;
};

}  // namespace brickbench
