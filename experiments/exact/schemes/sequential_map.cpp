#include "experiments/exact/schemes/sequential_map.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>

#include "experiments/exact/cases/builders.hpp"
#include "experiments/exact/schemes/box_points.hpp"
#include "experiments/exact/schemes/scheme_map.hpp"

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

// What a pair of bodies does at a point, with the levers to it.
class Pair {
 public:
  Pair(const ExactRun& run, const TouchingPoint& point, std::span<const State> states)
      : run_(run), point_(point), states_(states) {}

  Vector3d lever_m(std::size_t i) const {
    return point_.corner ? Vector3d(point_.position_m - states_[i].position_m)
                         : Vector3d(Vector3d::Zero());
  }
  // (m/s) along the normal, positive when separating.
  double velocity_mps() const { return point_.normal.dot(slip_mps()); }
  Vector3d slip_mps() const { return velocity_of(point_.body_b) - velocity_of(point_.body_a); }
  bool moves(std::size_t i) const { return !run_.world.bodies[i].fixed; }
  double sign(std::size_t i) const {
    return i == point_.body_b ? 1.0 : i == point_.body_a ? -1.0 : 0.0;
  }
  // Change of the spin per unit of impulse along the normal on b.
  Vector3d turn(std::size_t i) const {
    return inverse_inertia(i, sign(i) * lever_m(i).cross(point_.normal));
  }
  Vector3d inverse_inertia(std::size_t i, const Vector3d& moment) const {
    const Eigen::Quaterniond& q = states_[i].orientation;
    return q * (q.conjugate() * moment).cwiseQuotient(run_.world.bodies[i].inertia_kgm2);
  }
  const TouchingPoint& point() const { return point_; }

 private:
  Vector3d velocity_of(std::size_t i) const {
    if (!moves(i)) return Vector3d::Zero();
    return states_[i].velocity_mps + states_[i].angular_velocity_radps.cross(lever_m(i));
  }

  const ExactRun& run_;
  const TouchingPoint& point_;
  std::span<const State> states_;
};

// What an impulse of 1 N s at `pushed` changes in the normal velocity of `felt` (1/kg).
double response(const ExactRun& run, const Pair& felt, const Pair& pushed) {
  double sum = 0.0;
  for (const std::size_t i : {felt.point().body_a, felt.point().body_b}) {
    if (!felt.moves(i) || pushed.sign(i) == 0.0) continue;
    const Vector3d change = pushed.sign(i) / run.world.bodies[i].mass_kg * pushed.point().normal +
                            pushed.turn(i).cross(felt.lever_m(i));
    sum += felt.sign(i) * felt.point().normal.dot(change);
  }
  return sum;
}

void push(const ExactRun& run, const TouchingPoint& point, double impulse_ns,
          std::span<State> states) {
  const Pair pair(run, point, states);
  for (const std::size_t i : {point.body_a, point.body_b}) {
    if (!pair.moves(i)) continue;
    const Vector3d turn = impulse_ns * pair.turn(i);
    states[i].velocity_mps +=
        pair.sign(i) * impulse_ns / run.world.bodies[i].mass_kg * point.normal;
    states[i].angular_velocity_radps += turn;
  }
}

// x >= 0 with A x + b >= 0 and x . (A x + b) = 0, A symmetric and at least semidefinite: projected
// Gauss-Seidel to rounding. What A x is does not depend on which x is found.
std::optional<VectorXd> complementarity(const MatrixXd& a, const VectorXd& b) {
  constexpr int k_most_passes = 200000;
  VectorXd x = VectorXd::Zero(b.size());
  const double rounding = 1e-15 * b.cwiseAbs().maxCoeff();
  for (int pass = 0; pass < k_most_passes; ++pass) {
    double change = 0.0;
    for (Index i = 0; i < b.size(); ++i) {
      const double next = std::max(0.0, x[i] - (a.row(i).dot(x) + b[i]) / a(i, i));
      change = std::max(change, std::abs(next - x[i]) * a(i, i));
      x[i] = next;
    }
    if (change <= rounding) return x;
  }
  return std::nullopt;
}

MatrixXd responses(const ExactRun& run, const std::vector<TouchingPoint>& points,
                   std::span<const State> states) {
  const auto n = static_cast<Index>(points.size());
  MatrixXd a(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      a(i, j) = response(run, Pair(run, points[static_cast<std::size_t>(i)], states),
                         Pair(run, points[static_cast<std::size_t>(j)], states));
    }
  }
  return a;
}

// Hits contact after contact until none approaches faster than the threshold.
bool hit_one_by_one(const SequentialContact& law, const ExactRun& run,
                    const std::vector<TouchingPoint>& points, std::span<State> states,
                    std::string& why) {
  for (int sweep = 0; sweep < law.most_sweeps; ++sweep) {
    bool hit = false;
    for (const TouchingPoint& point : points) {
      const Pair pair(run, point, states);
      const double velocity = pair.velocity_mps();
      if (velocity >= -law.collision_velocity_mps) continue;
      const double e = contact_law(run.world, point.body_a, point.body_b).restitution;
      push(run, point, -(1.0 + e) * velocity / response(run, pair, pair), states);
      hit = true;
    }
    if (!hit) return true;
  }
  why = "hits one after the other do not end";
  return false;
}

// Second derivative of the gap without contact forces.
double free_acceleration_mps2(const ExactRun& run, const Pair& pair,
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
    if (Pair(run, point, states).velocity_mps() <= law.collision_velocity_mps) {
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
    const Pair pair(run, resting[i], states);
    closing[static_cast<Index>(i)] = free_acceleration_mps2(run, pair, wrenches, states) +
                                     law.velocity_share / run.step_s * pair.velocity_mps();
  }
  const auto forces = complementarity(responses(run, resting, states), closing);
  if (!forces) {
    why = "the forces of resting contacts do not settle";
    return false;
  }
  for (std::size_t i = 0; i < resting.size(); ++i) {
    const Pair pair(run, resting[i], states);
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
    all[static_cast<Index>(i)] = Pair(run, points[i], states).velocity_mps();
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
  const std::vector<TouchingPoint> points =
      touching_points(run, states, law.margin_m, law.border_share);
  const VectorXd met_mps = velocities(run, points, states);
  if (!hit_one_by_one(law, run, points, states, why)) return false;
  std::vector<Wrench> forces(wrenches.begin(), wrenches.end());
  if (!points.empty() && !rest(law, run, points, states, forces, why)) return false;
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
