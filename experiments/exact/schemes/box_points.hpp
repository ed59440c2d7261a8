// Where two boxes touch, in the order in which separating axes and clipped faces list the points.
#pragma once

#include <limits>
#include <vector>

#include "adapters/seam/scheme.hpp"
#include "adapters/seam/shape.hpp"

namespace brickbench::exact {

// The box that the shape is, or nullptr: the maps of boxes decline everything else.
const BoxShape* box_of(const Shape& shape);

struct BoxPoint {
  Eigen::Vector3d on_b_m = Eigen::Vector3d::Zero();  // world, on the surface of b
  double gap_m = 0.0;                                // along BoxPoints::normal; < 0: overlap
};

struct BoxPoints {
  double gap_m = -std::numeric_limits<double>::infinity();  // of the axis: a bound of the distance
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();        // unit, world, from a to b
  std::vector<BoxPoint> points;                             // whatever their gap
};

// The axis is that of the largest gap among the faces of a; a face of b must exceed it by the bias
// of the rule, and so must the cross product of two edges. Then the corners of the most opposed
// face of the other box, from (+, +) of its next two axes around, cut at the borders (+u, -u, +v,
// -v) of the first one's face; or the point midway between the two edges. Sources: S. Gottschalk,
// M. Lin, D. Manocha, OBBTree, SIGGRAPH 1996, section 5; I. Sutherland, G. Hodgman, Reentrant
// polygon clipping, CACM 17, 1974.
BoxPoints box_points(const BoxPlaces& rule, const Eigen::Vector3d& half_a_m, const State& at_a,
                     const Eigen::Vector3d& half_b_m, const State& at_b);

}  // namespace brickbench::exact
