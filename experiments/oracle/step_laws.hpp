// Two laws that one recorded step must obey, whatever the engine: what the fixed bodies can have
// given, and what energy the step may gain.
#pragma once

#include <optional>

#include "adapters/seam/scheme.hpp"
#include "adapters/seam/world.hpp"
#include "experiments/oracle/impulse_oracle.hpp"

namespace brickbench::gate {

// Momentum of all moving bodies together, N s, that neither gravity, nor wrenches, nor the fixed
// bodies can have given: the distance of the change to the set of sums of impulses inside the
// Coulomb cones of the contacts with fixed bodies, whatever their slope. Impulses between moving
// bodies cancel. `gap_ns`: how far above the true distance the answer may be.
double external_excess_ns(const World& world, const StepRecord& record, double gap_ns);

// Kinetic energy and potential of gravity of the moving bodies, J.
double energy_j(const World& world, std::span<const State> states);

// Energy, J, that the step gained beyond the work of its wrenches; negative: lost. The work is
// taken with the mean velocity of the step: exact for the kinetic energy that a held force gives.
double energy_gain_j(const World& world, const StepRecord& record);

// What the discretisation may add to the energy in this step without any contact, J. In free
// fall, with m the mass, h the step and g gravity:
//   old_velocity         + m g^2 h^2 / 2, exactly
//   new_velocity         - m g^2 h^2 / 2, exactly: nothing is allowed. A contact impulse p changes
//                        the energy by p v+ - m |dv|^2 / 2 there, which is not positive either
//                        unless the impulse separates faster than it was approached
//   mean_velocity, mean_unless_pushed, runge_kutta_4: 0
// Rotation, with w x I w the gyroscopic torque, in body axes:
//   explicit_body        + h^2 (w x I w) I^-1 (w x I w) / 2, exactly
//   neglected            0: turning about w itself leaves w in the body as it is
//   frozen_momentum      never positive: w+ (I w+ - I w) = 0
//   the others           the second-order size of the first, as a bound
// No scheme stated: the largest of all these. Beside that, `rounding` of the kinetic energy and of
// the weight times the height.
double energy_allowance_j(const World& world, const StepRecord& record,
                          const std::optional<Scheme>& scheme, double rounding);

}  // namespace brickbench::gate
