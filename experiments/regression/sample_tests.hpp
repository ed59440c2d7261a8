// Two-sample tests that assume nothing about the distributions: p-values by permutation, seeded.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace brickbench::gate {

struct SampleTest {
  double statistic = 0.0;
  double p_value = 1.0;          // of "both samples come from one distribution"
  std::size_t permutations = 0;  // that were drawn
};

// What bounds the work: at most `permutations` relabellings; fewer once `exceedances` of them were
// at least as extreme as the samples themselves, which is when p cannot become small any more
// (Besag and Clifford, Sequential Monte Carlo p-values, Biometrika 78, 1991, equation 2).
struct PermutationPlan {
  std::size_t permutations = 20000;
  std::size_t exceedances = 20;
  std::uint64_t seed = 1;
};

// Relabellings, at least `least`, with which the smallest p-value can be rejected at `level` in a
// family of `tests` under Holm's procedure; a fifth more than that, so that ties leave room.
std::size_t relabellings_for(std::size_t tests, double level, std::size_t least);

// Twice the integral of (F_a - F_b)^2 over the line: the energy distance of two samples (Szekely
// and Rizzo, Energy statistics, J. Stat. Planning and Inference 143, 2013, section 2). Unit of the
// values. Samples are not empty and finite.
double energy_distance(std::span<const double> a, std::span<const double> b);

SampleTest energy_test(std::span<const double> a, std::span<const double> b,
                       const PermutationPlan& plan);
// Which hypotheses are rejected so that the chance of any false rejection is at most `alpha`,
// whatever the dependence (Holm, A simple sequentially rejective multiple test procedure, Scand. J.
// Statistics 6, 1979). Order of `p_values`.
std::vector<bool> holm(std::span<const double> p_values, double alpha);

}  // namespace brickbench::gate
