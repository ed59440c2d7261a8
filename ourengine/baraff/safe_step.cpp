#include "ourengine/baraff/safe_step.hpp"

#include <algorithm>
#include <cmath>

#include "ourengine/model/by_kind.hpp"

namespace ourengine::baraff {
namespace {

constexpr int k_cut_halvings = 40;

using Eigen::Vector3d;

double thickness_m(const RigidBody& body) {
  return by_kind(
      body.solid, [](const Box& box) { return 2.0 * box.half_m.minCoeff(); },
      [](const Sphere& ball) { return 2.0 * ball.radius_m; },
      [](const Plane&) { return HUGE_VAL; });
}

double span_m(const RigidBody& body) {
  return by_kind(
      body.solid, [](const Box& box) { return box.half_m.norm(); },
      [](const Sphere& ball) { return ball.radius_m; }, [](const Plane&) { return HUGE_VAL; });
}

// The furthest point that turning moves. A ball turns into itself.
double lever_m(const RigidBody& body) {
  return by_kind(
      body.solid, [](const Box& box) { return box.half_m.norm(); },
      [](const Sphere&) { return 0.0; }, [](const Plane&) { return 0.0; });
}

Vector3d acceleration_mps2(const RigidBody& body) { return body.mass_inv * body.force_n; }

// How far the body can get from where its centre is now, beyond its own span.
double way_m(const RigidBody& body, double step_s) {
  return step_s * body.velocity_mps.norm() + 0.5 * step_s * step_s * acceleration_mps2(body).norm();
}

// The least n . x of the body's points after `time_s` at the velocities of now.
double lowest_m(const RigidBody& body, const Vector3d& n, double time_s) {
  const double centre_m = n.dot(body.position_m + time_s * body.velocity_mps);
  return by_kind(
      body.solid,
      [&](const Box& box) {
        // n . (r + t w x r) = r . (n + t n x w), least over the corners.
        const Vector3d turned = n + time_s * n.cross(body.angular_velocity_radps);
        return centre_m - (body.rotation.transpose() * turned).cwiseAbs().dot(box.half_m);
      },
      [&](const Sphere& ball) { return centre_m - ball.radius_m; },
      [&](const Plane&) { return centre_m; });
}

// Bound of what turning bends the way of any point along n, m/s2.
double bend_mps2(const RigidBody& body, const Vector3d& n) {
  const Vector3d& w = body.angular_velocity_radps;
  const Vector3d spin_up = body.inertia_inv * (body.torque_nm + body.angular_momentum_nms.cross(w));
  return lever_m(body) * (n.cross(w).norm() * w.norm() + spin_up.norm());
}

// The direction, from `below` to `above`, along which a pair is furthest apart.
struct Facing {
  std::size_t below = 0;
  std::size_t above = 0;
  Vector3d normal = Vector3d::UnitZ();
};

Facing facing(std::span<const RigidBody> bodies, std::size_t i, std::size_t j) {
  return std::visit(
      Overloaded{[&](const Box&, const Box&) {
                   return Facing{i, j, separating_axis(bodies[i], bodies[j]).direction};
                 },
                 [&](const auto&, const auto&) {
                   std::vector<Collision> any;
                   add_collision(bodies, i, j, HUGE_VAL, any);
                   return Facing{any.front().obj2, any.front().obj1, any.front().normal};
                 }},
      bodies[i].solid, bodies[j].solid);
}

bool is_far(const RigidBody& a, const RigidBody& b, double step_s) {
  return (a.position_m - b.position_m).norm() >
         span_m(a) + span_m(b) + way_m(a, step_s) + way_m(b, step_s);
}

double safe_pair_s(std::span<const RigidBody> bodies, std::size_t i, std::size_t j, double step_s,
                   double depth_share) {
  const Facing face = facing(bodies, i, j);
  const RigidBody& below = bodies[face.below];
  const RigidBody& above = bodies[face.above];
  const Vector3d& n = face.normal;
  const double closing_mps2 =
      std::max(0.0, n.dot(acceleration_mps2(below) - acceleration_mps2(above))) +
      bend_mps2(below, n) + bend_mps2(above, n);
  const auto gap_m = [&](double time_s) {
    return lowest_m(above, n, time_s) + lowest_m(below, -n, time_s) -
           0.5 * time_s * time_s * closing_mps2;
  };
  const double least_m =
      std::min(gap_m(0.0), 0.0) - depth_share * std::min(thickness_m(below), thickness_m(above));
  if (gap_m(step_s) >= least_m) return step_s;
  // The gap is concave in time, so that it is at least that much until one time only.
  double low_s = 0.0;
  double high_s = step_s;
  for (int k = 0; k < k_cut_halvings; ++k) {
    const double middle_s = 0.5 * (low_s + high_s);
    (gap_m(middle_s) >= least_m ? low_s : high_s) = middle_s;
  }
  return low_s;
}

}  // namespace

double safe_step_s(std::span<const RigidBody> bodies, double step_s, double depth_share) {
  if (depth_share == 0.0) return step_s;
  double safe_s = step_s;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      if (bodies[i].is_fixed() && bodies[j].is_fixed()) continue;
      if (is_far(bodies[i], bodies[j], safe_s)) continue;
      safe_s = std::min(safe_s, safe_pair_s(bodies, i, j, safe_s, depth_share));
    }
  }
  return safe_s;
}

}  // namespace ourengine::baraff
