// How long a step may be before two bodies could be deeper in each other than they should.
//
// Contacts are looked for where a step starts. A step in which bodies pass each other, or turn far,
// would find them on the wrong side or not at all, so it is cut: a conservative advancement (B.
// Mirtich, Impulse-based dynamic simulation of rigid body systems, 1996, section 2.3) that stops
// inside the overlap instead of before it. Along the direction n of a pair's contact, no point of a
// body at r from its centre moves further than t n . v + t^2 / 2 (n . a + |n x w| |w| r + |w'| r).
#pragma once

#include <span>

#include "ourengine/baraff/collision.hpp"

namespace ourengine::baraff {

// Time (s), at most step_s, through which no pair can get deeper than `depth_share` of its thinner
// body, beyond where it is. Reads velocities, forces and torques. step_s where depth_share is 0.
double safe_step_s(std::span<const RigidBody> bodies, double step_s, double depth_share);

}  // namespace ourengine::baraff
