#include "experiments/hunt/extent.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "adapters/seam/shape.hpp"

namespace brickbench::hunt {
namespace {

constexpr double k_infinite = std::numeric_limits<double>::infinity();

// d = v t + a t^2 / 2 for the smallest t >= 0; infinite where there is none.
double time_to_cover_s(double distance_m, double speed_mps, double acceleration_mps2) {
  if (distance_m <= 0.0) return 0.0;
  if (acceleration_mps2 == 0.0) return speed_mps > 0.0 ? distance_m / speed_mps : k_infinite;
  const double root = speed_mps * speed_mps + 2.0 * acceleration_mps2 * distance_m;
  if (root < 0.0) return k_infinite;
  const double time_s = (std::sqrt(root) - speed_mps) / acceleration_mps2;
  return time_s > 0.0 ? time_s : k_infinite;
}

double meeting_s(const World& world, const Body& a, const Body& b) {
  const auto pull = [&](const Body& body) -> Eigen::Vector3d {
    return body.fixed ? Eigen::Vector3d(0.0, 0.0, 0.0) : world.gravity_mps2;
  };
  Eigen::Vector3d towards_b = b.initial.position_m - a.initial.position_m;
  double gap_m = towards_b.norm() - reach_m(a.shape) - reach_m(b.shape);
  if (is_half_space(b.shape)) {
    const Eigen::Vector3d up = b.initial.orientation * Eigen::Vector3d::UnitZ();
    gap_m = -up.dot(towards_b) - reach_m(a.shape);
    towards_b = -up;
  }
  if (towards_b.norm() == 0.0) return 0.0;
  const Eigen::Vector3d direction = towards_b.normalized();
  return time_to_cover_s(gap_m, direction.dot(a.initial.velocity_mps - b.initial.velocity_mps),
                         direction.dot(pull(a) - pull(b)));
}

}  // namespace

double reach_m(const Shape& shape) { return is_half_space(shape) ? 0.0 : bounding_radius_m(shape); }

double thinnest_m(const Shape& shape) { return thickness_m(shape); }

double thinnest_m(const World& world) {
  double least_m = k_infinite;
  for (const Body& body : world.bodies) {
    if (!body.fixed) least_m = std::min(least_m, thinnest_m(body.shape));
  }
  return least_m;
}

ContactLaw greatest_law(const World& world) {
  ContactLaw most = world.law;
  for (const PairLaw& pair : world.exceptions) {
    most.friction = std::max(most.friction, pair.law.friction);
    most.restitution = std::max(most.restitution, pair.law.restitution);
  }
  return most;
}

bool has_fixed(const World& world) { return std::ranges::any_of(world.bodies, &Body::fixed); }

std::size_t moving_count(const World& world) {
  return static_cast<std::size_t>(std::ranges::count(world.bodies, false, &Body::fixed));
}

double soonest_meeting_s(const World& world) {
  double soonest_s = k_infinite;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    for (std::size_t j = 0; j < world.bodies.size(); ++j) {
      if (i == j || world.bodies[i].fixed || (j < i && !world.bodies[j].fixed)) continue;
      soonest_s = std::min(soonest_s, meeting_s(world, world.bodies[i], world.bodies[j]));
    }
  }
  return soonest_s;
}

double fastest_point_mps(const Body& body, const State& state) {
  if (body.fixed) return 0.0;
  return state.velocity_mps.norm() + state.angular_velocity_radps.norm() * reach_m(body.shape);
}

}  // namespace brickbench::hunt
