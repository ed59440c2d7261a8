#include "experiments/exact/schemes/sequential_map.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "adapters/seam/shape.hpp"
#include "experiments/exact/cases/builders.hpp"
#include "experiments/exact/schemes/box_points.hpp"
#include "experiments/exact/schemes/scheme_map.hpp"
#include "experiments/exact/schemes/sequential_hits.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

void add_on_plane(const ExactRun& run, const PointContact& contact, std::span<const State> states,
                  std::vector<TouchingPoint>& points) {
  const State& plane = states[contact.body_a];
  const State& box = states[contact.body_b];
  const auto& half = std::get<BoxShape>(run.world.bodies[contact.body_b].shape).half_extents_m;
  TouchingPoint point{.body_a = contact.body_a, .body_b = contact.body_b, .corner = true};
  point.normal = plane.orientation * Vector3d::UnitZ();
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d sign((corner & 1) ? 1 : -1, (corner & 2) ? 1 : -1, (corner & 4) ? 1 : -1);
    point.position_m = box.position_m + box.orientation * half.cwiseProduct(sign);
    point.gap_m = point.normal.dot(point.position_m - plane.position_m);
    points.push_back(point);
  }
}

void add_on_face(const ExactRun& run, double border_share, const PointContact& contact,
                 std::span<const State> states, std::vector<TouchingPoint>& points) {
  const State& a = states[contact.body_a];
  const State& b = states[contact.body_b];
  const Vector3d& half_a =
      std::get<BoxShape>(run.world.bodies[contact.body_a].shape).half_extents_m;
  const Vector3d& half_b =
      std::get<BoxShape>(run.world.bodies[contact.body_b].shape).half_extents_m;
  const double border_m = border_share * std::min(half_a.minCoeff(), half_b.minCoeff());
  const Vector3d up = a.orientation.conjugate() * contact.normal;
  Index face = 0;
  up.cwiseAbs().maxCoeff(&face);
  TouchingPoint point{.body_a = contact.body_a, .body_b = contact.body_b, .corner = true};
  point.normal = a.orientation * Vector3d(std::copysign(1.0, up[face]) * Vector3d::Unit(face));
  const Vector3d down = b.orientation.conjugate() * -point.normal;
  Index opposed = 0;
  down.cwiseAbs().maxCoeff(&opposed);
  const bool parallel = std::abs(down[opposed]) > 1.0 - 1e-12;
  constexpr std::array<std::array<double, 2>, 4> k_around = {{{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};
  for (const auto& [s, t] : k_around) {
    Vector3d local = half_b;
    local[opposed] *= std::copysign(1.0, down[opposed]);
    local[(opposed + 1) % 3] *= s;
    local[(opposed + 2) % 3] *= t;
    point.position_m = b.position_m + b.orientation * local;
    const Vector3d between_m = point.position_m - a.position_m;
    point.gap_m = point.normal.dot(between_m) - half_a[face];
    const Vector3d in_a = (a.orientation.conjugate() * between_m).cwiseAbs();
    const double room_m = std::min(half_a[(face + 1) % 3] - in_a[(face + 1) % 3],
                                   half_a[(face + 2) % 3] - in_a[(face + 2) % 3]);
    point.plain = room_m > border_m || (parallel && room_m >= -border_m);
    points.push_back(point);
  }
}

// Second derivative of the gap without contact forces.
double free_acceleration_mps2(const ExactRun& run, const TouchingPair& pair,
                              std::span<const Wrench> wrenches, std::span<const State> states) {
  const TouchingPoint& point = pair.point();
  Vector3d sum = Vector3d::Zero();
  for (const std::size_t i : {point.body_a, point.body_b}) {
    if (!pair.moves(i)) continue;
    const Body& body = run.world.bodies[i];
    const Vector3d& w = states[i].angular_velocity_radps;
    const Vector3d r = pair.lever_m(i);
    const Vector3d spin_up = pair.inverse_inertia(
        i, wrenches[i].torque_nm + spin_momentum_nms(body, states[i]).cross(w));
    sum += pair.sign(i) * (run.world.gravity_mps2 + wrenches[i].force_n / body.mass_kg +
                           spin_up.cross(r) + w.cross(w.cross(r)));
  }
  const Vector3d slip = pair.slip_mps();
  double turning = 0.0;
  if (point.corner && pair.moves(point.body_a)) {
    turning = 2.0 * states[point.body_a].angular_velocity_radps.cross(point.normal).dot(slip);
  }
  const Vector3d across = slip - point.normal.dot(slip) * point.normal;
  return point.normal.dot(sum) + turning + point.curvature_per_m * across.squaredNorm();
}

// Adds to the wrenches the forces of all contacts that do not separate.
bool rest(const SequentialContact& law, const ExactRun& run,
          const std::vector<TouchingPoint>& points, std::span<const State> states,
          std::vector<Wrench>& wrenches, std::string& why) {
  std::vector<TouchingPoint> resting;
  for (const TouchingPoint& point : points) {
    if (TouchingPair(run, point, states).velocity_mps() <= law.collision_velocity_mps) {
      resting.push_back(point);
    }
  }
  if (resting.empty()) return true;
  VectorXd closing(static_cast<Index>(resting.size()));
  for (std::size_t i = 0; i < resting.size(); ++i) {
    if (!resting[i].plain) {
      why = "faces rest tilted against each other: their crossing edges are not listed";
      return false;
    }
    const TouchingPair pair(run, resting[i], states);
    closing[static_cast<Index>(i)] = free_acceleration_mps2(run, pair, wrenches, states) +
                                     law.velocity_share / run.step_s * pair.velocity_mps();
  }
  const auto forces = complementarity(responses(run, resting, states), closing);
  if (!forces) {
    why = "the forces of resting contacts do not settle";
    return false;
  }
  for (std::size_t i = 0; i < resting.size(); ++i) {
    const TouchingPair pair(run, resting[i], states);
    for (const std::size_t body : {resting[i].body_a, resting[i].body_b}) {
      const Vector3d force_n =
          pair.sign(body) * (*forces)[static_cast<Index>(i)] * resting[i].normal;
      wrenches[body].force_n += force_n;
      wrenches[body].torque_nm += pair.lever_m(body).cross(force_n);
    }
  }
  return true;
}

// (points): m/s, positive when separating.
VectorXd velocities(const ExactRun& run, const std::vector<TouchingPoint>& points,
                    std::span<const State> states) {
  VectorXd all(static_cast<Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    all[static_cast<Index>(i)] = TouchingPair(run, points[i], states).velocity_mps();
  }
  return all;
}

// (points): the gaps that the motion of the step would leave, to first order in its way; met_mps:
// velocities before the hits. No overlap where a point parts by itself.
VectorXd gaps_after(const Scheme& scheme, const ExactRun& run,
                    const std::vector<TouchingPoint>& points, const VectorXd& met_mps,
                    std::span<const State> states, std::span<const Wrench> wrenches) {
  const PositionRule rule = scheme.position;
  std::vector<State> moving(states.begin(), states.end());
  for (std::size_t i = 0; rule != PositionRule::old_velocity && i < states.size(); ++i) {
    const Body& body = run.world.bodies[i];
    if (body.fixed) continue;
    const double middle_s = 0.5 * run.step_s;
    moving[i].velocity_mps +=
        middle_s * (run.world.gravity_mps2 + wrenches[i].force_n / body.mass_kg);
    push_momentum(body.inertia_kgm2, middle_s * wrenches[i].torque_nm, moving[i]);
  }
  const double slowest = scheme.sequential()->collision_velocity_mps;
  const double slow_hit =
      scheme.sequential()->slow_hit_steps * run.step_s * run.world.gravity_mps2.norm();
  const VectorXd now_mps = velocities(run, points, states);
  VectorXd gaps = run.step_s * velocities(run, points, moving);
  for (Index i = 0; i < gaps.size(); ++i) {
    gaps[i] += points[static_cast<std::size_t>(i)].gap_m;
    const bool slowly_hit = met_mps[i] < -slowest && met_mps[i] >= -slow_hit;
    if (now_mps[i] > slowest && !slowly_hit) gaps[i] = std::max(gaps[i], 0.0);
  }
  return gaps;
}

// The smallest moves after which the motion of the step leaves no overlap, momenta held.
bool undo_overlaps(const SequentialContact& law, const ExactRun& run,
                   const std::vector<TouchingPoint>& points, const VectorXd& gaps,
                   std::span<State> states, std::string& why) {
  if (gaps.minCoeff() >= -law.overlap_slop_m) return true;
  if (!std::ranges::all_of(points, &TouchingPoint::plain)) {
    why = "overlapping faces tilt against each other: their crossing edges are not listed";
    return false;
  }
  const VectorXd wanted = gaps.cwiseMax(0.0) + law.overlap_share * gaps.cwiseMin(0.0);
  const auto pushes = complementarity(responses(run, points, states), wanted);
  if (!pushes) {
    why = "the moves out of an overlap do not settle";
    return false;
  }
  std::vector<State> moves(states.begin(), states.end());
  for (State& s : moves) s.velocity_mps = s.angular_velocity_radps = Vector3d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    push(run, points[i], (*pushes)[static_cast<Index>(i)], moves);
  }
  for (std::size_t i = 0; i < states.size(); ++i) {
    const Body& body = run.world.bodies[i];
    if (body.fixed) continue;
    State& s = states[i];
    const Vector3d momentum = spin_momentum_nms(body, s);
    s.position_m += moves[i].velocity_mps;
    s.orientation = turned_to_first_order(s.orientation, moves[i].angular_velocity_radps);
    s.angular_velocity_radps =
        s.orientation * (s.orientation.conjugate() * momentum).cwiseQuotient(body.inertia_kgm2);
  }
  return true;
}

// How fast the way of a point of the body along the normal may bend as it turns, m/s2.
double bend_mps2(const ExactRun& run, const TouchingPair& pair, std::size_t i, const Wrench& wrench,
                 const State& state) {
  const Body& body = run.world.bodies[i];
  if (body.fixed || !pair.point().corner) return 0.0;
  const Vector3d& w = state.angular_velocity_radps;
  const Vector3d spin_up =
      pair.inverse_inertia(i, wrench.torque_nm + spin_momentum_nms(body, state).cross(w));
  const double reach_m = by_shape(
      body.shape, [](const BoxShape& box) { return box.half_extents_m.norm(); },
      [](const SphereShape&) { return 0.0; }, [](const PlaneShape&) { return 0.0; });
  return reach_m * (pair.point().normal.cross(w).norm() * w.norm() + spin_up.norm());
}

// Whether some point could get so deep within the step that the scheme cuts it.
bool is_cut(const SequentialContact& law, const ExactRun& run, std::span<const State> states,
            std::span<const Wrench> forces) {
  if (law.depth_share == 0.0) return false;
  const double h = run.step_s;
  const double everywhere = std::numeric_limits<double>::infinity();
  for (const TouchingPoint& point : touching_points(run, states, everywhere, law.border_share)) {
    const TouchingPair pair(run, point, states);
    double closing_mps2 = 0.0;
    for (const std::size_t i : {point.body_a, point.body_b}) {
      if (!pair.moves(i)) continue;
      closing_mps2 -=
          pair.sign(i) * point.normal.dot(run.world.gravity_mps2 +
                                          forces[i].force_n / run.world.bodies[i].mass_kg);
    }
    closing_mps2 = std::max(closing_mps2, 0.0);
    double thinner_m = everywhere;
    for (const std::size_t i : {point.body_a, point.body_b}) {
      closing_mps2 += bend_mps2(run, pair, i, forces[i], states[i]);
      thinner_m = std::min(thinner_m, thickness_m(run.world.bodies[i].shape));
    }
    const double after_m = point.gap_m + h * pair.velocity_mps() - 0.5 * h * h * closing_mps2;
    if (after_m < std::min(point.gap_m, 0.0) - law.depth_share * thinner_m) return true;
  }
  return false;
}

// The points of pairs whose least gap is within the margin, those open by a margin more included.
std::vector<TouchingPoint> contact_points(const SequentialContact& law, const ExactRun& run,
                                          std::span<const State> states) {
  std::vector<TouchingPoint> all =
      touching_points(run, states, 2.0 * law.margin_m, law.border_share);
  std::vector<TouchingPoint> kept;
  for (const TouchingPoint& point : all) {
    double least_m = point.gap_m;
    for (const TouchingPoint& other : all) {
      if (other.body_a != point.body_a || other.body_b != point.body_b) continue;
      least_m = std::min(least_m, other.gap_m);
    }
    if (least_m > law.margin_m) continue;
    if (point.gap_m <= std::max(least_m, 0.0) + law.margin_m) kept.push_back(point);
  }
  return kept;
}

}  // namespace

