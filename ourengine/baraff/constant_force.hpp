// A step of a rigid body under a force and a torque that are held over it.
#pragma once

#include "ourengine/baraff/body.hpp"

namespace ourengine::baraff {

// P += h force, L += h torque, and v, w follow; the pose stays. Nothing happens to a fixed body.
void push(RigidBody& body, double step_s);

// P and L as in push(); x += h (v + v+) / 2, which is exact; the attitude turns with the momentum
// of the middle, L + h/2 torque, by the discrete Moser-Veselov map (rotation.hpp): without a torque
// the energy stays to rounding. A fixed body stays.
void constant_force(RigidBody& body, double step_s);

}  // namespace ourengine::baraff
