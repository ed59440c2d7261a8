// What a check found, told shortly: experiments before numbers, a changed setting once.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "experiments/regression/compare.hpp"

namespace brickbench::gate {

struct ExperimentDigest {
  std::string name;
  std::map<Finding, std::size_t> counts;
  std::vector<std::string> red_engines;  // each once
  std::size_t compared = 0;
  std::size_t numbers = 0;

  std::size_t count(Finding finding) const;
};

// The experiments in the order in which they come, the red ones first.
std::vector<ExperimentDigest> digest(const std::vector<Comparison>& comparisons);

// An engine's numbers in an experiment that all lack a reference, where references of other axes
// were not run: a setting was changed, and nothing was compared.
struct ChangedSetting {
  std::string experiment;
  std::vector<std::string> engines;
  std::string change;  // "friction 0.3 -> 0.285"
  std::size_t missing = 0;
  std::size_t fresh = 0;
};

// Equal changes of one experiment stand together.
std::vector<ChangedSetting> changed_settings(const std::vector<Comparison>& comparisons);
// Whether the comparison is told of by one of the changes.
bool is_told_by(const std::vector<ChangedSetting>& changes, const Comparison& comparison);

// Comparisons whose bound is wider than the number that it guards, which is not 0: whatever the
// number does up to that, nobody is told. The widest first, by bound over number.
std::vector<const Comparison*> loose_bounds(const std::vector<Comparison>& comparisons);

}  // namespace brickbench::gate
