// The contact of a sphere with a plane, a box or another sphere.
//
// The paper has bricks alone; its derivation holds for spheres once the contact is read as a
// vertex, the centre of the sphere, that keeps the distance of a radius: from a face, an edge or a
// corner of a box (the feature closest to the centre), or from another centre. The force acts along
// the line of both points, so A and the impulses need nothing new; the turning normal does, see
// compute_ndot(). A centre inside a box is pushed out through the closest face.
#pragma once

#include <vector>

#include "ourengine/baraff/collision.hpp"

namespace ourengine::baraff {

// Body `ball` is a sphere, `other` a plane, box or sphere. Appends the contact if its gap is at
// most tolerance_m; `ball` is obj1, and the location is on the surface of `other`.
void add_ball_contact(std::span<const RigidBody> bodies, std::size_t ball, std::size_t other,
                      double tolerance_m, std::vector<Collision>& collisions);

}  // namespace ourengine::baraff
