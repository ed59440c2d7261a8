// Collision detection by separating axes, and the collision record.
//
// Source: H. Darji, P. Alur, Explosion Simulator, "Collision Detection" (AddCollision,
// IntersectsWhenProjected, struct Collision); D. Baraff, Rigid Body Simulation II, section 8,
// struct Contact; S. Gottschalk, M. Lin, D. Manocha, OBBTree (1996), for the 15 axes.
// Departures, where the paper is silent:
//  * An axis counts as separating from a gap of `tolerance_m` on: touching bricks are in contact.
//    Where the least gap is one, all points that are open by at most tolerance_m more count: of a
//    face that is just in reach all corners or none.
//  * Of the axes the one with the largest gap is the normal. An edge axis must win by 1e-3 of the
//    thinnest brick, a face of the second body by as much over one of the first: otherwise rounding
//    would turn half of all resting faces into a single edge contact.
//  * Two faces touch in the corners of their overlap polygon: corners of one face over the other
//    are vertex-face contacts of that corner, crossings of two sides are edge-edge contacts.
//    Corners within 1e-6 of the thinnest brick of each other are one.
//  * Spheres, see ball_contact.hpp.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "ourengine/baraff/body.hpp"

namespace ourengine::baraff {

// The feature of obj2 that a sphere, obj1, touches; see ball_contact.hpp.
enum class BallOn { none, face, edge, corner, centre };

struct Collision {
  std::size_t obj1 = 0;                             // the body with the vertex, or the sphere
  std::size_t obj2 = 0;                             // the body with the face
  Eigen::Vector3d location;                         // world, m
  Eigen::Vector3d normal;                           // unit, from obj2 towards obj1
  Eigen::Vector3d edge1 = Eigen::Vector3d::Zero();  // unit edge directions, edge-edge alone
  Eigen::Vector3d edge2 = Eigen::Vector3d::Zero();  // also the edge that a sphere touches
  bool vertex_face = true;
  BallOn ball = BallOn::none;
  double gap_m = 0.0;       // negative: penetration
  double met_mps = 0.0;     // relative normal velocity before the response, filled in by the step
  double impulse_ns = 0.0;  // along the normal on obj1, filled in by the response
};

// The axis of largest gap of two boxes: 0..2 faces of a, 3..5 faces of b, 6 + 3 i + j edge i of a
// with edge j of b.
struct Axis {
  double gap_m = 0.0;
  int index = 0;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  // unit, from a towards b
};

// Gap (m) between the projections of two boxes on a unit axis; the paper's question is gap <= 0.
double gap_when_projected(const RigidBody& a, const RigidBody& b, const Eigen::Vector3d& axis);
bool intersects_when_projected(const RigidBody& a, const RigidBody& b, const Eigen::Vector3d& axis,
                               double tolerance_m);

// Tests all axes (edge pairs with |a x b|^2 < 1e-6 are parallel and have none).
Axis separating_axis(const RigidBody& a, const RigidBody& b);

// Appends the contacts of bodies i and j if their least gap is at most tolerance_m.
void add_collision(std::span<const RigidBody> bodies, std::size_t i, std::size_t j,
                   double tolerance_m, std::vector<Collision>& collisions);

// All contacts of all pairs with a body that can move, in the order of the pairs.
void find_collisions(std::span<const RigidBody> bodies, double tolerance_m,
                     std::vector<Collision>& collisions);

}  // namespace ourengine::baraff
