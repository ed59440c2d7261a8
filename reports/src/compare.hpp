// Compare: two results folders, cell by cell: what changed, by how much, and whether that is more
// than noise.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reports/src/report_source.hpp"
#include "reports/src/table.hpp"

namespace brickbench {

// Below this relative difference two numbers of deterministic runs are told apart only by the
// rounding of compilers and machines.
inline constexpr double k_rounding_relative = 1e-12;
// And below this difference, in the number's own SI unit: sums over thousands of steps whose true
// value is zero are nothing but rounding.
inline constexpr double k_rounding_absolute = 1e-11;
// A CPU time must change by more than this share to count: the clocks of a shared machine vary.
inline constexpr double k_timing_noise_relative = 0.25;

enum class ChangeKind { beyond_noise, within_noise, outcome };

struct Change {
  std::string scene;   // without its seed
  std::string engine;  // label of the contender
  std::string number;
  std::string unit;
  ChangeKind kind = ChangeKind::beyond_noise;
  std::optional<double> before;  // mean over the seeds; of timings the median
  std::optional<double> after;
  double relative = 0.0;  // |after - before| / max(|before|, |after|); infinite for outcomes
  double noise = 0.0;     // half the wider range over the seeds, over the same scale
  std::string words;      // outcomes: "ok -> diverged", "ok -> unsolved (flagged)"
  bool worse = false;     // moved against the number's direction
};

struct FolderComparison {
  std::vector<std::string> facts;  // what differs between the folders: revision, machine, axes...
  std::vector<Change> changes;     // outcomes first, then the largest relative difference
  std::vector<Change> timings;     // CPU per step beyond k_timing_noise_relative
  std::vector<std::string> only_in_a;  // "scene, engine" that the other has not
  std::vector<std::string> only_in_b;
  std::size_t compared = 0;          // numbers that both have, valid
  std::size_t flagged = 0;           // not compared: flagged in one of them, or in both
  std::size_t without_number = 0;    // not compared: no value in one of them, or in both
  std::vector<std::string> untimed;  // "engine, experiment: not comparable: why"
  std::size_t same = 0;              // of them identical to the last bit
  std::size_t beyond_noise = 0;      // changes that are no noise, outcomes included
};

// Cells are paired by experiment, engine, variant, step, seed and axes; axes that differ between
// the folders throughout (a parameter was set to another value) are named as a fact and not paired
// on.
FolderComparison compare(const ReportSource& a, const ReportSource& b);

// One sentence: "No number changed." or how many did and which most.
std::string headline(const FolderComparison& comparison);
// At most `rows` changes beyond noise.
Table changes_table(const FolderComparison& comparison, std::size_t rows);
Table timings_table(const FolderComparison& comparison);

std::string compare_markdown(const FolderComparison& comparison, const std::string& a,
                             const std::string& b);
// The body of a page.
std::string compare_html(const FolderComparison& comparison, const std::string& a,
                         const std::string& b);

}  // namespace brickbench
