// The discrete map of contacts as impulses on the velocity: rows with targets, solved together.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "adapters/seam/scheme.hpp"
#include "experiments/exact/exact_case.hpp"

namespace brickbench::exact {

// Normal velocity (m/s) that the step must at least reach at a contact whose gap (m) and normal
// velocity (m/s, before this step's forces) are given; -infinity where no contact row exists.
double target_velocity_mps(const ImpulseContact& contact, double restitution, double gap_m,
                           double velocity_mps, double step_s);

// Advances all states (bodies) by one step with the contacts of its start; false, with a reason,
// where the scheme leaves it open.
bool advance_impulse(const Scheme& scheme, const ExactRun& run, std::span<const Wrench> wrenches,
                     const std::vector<PointContact>& contacts, std::span<State> states,
                     std::string& why);

}  // namespace brickbench::exact
