// Extents of bodies and worlds, as the hunt's bounds need them.
#pragma once

#include "adapters/seam/world.hpp"

namespace brickbench::hunt {

// Largest distance of a body's surface from its centre, m; 0 for a plane.
double reach_m(const Shape& shape);
// Smallest edge or diameter, m; infinite for a plane.
double thinnest_m(const Shape& shape);
// Of all bodies that can move.
double thinnest_m(const World& world);
// Largest coefficients of any pair.
ContactLaw greatest_law(const World& world);
bool has_fixed(const World& world);
std::size_t moving_count(const World& world);

// When the bounding spheres of a moving body and another meet first, s, by gravity and the first
// velocities alone, or about it; infinite where none does.
double soonest_meeting_s(const World& world);

// Speed of the fastest point of the body, m/s.
double fastest_point_mps(const Body& body, const State& state);

}  // namespace brickbench::hunt
