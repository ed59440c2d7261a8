// Forward Euler on the four equations of the paper: x' = v, q' = (0, w) q / 2, P' = F, L' = tau.
//
// Source: H. Darji, P. Alur, Explosion Simulator, "Rigid body Physics"; D. Baraff, Rigid Body
// Simulation I, ddt_state_to_array(). Departure: the quaternion is scaled back to length 1.
#pragma once

#include "ourengine/baraff/body.hpp"

namespace ourengine::baraff {

// All right-hand sides are taken at the start of the step; derived quantities are those of the end.
void forward_euler(RigidBody& body, double step_s);

}  // namespace ourengine::baraff
