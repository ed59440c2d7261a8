#include "ourengine/baraff/ball_contact.hpp"

#include <cmath>

#include "ourengine/model/by_kind.hpp"

namespace ourengine::baraff {
namespace {

void add_ball_box(const RigidBody& box, Collision contact, const Eigen::Vector3d& centre_m,
                  double radius_m, double tolerance_m, std::vector<Collision>& collisions) {
  const Eigen::Vector3d& half = std::get<Box>(box.solid).half_m;
  const Eigen::Vector3d local = box.rotation.transpose() * (centre_m - box.position_m);
  Eigen::Vector3d closest = local.cwiseMax(-half).cwiseMin(half);
  Eigen::Vector3d away = local - closest;
  double distance_m = away.norm();
  const int outside = static_cast<int>((away.array() != 0.0).count());
  if (outside == 0) {
    int face = 0;
    distance_m = (local.cwiseAbs() - half).maxCoeff(&face);
    away = std::copysign(1.0, local[face]) * Eigen::Vector3d::Unit(face);
    closest -= distance_m * away;
  } else {
    away /= distance_m;
  }
  contact.gap_m = distance_m - radius_m;
  if (contact.gap_m > tolerance_m) return;
  contact.normal = box.rotation * away;
  contact.location = box.position_m + box.rotation * closest;
  contact.ball = outside == 3 ? BallOn::corner : outside == 2 ? BallOn::edge : BallOn::face;
  if (outside == 2) {
    int along = 0;
    away.cwiseAbs().minCoeff(&along);
    contact.edge2 = box.rotation.col(along);
  }
  collisions.push_back(contact);
}

}  // namespace

void add_ball_contact(std::span<const RigidBody> bodies, std::size_t ball, std::size_t other,
                      double tolerance_m, std::vector<Collision>& collisions) {
  const Eigen::Vector3d& centre_m = bodies[ball].position_m;
  const double radius_m = std::get<Sphere>(bodies[ball].solid).radius_m;
  const RigidBody& partner = bodies[other];
  Collision contact;
  contact.obj1 = ball;
  contact.obj2 = other;
  const auto keep_near = [&] {
    if (contact.gap_m <= tolerance_m) collisions.push_back(contact);
  };
  by_kind(
      partner.solid,
      [&](const Box&) {
        add_ball_box(partner, contact, centre_m, radius_m, tolerance_m, collisions);
      },
      [&](const Sphere& ball_too) {
        const Eigen::Vector3d apart = centre_m - partner.position_m;
        const double distance_m = apart.norm();
        contact.normal = distance_m > 0.0 ? (apart / distance_m).eval() : Eigen::Vector3d::UnitZ();
        contact.location = partner.position_m + ball_too.radius_m * contact.normal;
        contact.gap_m = distance_m - radius_m - ball_too.radius_m;
        contact.ball = BallOn::centre;
        keep_near();
      },
      [&](const Plane&) {
        const double height_m = partner.rotation.col(2).dot(centre_m - partner.position_m);
        contact.normal = partner.rotation.col(2);
        contact.location = centre_m - height_m * contact.normal;
        contact.gap_m = height_m - radius_m;
        contact.ball = BallOn::face;
        keep_near();
      });
}

}  // namespace ourengine::baraff
