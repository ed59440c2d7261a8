// Classification of contacts, and impulses for those that collide.
//
// Source: H. Darji, P. Alur, Explosion Simulator, "Collision Response" (CollisionType) and
// "Colliding Contact" (formula for j); D. Baraff, Rigid Body Simulation II, section 8, collision()
// and find_all_collisions().
// Departure: the sweeps over the contacts are counted and capped.
#pragma once

#include <span>
#include <vector>

#include "ourengine/baraff/collision.hpp"

namespace ourengine::baraff {

enum class ContactType { colliding, resting, separating };

// By relative normal velocity v: colliding below -threshold, separating above +threshold.
ContactType collision_type(std::span<const RigidBody> bodies, const Collision& contact,
                           double threshold_mps);

// Impulse (N s) along the normal on obj1:
//   j = -(1 + e) v / (1/Ma + 1/Mb + n . (Ia^-1 (ra x n)) x ra + n . (Ib^-1 (rb x n)) x rb).
double collision_impulse(std::span<const RigidBody> bodies, const Collision& contact,
                         double restitution);

// +j n on obj1 and -j n on obj2, at the contact.
void apply_collision(std::span<RigidBody> bodies, Collision& contact, double impulse_ns);

// Coefficients of restitution between kinds of surface: (kinds, kinds), symmetric.
using RestitutionTable = Eigen::MatrixXd;

// Sweeps over all contacts, resolving each that collides, until none does. Returns the sweeps that
// changed something, or max_sweeps + 1 if some contact still collides after max_sweeps.
int colliding_contact(std::span<RigidBody> bodies, std::span<Collision> contacts,
                      const RestitutionTable& restitution, double threshold_mps, int max_sweeps);

}  // namespace ourengine::baraff
