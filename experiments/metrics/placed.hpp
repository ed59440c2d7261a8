// A shape at a pose, unpacked for overlap queries.
#pragma once

#include "adapters/seam/world.hpp"

namespace brickbench {

enum class PlacedKind { box, sphere, plane };

struct Placed {
  PlacedKind kind = PlacedKind::box;
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // columns: body axes in the world frame
  Eigen::Vector3d half_m = Eigen::Vector3d::Zero();    // box: half edges; sphere: three radii
};

// The quaternion's length is divided out.
Placed place(const Shape& shape, const State& state);

// Half the edges (m) of the smallest box along the world axes; not for planes.
Eigen::Vector3d reach_m(const Placed& placed);

// The depth (m) as in penetration_depth.hpp if it is above `floor_m` (>= 0), else some number <=
// floor_m: a pair that cannot be the worst costs one or two projections.
double depth_above_m(const Placed& a, const Placed& b, double floor_m);

}  // namespace brickbench