std::vector<TouchingPoint> touching_points(const ExactRun& run, std::span<const State> states,
                                           double margin_m, double border_share) {
  std::vector<PointContact> contacts;
  run.geometry(states, contacts);
  std::ranges::stable_sort(contacts, {}, [](const PointContact& c) {
    return std::pair(std::min(c.body_a, c.body_b), std::max(c.body_a, c.body_b));
  });
  std::vector<TouchingPoint> points;
  for (const PointContact& contact : contacts) {
    const Shape& a = run.world.bodies[contact.body_a].shape;
    if (box_of(run.world.bodies[contact.body_b].shape) != nullptr) {
      by_shape(
          a, [&](const BoxShape&) { add_on_face(run, border_share, contact, states, points); },
          [](const SphereShape&) { assert(!"of a box and a ball, the ball stands second"); },
          [&](const PlaneShape&) { add_on_plane(run, contact, states, points); });
      continue;
    }
    TouchingPoint point{.body_a = contact.body_a,
                        .body_b = contact.body_b,
                        .position_m = contact.position_m,
                        .normal = contact.normal,
                        .gap_m = contact.gap_m};
    if (is_round(a)) {
      point.curvature_per_m =
          1.0 / (states[contact.body_b].position_m - states[contact.body_a].position_m).norm();
    }
    points.push_back(point);
  }
  std::erase_if(points, [&](const TouchingPoint& p) { return p.gap_m > margin_m; });
  return points;
}

bool advance_sequential(const Scheme& scheme, const ExactRun& run, std::span<const Wrench> wrenches,
                        std::span<State> states, std::string& why) {
  const SequentialContact& law = *scheme.sequential();
  const std::vector<TouchingPoint> points = contact_points(law, run, states);
  const VectorXd met_mps = velocities(run, points, states);
  if (!hit_all(law, run, points, states, why)) return false;
  std::vector<Wrench> forces(wrenches.begin(), wrenches.end());
  if (!points.empty() && !rest(law, run, points, states, forces, why)) return false;
  if (is_cut(law, run, states, forces)) {
    why = "the step is cut: a pair could get too deep in it";
    return false;
  }
  if (law.overlap_share > 0.0 && !points.empty()) {
    const VectorXd gaps = gaps_after(scheme, run, points, met_mps, states, forces);
    if (!undo_overlaps(law, run, points, gaps, states, why)) return false;
  }
  for (std::size_t i = 0; i < states.size(); ++i) {
    const Body& body = run.world.bodies[i];
    if (body.fixed) continue;
    states[i] =
        next_free_state(scheme, body, states[i], forces[i], run.world.gravity_mps2, run.step_s);
  }
  return true;
}

}  // namespace brickbench::exact
