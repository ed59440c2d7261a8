#include "ourengine/baraff/collision.hpp"

#include <algorithm>
#include <cmath>

#include "ourengine/baraff/ball_contact.hpp"
#include "ourengine/baraff/face_contact.hpp"
#include "ourengine/model/by_kind.hpp"

namespace ourengine::baraff {
namespace {

constexpr double k_axis_bias = 1e-3;  // of the thinner box's thickness
constexpr double k_parallel_edges = 1e-6;

const Eigen::Vector3d& half(const RigidBody& body) { return std::get<Box>(body.solid).half_m; }

double reach(const RigidBody& body, const Eigen::Vector3d& axis) {
  return (body.rotation.transpose() * axis).cwiseAbs().dot(half(body));
}

// Largest gap of a point of a pair that touches and whose least gap is given: points that differ by
// rounding are all in or all out.
double touching_limit_m(double least_gap_m, double tolerance_m) {
  return std::max(least_gap_m, 0.0) + tolerance_m;
}

// Centre of the edge along axis i that reaches furthest towards `direction`.
Eigen::Vector3d supporting_edge(const RigidBody& body, int i, const Eigen::Vector3d& direction) {
  Eigen::Vector3d centre = body.position_m;
  for (int k = 0; k < 3; ++k) {
    if (k == i) continue;
    const double sign = direction.dot(body.rotation.col(k)) > 0.0 ? 1.0 : -1.0;
    centre += sign * half(body)[k] * body.rotation.col(k);
  }
  return centre;
}

void add_edge_contact(std::span<const RigidBody> bodies, std::size_t a, std::size_t b,
                      const Axis& axis, std::vector<Collision>& collisions) {
  const int i = (axis.index - 6) / 3;
  const int j = (axis.index - 6) % 3;
  const Eigen::Vector3d p = supporting_edge(bodies[a], i, axis.direction);
  const Eigen::Vector3d q = supporting_edge(bodies[b], j, -axis.direction);
  const Eigen::Vector3d d = bodies[a].rotation.col(i);
  const Eigen::Vector3d e = bodies[b].rotation.col(j);
  const Eigen::Vector3d n = d.cross(e);
  const double s = (q - p).cross(e).dot(n) / n.squaredNorm();
  const double t = (q - p).cross(d).dot(n) / n.squaredNorm();
  const Eigen::Vector3d on_a = p + std::clamp(s, -half(bodies[a])[i], half(bodies[a])[i]) * d;
  const Eigen::Vector3d on_b = q + std::clamp(t, -half(bodies[b])[j], half(bodies[b])[j]) * e;
  collisions.push_back({.obj1 = a,
                        .obj2 = b,
                        .location = 0.5 * (on_a + on_b),
                        .normal = -axis.direction,
                        .edge1 = d,
                        .edge2 = e,
                        .vertex_face = false,
                        .gap_m = axis.gap_m});
}

// All corners of the box that touch where the lowest one is within tolerance of the plane's surface
// or below it.
void add_box_plane(std::span<const RigidBody> bodies, std::size_t box, std::size_t plane,
                   double tolerance_m, std::vector<Collision>& collisions) {
  const RigidBody& body = bodies[box];
  const Eigen::Vector3d normal = bodies[plane].rotation.col(2);
  const double lowest_m =
      normal.dot(body.position_m - bodies[plane].position_m) - reach(body, normal);
  if (lowest_m > tolerance_m) return;
  const double limit_m = touching_limit_m(lowest_m, tolerance_m);
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    const Eigen::Vector3d at = body.position_m + body.rotation * sign.cwiseProduct(half(body));
    const double gap_m = normal.dot(at - bodies[plane].position_m);
    if (gap_m > limit_m) continue;
    collisions.push_back(
        {.obj1 = box, .obj2 = plane, .location = at, .normal = normal, .gap_m = gap_m});
  }
}

bool out_of_reach(const RigidBody& a, const RigidBody& b, double tolerance_m) {
  const double range = half(a).norm() + half(b).norm() + tolerance_m;
  return (a.position_m - b.position_m).squaredNorm() > range * range;
}

}  // namespace

