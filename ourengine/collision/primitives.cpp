// Manifolds of spheres and planes. Contracts in manifold.hpp.
#include <algorithm>
#include <cmath>

#include "ourengine/collision/manifold.hpp"

namespace ourengine {

Manifold box_sphere(const PosedBox& a, const PosedSphere& b, double margin_m) {
  Manifold manifold;
  const Eigen::Vector3d local = a.axes.transpose() * (b.centre_m - a.centre_m);
  const Eigen::Vector3d closest = local.cwiseMax(-a.half_m).cwiseMin(a.half_m);
  const Eigen::Vector3d outward = local - closest;
  const double distance = outward.norm();
  if (distance - b.radius_m > margin_m) return manifold;
  if (distance > 0.0) {
    manifold.normal = a.axes * (outward / distance);
    const double gap = distance - b.radius_m;
    manifold.add(a.centre_m + a.axes * closest + 0.5 * gap * manifold.normal, gap);
    return manifold;
  }
  // The centre is inside: leave through the nearest face.
  Eigen::Index face = 0;
  const double depth = (a.half_m - local.cwiseAbs()).minCoeff(&face);
  manifold.normal = (local[face] >= 0.0 ? 1.0 : -1.0) * a.axes.col(face);
  const double gap = -depth - b.radius_m;
  manifold.add(b.centre_m + (depth + 0.5 * gap) * manifold.normal, gap);
  return manifold;
}

Manifold sphere_sphere(const PosedSphere& a, const PosedSphere& b, double margin_m) {
  Manifold manifold;
  const Eigen::Vector3d between = b.centre_m - a.centre_m;
  const double distance = between.norm();
  const double gap = distance - a.radius_m - b.radius_m;
  if (gap > margin_m) return manifold;
  if (distance > 0.0) manifold.normal = between / distance;
  manifold.add(a.centre_m + (a.radius_m + 0.5 * gap) * manifold.normal, gap);
  return manifold;
}

Manifold plane_box(const PosedPlane& a, const PosedBox& b, double margin_m) {
  Manifold manifold;
  manifold.normal = a.normal;
  const Eigen::Vector3d along = b.axes.transpose() * a.normal;
  const double centre_height = a.normal.dot(b.centre_m - a.point_m);
  if (centre_height - along.cwiseAbs().dot(b.half_m) > margin_m) return manifold;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d local((corner & 1) != 0 ? b.half_m.x() : -b.half_m.x(),
                                (corner & 2) != 0 ? b.half_m.y() : -b.half_m.y(),
                                (corner & 4) != 0 ? b.half_m.z() : -b.half_m.z());
    const double gap = centre_height + along.dot(local);
    if (gap > margin_m) continue;
    manifold.add(b.centre_m + b.axes * local - 0.5 * gap * a.normal, gap);
  }
  return manifold;
}

Manifold plane_sphere(const PosedPlane& a, const PosedSphere& b, double margin_m) {
  Manifold manifold;
  manifold.normal = a.normal;
  const double gap = a.normal.dot(b.centre_m - a.point_m) - b.radius_m;
  if (gap > margin_m) return manifold;
  manifold.add(b.centre_m - (b.radius_m + 0.5 * gap) * a.normal, gap);
  return manifold;
}

}  // namespace ourengine
