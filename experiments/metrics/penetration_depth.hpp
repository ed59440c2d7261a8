// How deep two shapes overlap, computed from their poses alone by code that no engine shares.
//
// The depth is the length of the shortest translation that separates the interiors: the distance
// from the origin to the boundary of the Minkowski difference (Cameron and Culley, Determining the
// minimum translational distance between two convex polyhedra, ICRA 1986). For convex polytopes the
// nearest boundary point lies on a facet, and the facets of the difference have as normals a face
// normal of one body or the cross product of an edge of each (de Berg et al., Computational
// Geometry, section 13.3; Gottschalk, Lin, Manocha, OBBTree, SIGGRAPH 1996: the same 15 axes for
// boxes). The other candidates are supporting planes, never nearer than the boundary, so for two
// boxes
//   depth = min over 15 unit axes L of  sum_i a_i |A_i.L| + sum_i b_i |B_i.L| - |t.L|,
// exactly, contained boxes included.
#pragma once

#include "adapters/seam/world.hpp"

namespace brickbench {

// Depth (m) >= 0; 0 where the shapes touch or are apart. Symmetric in its arguments. Two planes
// have no finite depth and must not be asked.
//
// Edges closer to parallel than 1e-8 rad are left out and just above that the axis loses digits to
// cancellation: either way the depth is off by less than 1e-7 of the bodies' size.
double penetration_depth_m(const Shape& a, const State& at_a, const Shape& b, const State& at_b);

}  // namespace brickbench
