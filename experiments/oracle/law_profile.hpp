// Law profile: which law of mechanics a recorded run breaks, by how much, when, and between which
// bodies. Everything follows from states, wrenches and the World: it works for any engine.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adapters/seam/scheme.hpp"
#include "experiments/oracle/recorder.hpp"

namespace brickbench::gate {

struct Violation {
  std::string law;   // contact_impulse, energy, penetration, momentum
  std::string unit;  // of worst and total
  double worst = 0.0;
  double total = 0.0;         // sum over the steps looked at; penetration: mean
  double proven = 0.0;        // lower bound of worst, where a certificate gives one
  std::size_t steps = 0;      // in which the law was broken beyond the allowance
  std::size_t looked_at = 0;  // steps
  double worst_time_s = 0.0;  // end of the worst step
  std::string body_a = {};    // of the worst step
  std::string body_b = {};
  double allowance = 0.0;  // of the worst step
};

struct LawPlan {
  std::size_t stride = 1;        // judge contact impulses at every stride-th step
  double impulse_share = 1e-3;   // allowance, of the weight times step of all moving bodies
  double overlap_share = 1e-3;   // allowance, of the smallest edge of all moving bodies
  std::optional<Scheme> scheme;  // that the engine states
  double rounding = 1e-12;       // of the engine's numbers, summed over a step; see energy law
};

// What an adapter states about itself for these settings.
LawPlan law_plan(const Adapter& adapter, const Settings& settings, std::size_t stride);

// The four laws, in this order:
//  contact_impulse  momentum that no admissible contact impulses explain, N s (impulse_oracle.hpp)
//  energy           gained beyond the work of the wrenches, J; the allowance is what the stated
//                   scheme gains in free flight (energy_allowance_j, step_laws.hpp), else the most
//                   that any scheme known here gains
//  penetration      depth of the deepest overlap, m
//  momentum         of all moving bodies together that no contact with a fixed body can have given,
//                   N s (external_excess_ns, step_laws.hpp); the allowance is rounding. Bodies are
//                   named only where they are two.
// `allowance` is that of the worst step.
std::vector<Violation> law_profile(const Scene& scene, const Recording& recording,
                                   const LawPlan& plan);

// The law broken in the largest share of the steps looked at; nullptr if none was.
const Violation* broken_most(const std::vector<Violation>& profile);

}  // namespace brickbench::gate
