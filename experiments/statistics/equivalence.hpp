// Equivalence: not "no difference was found" but "the difference is smaller than this".
#pragma once

#include <span>

#include "experiments/statistics/bootstrap.hpp"
#include "experiments/statistics/sample_tests.hpp"

namespace brickbench::statistics {

// More runs than this nobody makes: numbers of runs end here.
inline constexpr std::size_t k_most_runs = 1000000000;

// Two one-sided tests of the means (Schuirmann, J. Pharmacokinetics and Biopharmaceutics 15, 1987)
// by their bootstrap interval.
struct Equivalence {
  double difference = 0.0;  // mean of b - mean of a
  double low = 0.0;         // difference_interval() at 1 - 2 alpha
  double high = 0.0;
  bool equivalent = false;  // the interval lies within +-margin
};

// At least two values each; margin > 0, in the unit of the values.
Equivalence equivalence(std::span<const double> a, std::span<const double> b, double margin,
                        double alpha);

// Runs per sample with which equal means would be shown equivalent within `margin` > 0 with
// probability 0.9 by two one-sided tests at `alpha`, at the spread seen in a and b; at least 2,
// at most k_most_runs.
std::size_t runs_for_equivalence(std::span<const double> a, std::span<const double> b,
                                 double margin, double alpha);

// Runs per sample with which means as far apart as those of a and b would be shown different at
// `level` with probability 0.9, at the spread seen; k_most_runs for equal means. By Student's test,
// which the energy test follows where distributions differ by a shift.
std::size_t runs_for_difference(std::span<const double> a, std::span<const double> b, double level);

enum class Verdict {
  identical,        // bit for bit, start by start
  same,             // equivalent within the margin
  different,        // not one distribution
  not_enough_runs,  // neither was shown
};

// The questions about one number of one subject in one scene: "is it another distribution?" and
// "are the means the same within the margin?". Each subject, scene and number is a family of its
// own: levels, and so verdicts, know nothing of what else was run.
struct LookPlan {
  double level_different = 0.01;  // chance of a false "different" in this look
  double level_same = 0.05;       // chance of a false "same" in this look
  PermutationPlan permutation = {};
};

struct Look {
  Verdict verdict = Verdict::not_enough_runs;
  SampleTest test;
  Equivalence mean;
  // With not_enough_runs: per sample, beside those at hand; 1 or more.
  std::size_t more_for_difference = 0;  // of the size seen
  std::size_t more_for_same = 0;
};

// One look at two samples, a: the reference, b: what is judged; equal seeds first to last. Of a
// margin of 0 nothing is ever "same".
Look look_at(std::span<const double> a, std::span<const double> b, double margin,
             const LookPlan& plan);

}  // namespace brickbench::statistics
