// What there is to say of a scene before any engine has seen it: what touches what, and what is
// suspicious about it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/scenarios/scenario.hpp"

namespace brickbench {

// Two bodies, not both fixed, that touch or overlap at the start.
struct Touch {
  std::size_t body_a = 0;  // indices into World::bodies, a < b
  std::size_t body_b = 0;
  double depth_m = 0.0;  // of the overlap; 0: they touch
  bool overlap = false;  // by more than rounding: k_overlap_share
  bool inside = false;   // one lies wholly within the other
  ContactLaw law;
};

// Touching means: nearer than k_overlap_share of the smaller one's greatest half extent.
std::vector<Touch> touches_at_start(const World& world);

// The longest step (s) in which no body moves by more than half its thickness, by the velocities of
// the start and by the blows; infinite where nothing moves.
double longest_step_s(const Scene& scene);

// One suspicion, with its numbers.
struct Doubt {
  std::string kind;  // overlap, inside, mass_ratio, inertia, not_solid, size_ratio, step
  std::string text;  // one sentence
  std::string unit;
  double value = 0.0;
  double limit = 0.0;  // that the value exceeds
  std::vector<std::string> bodies;
};

// What is suspicious, the worst of its kind first. `step_s`: of the run that is meant, if any.
std::vector<Doubt> doubts(const Scene& scene, std::optional<double> step_s);

}  // namespace brickbench
