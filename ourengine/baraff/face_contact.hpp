// The contacts of two touching faces: the corners of their overlap polygon (see collision.hpp).
#pragma once

#include <vector>

#include "ourengine/baraff/collision.hpp"

namespace ourengine::baraff {

// Of the thinnest half extent: corners this close are one.
inline constexpr double k_border_share = 1e-6;

// `reference` owns the face along its axis `face` with outward unit normal `outward`; the face of
// `incident` most opposed to it is the other one. Contacts within tolerance_m are appended.
void add_face_contacts(std::span<const RigidBody> bodies, std::size_t reference, int face,
                       const Eigen::Vector3d& outward, std::size_t incident, double tolerance_m,
                       std::vector<Collision>& collisions);

}  // namespace ourengine::baraff
