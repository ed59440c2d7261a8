#include "experiments/exact/schemes/sequential_hits.hpp"

#include <algorithm>
#include <cmath>

namespace brickbench::exact {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

Vector3d TouchingPair::lever_m(std::size_t i) const {
  return point_.corner ? Vector3d(point_.position_m - states_[i].position_m)
                       : Vector3d(Vector3d::Zero());
}

Vector3d TouchingPair::inverse_inertia(std::size_t i, const Vector3d& moment) const {
  const Eigen::Quaterniond& q = states_[i].orientation;
  return q * (q.conjugate() * moment).cwiseQuotient(run_.world.bodies[i].inertia_kgm2);
}

Vector3d TouchingPair::velocity_of(std::size_t i) const {
  if (!moves(i)) return Vector3d::Zero();
  return states_[i].velocity_mps + states_[i].angular_velocity_radps.cross(lever_m(i));
}

namespace {

// What an impulse of 1 N s at `pushed` changes in the normal velocity of `felt` (1/kg).
double response(const ExactRun& run, const TouchingPair& felt, const TouchingPair& pushed) {
  double sum = 0.0;
  for (const std::size_t i : {felt.point().body_a, felt.point().body_b}) {
    if (!felt.moves(i) || pushed.sign(i) == 0.0) continue;
    const Vector3d change = pushed.sign(i) / run.world.bodies[i].mass_kg * pushed.point().normal +
                            pushed.turn(i).cross(felt.lever_m(i));
    sum += felt.sign(i) * felt.point().normal.dot(change);
  }
  return sum;
}

}  // namespace

void push(const ExactRun& run, const TouchingPoint& point, double impulse_ns,
          std::span<State> states) {
  const TouchingPair pair(run, point, states);
  for (const std::size_t i : {point.body_a, point.body_b}) {
    if (!pair.moves(i)) continue;
    const Vector3d turn = impulse_ns * pair.turn(i);
    states[i].velocity_mps +=
        pair.sign(i) * impulse_ns / run.world.bodies[i].mass_kg * point.normal;
    states[i].angular_velocity_radps += turn;
  }
}

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
      a(i, j) = response(run, TouchingPair(run, points[static_cast<std::size_t>(i)], states),
                         TouchingPair(run, points[static_cast<std::size_t>(j)], states));
    }
  }
  return a;
}

namespace {

double restitution_of(const ExactRun& run, const TouchingPoint& point) {
  return contact_law(run.world, point.body_a, point.body_b).restitution;
}

// The points that are hit at once: each alone, or those without restitution first and then pair by
// pair.
std::vector<std::vector<TouchingPoint>> groups_of(const SequentialContact& law, const ExactRun& run,
                                                  const std::vector<TouchingPoint>& points) {
  std::vector<std::vector<TouchingPoint>> groups(1);
  for (const TouchingPoint& point : points) {
    if (!law.hits_at_once) {
      groups.push_back({point});
    } else if (restitution_of(run, point) == 0.0) {
      groups.front().push_back(point);
    } else if (groups.size() > 1 && groups.back().back().body_a == point.body_a &&
               groups.back().back().body_b == point.body_b) {
      groups.back().push_back(point);
    } else {
      groups.push_back({point});
    }
  }
  return groups;
}

// Newton's law of all points together; false if the impulses do not settle.
bool hit_group(const ExactRun& run, const std::vector<TouchingPoint>& group,
               std::span<State> states) {
  VectorXd wanted(static_cast<Index>(group.size()));
  for (std::size_t i = 0; i < group.size(); ++i) {
    wanted[static_cast<Index>(i)] =
        (1.0 + restitution_of(run, group[i])) * TouchingPair(run, group[i], states).velocity_mps();
  }
  const auto impulses = complementarity(responses(run, group, states), wanted);
  if (!impulses) return false;
  for (std::size_t i = 0; i < group.size(); ++i) {
    push(run, group[i], (*impulses)[static_cast<Index>(i)], states);
  }
  return true;
}

}  // namespace

bool hit_all(const SequentialContact& law, const ExactRun& run,
             const std::vector<TouchingPoint>& points, std::span<State> states, std::string& why) {
  const auto groups = groups_of(law, run, points);
  for (int sweep = 0; sweep < law.most_sweeps; ++sweep) {
    bool hit = false;
    for (const std::vector<TouchingPoint>& group : groups) {
      const bool collides = std::ranges::any_of(group, [&](const TouchingPoint& point) {
        return TouchingPair(run, point, states).velocity_mps() < -law.collision_velocity_mps;
      });
      if (!collides) continue;
      if (!hit_group(run, group, states)) {
        why = "the impulses of a hit do not settle";
        return false;
      }
      hit = true;
    }
    if (!hit) return true;
  }
  why = "hits one after the other do not end";
  return false;
}

}  // namespace brickbench::exact
