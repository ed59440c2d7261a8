// The contacts of two touching faces: the corners of their overlap polygon (see collision.hpp).
#pragma once

#include <vector>

#include "ourengine/baraff/collision.hpp"

namespace ourengine::baraff {

// `reference` owns the face along its axis `face` with outward unit normal `outward`; the face of
// `incident` most opposed to it is the other one. Contacts within tolerance_m are appended.
void add_face_contacts(std::span<const RigidBody> bodies, std::size_t reference, int face,
                       const Eigen::Vector3d& outward, std::size_t incident, double tolerance_m,
                       std::vector<Collision>& collisions);

}  // namespace ourengine::baraff
