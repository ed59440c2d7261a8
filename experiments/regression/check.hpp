// Check: runs a suite, in growing samples where starts are many, and compares it with its
// references.
#pragma once

#include <set>

#include "experiments/regression/compare.hpp"
#include "experiments/run/run_plan.hpp"

namespace brickbench::gate {

struct CheckResult {
  std::vector<Comparison> comparisons;  // worst first
  Suite obtained;
  std::vector<CellOutcome> cells;  // that were run
  std::size_t cells_spared = 0;    // that the sequential design did not need
  std::string command;             // of this check, for the shell, without --engine and --only
};

struct CheckPlan {
  // After each look of it an ensemble all of whose numbers are decided is done: identical, same or
  // different.
  ComparePlan compare;
  bool all_starts = false;  // run everything at once: for new references
};

// The ensembles, as "experiment|engine|axes|", with a number that is neither identical, nor same,
// nor different yet, or that has no reference: those that the next look adds starts to.
std::set<std::string> undecided(const std::vector<Comparison>& comparisons);

CheckResult check(const Plan& plan, const std::vector<Cell>& cells, const Catalogues& catalogues,
                  const Suite& reference, const CheckPlan& how, const Machine& machine,
                  const RunCallbacks& callbacks = {});

// 0: nothing red; 1: a deviation, or a cell failed that had not; 3: a reference that was not run,
// numbers without reference, or nothing at all that could be compared.
int exit_code(const CheckResult& result);

// The command that makes the comparison again, from CheckResult::command: the one experiment of the
// one engine, with the knobs that a plan may have turned for it.
std::string reproduce(const std::string& command, const Comparison& comparison);

// One <testcase> per record, with the message of every red one (the JUnit XML of Apache Ant).
std::string junit(const std::string& suite, const CheckResult& result);

// Lines that GitHub Actions shows beside the change, one per red record, at most `most`.
std::string annotations(const std::string& suite, const std::string& reference_folder,
                        const CheckResult& result, std::size_t most);

// `reference` with the records that changed replaced by those obtained; unchanged ones stay as they
// are to the last letter. `changed` names what was replaced or added.
struct BlessResult {
  Suite suite;
  std::vector<Comparison> changed;
};
BlessResult bless(const Suite& reference, const Suite& obtained, const Blessing& blessing,
                  const ComparePlan& plan);

}  // namespace brickbench::gate
