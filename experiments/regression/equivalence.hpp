// Equivalence: not "no difference was found" but "the difference is smaller than this".
#pragma once

#include <span>

#include "experiments/regression/sample_tests.hpp"

namespace brickbench::gate {

// P(T <= t) for Student's distribution with `freedom` > 0 degrees of freedom, by the incomplete
// beta function (NIST Digital Library of Mathematical Functions, 8.17.22).
double student_cdf(double t, double freedom);
// The t with student_cdf(t, freedom) = probability, 0 < probability < 1.
double student_quantile(double probability, double freedom);

// Two one-sided tests of the means (Schuirmann, J. Pharmacokinetics and Biopharmaceutics 15, 1987)
// with variances that may differ (Welch).
struct Equivalence {
  double difference = 0.0;  // mean of b - mean of a
  double low = 0.0;         // confidence interval of the difference at 1 - 2 alpha
  double high = 0.0;
  bool equivalent = false;  // the interval lies within +-margin
  // Runs per sample with which equal means would be shown equivalent with probability 0.9, at the
  // spread seen here; at least the present number.
  std::size_t runs_needed = 0;
};

// At least two values each; margin > 0, in the unit of the values.
Equivalence equivalence(std::span<const double> a, std::span<const double> b, double margin,
                        double alpha);

enum class Verdict {
  identical,        // bit for bit, start by start
  same,             // equivalent within the margin
  different,        // not one distribution
  not_enough_runs,  // neither was shown
};

struct SequentialPlan {
  double alpha_different = 0.01;  // chance of a false "different", over all looks
  double alpha_same = 0.05;       // chance of a false "same", over all looks
  std::size_t looks = 1;          // how often the growing samples will be looked at
  PermutationPlan permutation = {};
};

struct Look {
  Verdict verdict = Verdict::not_enough_runs;
  SampleTest test;
  Equivalence mean;
  std::size_t more_runs = 0;  // with not_enough_runs: per sample, beside those at hand
};

// One look at two growing samples, a: the reference, b: what is judged; equal seeds first to last.
// Each look spends an equal share of both alphas, so that the chances hold however early one stops
// (Bonferroni over the looks: safe under any dependence between them).
Look look_at(std::span<const double> a, std::span<const double> b, double margin,
             const SequentialPlan& plan);

}  // namespace brickbench::gate
