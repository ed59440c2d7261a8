// The discrete map of contacts as impulses on the velocity: rows with targets, solved together.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "adapters/seam/scheme.hpp"
#include "experiments/exact/cases/exact_case.hpp"

namespace brickbench::exact {

// Normal velocity (m/s) that the step must at least reach at a contact whose gap (m) and normal
// velocity (m/s, before this step's forces) are given; -infinity where no contact row exists.
double target_velocity_mps(const ImpulseContact& contact, double restitution, double gap_m,
                           double velocity_mps, double step_s);

// The contacts of the run where a plane sees one corner of a box per step, the one furthest along
// its inward normal (the positive end of an axis that is level), and keeps those it has seen: up to
// law.plane_reach_share of half the box's diagonal above it and off the place where each was seen
// last. Remembers: to be asked once per step, from the first on. Source: Coumans, Bullet 3.24,
// btConvexPlaneCollisionAlgorithm::collideSingleContact, btPersistentManifold::getCacheEntry and
// refreshContactPoints, btBoxShape::localGetSupportingVertex. law and run must outlive it.
ContactGeometry corner_by_corner(const ImpulseContact& law, const ExactRun& run);

// Advances all states (bodies) by one step with the contacts of its start; false, with a reason,
// where the scheme leaves it open.
bool advance_impulse(const Scheme& scheme, const ExactRun& run, std::span<const Wrench> wrenches,
                     const std::vector<PointContact>& contacts, std::span<State> states,
                     std::string& why);

}  // namespace brickbench::exact
