// Two bodies of the model against each other: which shapes meet how.
#pragma once

#include "ourengine/collision/broad_phase.hpp"
#include "ourengine/collision/manifold.hpp"
#include "ourengine/model/body_model.hpp"

namespace ourengine {

// Radius of the smallest ball about the centre that holds the shape; infinite for a plane.
double bounding_radius_m(const Geometry& geometry);

// The smallest edge or the diameter (m); infinite for a plane.
double thickness_m(const Geometry& geometry);

// World box around the shape, margin_m larger on every side.
Aabb bounds(const Geometry& geometry, const Motion& motion, double margin_m);

// The manifold of two bodies where they are: points with gap <= margin_m, normal from a to b.
Manifold collide(const BodyModel& a, const Motion& at_a, const BodyModel& b, const Motion& at_b,
                 double margin_m);

// The manifold where the bodies first meet within step_s if both keep their velocity and attitude,
// with gaps counted back to where they are now (conservative advancement: B. Mirtich,
// Impulse-based Dynamic Simulation of Rigid Body Systems, thesis, Berkeley 1996, section 2.3).
Manifold collide_fast(const BodyModel& a, const Motion& at_a, const BodyModel& b,
                      const Motion& at_b, double step_s, double margin_m);

// collide(), or collide_fast() where the two may approach by a good part of their thickness within
// the step. approach_m: how far that is at most.
Manifold collide_within_step(const BodyModel& a, const Motion& at_a, const BodyModel& b,
                             const Motion& at_b, double step_s, double approach_m, double margin_m);

}  // namespace ourengine
