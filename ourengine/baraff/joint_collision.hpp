// Impulses for contacts that collide at the same time, in groups.
//
// Hit one after the other, the corners of two faces that meet squarely throw each other up: the
// first impulse turns the bodies, and what then leaves too fast is never held back. So all points
// of a pair of bodies are hit at once, and so are all contacts of restitution 0 of the scene;
// groups follow each other in sweeps, as single contacts do in colliding_contact(): in a row of
// balls the last one leaves.
//
// Within a group Newton's law holds for all contacts together (J. J. Moreau, Unilateral contact and
// dry friction in finite freedom dynamics, 1988, section 10), v before, v+ after, e one number:
//   j >= 0, v+ + e v >= 0, j . (v+ + e v) = 0, v+ = v + A j.
// It follows that the energy changes by -(1 - e) / (1 + e) j . A j / 2, which is never positive.
#pragma once

#include <span>

#include "ourengine/baraff/colliding_contact.hpp"

namespace ourengine::baraff {

// Sweeps over the groups, resolving each in which a contact collides, until there is none. Returns
// what colliding_contact() does. A group whose solve fails is hit contact after contact.
int collide_in_groups(std::span<RigidBody> bodies, std::span<Collision> contacts,
                      const RestitutionTable& restitution, double threshold_mps, int max_sweeps);

}  // namespace ourengine::baraff