double gap_when_projected(const RigidBody& a, const RigidBody& b, const Eigen::Vector3d& axis) {
  return std::abs(axis.dot(b.position_m - a.position_m)) - reach(a, axis) - reach(b, axis);
}

bool intersects_when_projected(const RigidBody& a, const RigidBody& b, const Eigen::Vector3d& axis,
                               double tolerance_m) {
  return gap_when_projected(a, b, axis) <= tolerance_m;
}

Axis separating_axis(const RigidBody& a, const RigidBody& b) {
  const double bias = k_axis_bias * 2.0 * std::min(half(a).minCoeff(), half(b).minCoeff());
  Axis best{-HUGE_VAL, 0, Eigen::Vector3d::UnitX()};
  double to_beat = -HUGE_VAL;
  const auto consider = [&](int index, const Eigen::Vector3d& axis) {
    const double gap = gap_when_projected(a, b, axis);
    if (gap <= to_beat) return;
    const double sign = axis.dot(b.position_m - a.position_m) >= 0.0 ? 1.0 : -1.0;
    best = {gap, index, sign * axis};
    to_beat = gap;
  };
  for (int i = 0; i < 3; ++i) consider(i, a.rotation.col(i));
  to_beat = best.gap_m + bias;
  for (int i = 0; i < 3; ++i) consider(3 + i, b.rotation.col(i));
  to_beat = best.gap_m + bias;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector3d axis = a.rotation.col(i).cross(b.rotation.col(j));
      if (axis.squaredNorm() >= k_parallel_edges) consider(6 + 3 * i + j, axis.normalized());
    }
  }
  return best;
}

namespace {

void add_box_box(std::span<const RigidBody> bodies, std::size_t i, std::size_t j,
                 double tolerance_m, std::vector<Collision>& collisions) {
  if (out_of_reach(bodies[i], bodies[j], tolerance_m)) return;
  const Axis axis = separating_axis(bodies[i], bodies[j]);
  if (axis.gap_m > tolerance_m) return;
  const double limit_m = touching_limit_m(axis.gap_m, tolerance_m);
  if (axis.index < 3) {
    add_face_contacts(bodies, i, axis.index, axis.direction, j, limit_m, collisions);
  } else if (axis.index < 6) {
    add_face_contacts(bodies, j, axis.index - 3, -axis.direction, i, limit_m, collisions);
  } else {
    add_edge_contact(bodies, i, j, axis, collisions);
  }
}

}  // namespace

void add_collision(std::span<const RigidBody> bodies, std::size_t i, std::size_t j,
                   double tolerance_m, std::vector<Collision>& collisions) {
  const auto add_ball = [&](std::size_t ball, std::size_t other) {
    add_ball_contact(bodies, ball, other, tolerance_m, collisions);
  };
  const auto add_on_plane = [&](std::size_t box, std::size_t plane) {
    add_box_plane(bodies, box, plane, tolerance_m, collisions);
  };
  std::visit(
      Overloaded{
          [&](const Box&, const Box&) { add_box_box(bodies, i, j, tolerance_m, collisions); },
          [&](const Box&, const Sphere&) { add_ball(j, i); },
          [&](const Box&, const Plane&) { add_on_plane(i, j); },
          [&](const Sphere&, const Box&) { add_ball(i, j); },
          [&](const Sphere&, const Sphere&) { add_ball(i, j); },
          [&](const Sphere&, const Plane&) { add_ball(i, j); },
          [&](const Plane&, const Box&) { add_on_plane(j, i); },
          [&](const Plane&, const Sphere&) { add_ball(j, i); }, [](const Plane&, const Plane&) {}},
      bodies[i].solid, bodies[j].solid);
}

void find_collisions(std::span<const RigidBody> bodies, double tolerance_m,
                     std::vector<Collision>& collisions) {
  collisions.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      if (bodies[i].is_fixed() && bodies[j].is_fixed()) continue;
      add_collision(bodies, i, j, tolerance_m, collisions);
    }
  }
}

}  // namespace ourengine::baraff
