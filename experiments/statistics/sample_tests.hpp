// Two-sample tests that assume nothing about the distributions: p-values by relabelling.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace brickbench::statistics {

struct SampleTest {
  double statistic = 0.0;
  double p_value = 1.0;          // of "both samples come from one distribution"
  std::size_t permutations = 0;  // relabellings that were looked at
  bool exact = false;            // all that there are
};

// What bounds the work. Where all relabellings are at most `enumerated`, they are all looked at and
// p is exact. Otherwise at most `permutations` of them are drawn; fewer once `exceedances` were at
// least as extreme as the samples themselves, which is when p cannot become small any more (Besag
// and Clifford, Sequential Monte Carlo p-values, Biometrika 78, 1991, equation 2). A drawn p is
// never below the smallest that enumeration could give.
struct PermutationPlan {
  std::size_t permutations = 20000;
  std::size_t exceedances = 20;
  std::uint64_t seed = 1;
  std::size_t enumerated = 200000;  // 10 against 10 have 184 756
};

// How many ways there are to draw a sample of `count_a` from both together; infinite beyond the
// range of double.
double relabellings(std::size_t count_a, std::size_t count_b);

// The smallest p-value that samples of these sizes can have: that of ranges that do not overlap.
// Samples of equal size have it twice, with the names exchanged.
double least_p(std::size_t count_a, std::size_t count_b);

// Relabellings to draw, at least `least`, so that a p-value can reach `level`; a fifth more than
// that, so that ties leave room.
std::size_t relabellings_for(double level, std::size_t least);

// Twice the integral of (F_a - F_b)^2 over the line: the energy distance of two samples (Szekely
// and Rizzo, Energy statistics, J. Stat. Planning and Inference 143, 2013, section 2). Unit of the
// values. Samples are not empty and finite.
double energy_distance(std::span<const double> a, std::span<const double> b);

SampleTest energy_test(std::span<const double> a, std::span<const double> b,
                       const PermutationPlan& plan);

}  // namespace brickbench::statistics
