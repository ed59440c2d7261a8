// Law profile: which law of mechanics a recorded run breaks, by how much, when, and between which
// bodies. Everything follows from states, wrenches and the World: it works for any engine.
#pragma once

#include <string>

#include "experiments/gate/recorder.hpp"

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
  double allowance = 0.0;  // per step; see the functions
};

struct LawPlan {
  std::size_t stride = 1;       // judge contact impulses at every stride-th step
  double impulse_share = 1e-3;  // allowance, of the weight times step of all moving bodies
};

// The four laws, in this order:
//  contact_impulse  momentum that no admissible contact impulses explain, N s (impulse_oracle.hpp)
//  energy           rises beyond the work of the wrenches and the discretisation term, J: a scheme
//  that
//                   moves with the new velocity under gravity g has, in free fall, exactly
//                   dE = -h^2 m g^2 / 2 per step, and one that moves with the old velocity exactly
//                   + h^2 m g^2 / 2; the allowance is that second, larger number, summed over the
//                   bodies
//  penetration      depth of the deepest overlap, m; nothing allowed
//  momentum         of all moving bodies along the horizontal, which only a fixed body can change:
//                   the change that friction of the fixed bodies cannot explain, N s; the allowance
//                   is rounding. Bodies are named only where they are two.
std::vector<Violation> law_profile(const Scene& scene, const Recording& recording,
                                   const LawPlan& plan);

}  // namespace brickbench::gate
