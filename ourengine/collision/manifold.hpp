// Contact manifolds with gaps: where two shapes touch, or would touch within a margin.
//
// Unlike the paper's collision record, which knows touching bodies only, a manifold also holds
// points that are still apart (gap_m > 0), so that a velocity-level solver can stop a body at the
// surface instead of pushing it out again (speculative contact).
//
// Frames and units: world frame, SI. The normal points from shape a to shape b.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>

namespace ourengine {

// Of the thinnest edge of the two boxes: how much an edge axis must win by, and how much a face of
// b must win over a face of a, so that rounding never changes the kind of a resting contact.
inline constexpr double k_axis_bias = 1e-3;
// |a x b|^2 below this: the edges are parallel and their cross product is no axis.
inline constexpr double k_parallel_edges = 1e-6;
// Of the thinnest edge: a corner this far outside a clipping plane still counts as inside, so that
// flush bricks keep their own corners.
inline constexpr double k_clip_slack = 1e-6;

// A box in the world: half extents along its axes, centre, axes as columns of a rotation matrix.
struct PosedBox {
  Eigen::Vector3d half_m;
  Eigen::Vector3d centre_m;
  Eigen::Matrix3d axes;
};

struct PosedSphere {
  Eigen::Vector3d centre_m;
  double radius_m;
};

// Solid on the side away from the normal: points x with normal . (x - point_m) <= 0.
struct PosedPlane {
  Eigen::Vector3d point_m;
  Eigen::Vector3d normal;
};

struct ManifoldPoint {
  Eigen::Vector3d position_m;  // midway between the two surfaces
  double gap_m;                // along the normal; < 0: overlap
};

struct Manifold {
  static constexpr int k_capacity = 8;  // a quadrilateral clipped by a rectangle has 8 corners
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  int count = 0;
  std::array<ManifoldPoint, k_capacity> points;

  void add(const Eigen::Vector3d& position_m, double gap_m) {
    if (count < k_capacity) points[static_cast<std::size_t>(count++)] = {position_m, gap_m};
  }
};

// Each function returns the points with gap <= margin_m; count == 0 where there are none.

// Separating axes (15), then the incident face clipped against the reference face, or one point
// between the two closest edges. An edge axis must win by k_axis_bias of the thinnest edge:
// between stacked bricks its normal is practically the face normal, and a manifold of one point
// instead of four would make the stack rock.
// Source: S. Gottschalk, M. Lin, D. Manocha, OBBTree, SIGGRAPH 1996, section 5 (axes);
// D. Baraff, An Introduction to Physically Based Modeling: Rigid Body Simulation II, 1997, section
// 7 (vertex-face and edge-edge contacts).
Manifold box_box(const PosedBox& a, const PosedBox& b, double margin_m);

// The point of the box closest to the centre of the sphere.
Manifold box_sphere(const PosedBox& a, const PosedSphere& b, double margin_m);
Manifold sphere_sphere(const PosedSphere& a, const PosedSphere& b, double margin_m);
// The corners of the box near the plane.
Manifold plane_box(const PosedPlane& a, const PosedBox& b, double margin_m);
Manifold plane_sphere(const PosedPlane& a, const PosedSphere& b, double margin_m);

// What the separating axes say of two boxes.
struct BoxSeparation {
  double gap_m;  // largest separation over the axes: exact depth if < 0, a lower bound of the
                 // distance if > 0
  int axis;      // 0..2 faces of a, 3..5 faces of b, 6 + 3 i + j edge i of a with edge j of b
  Eigen::Vector3d normal;  // unit, world, from a to b
};

// The axis that box_box() uses. Stops early, with a gap above margin_m, at the first axis that
// separates by more than that.
BoxSeparation separate(const PosedBox& a, const PosedBox& b, double margin_m);

}  // namespace ourengine
