#include "experiments/metrics/passages.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/metrics/placed.hpp"

namespace brickbench {
namespace {

constexpr double k_clear_share = 0.5;     // of the inscribed radius: no nearer is clear
constexpr double k_passed_share = 0.25;   // of it: the way comes nearer than this
constexpr double k_move_share = 0.25;     // of the smallest one: what calls for a look
constexpr double k_known_turn_rad = 1.0;  // per step: beyond, poses do not say which way
constexpr double k_piece_rad = 0.05;      // turn within one straight piece of the way

// The least of a convex function over the segment, to a thousandth of its length (Kiefer,
// Sequential minimax search for a maximum, 1953).
template <typename Function>
double least_on(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m, const Function& gap_m) {
  constexpr double golden = 0.6180339887498949;
  constexpr int cuts = 15;  // golden^15 < 1e-3
  double low = 0.0;
  double high = 1.0;
  const auto at = [&](double share) -> double {
    return gap_m((from_m + share * (to_m - from_m)).eval());
  };
  double left = high - golden;
  double right = golden;
  double gap_left_m = at(left);
  double gap_right_m = at(right);
  for (int cut = 0; cut < cuts; ++cut) {
    if (gap_left_m < gap_right_m) {
      high = std::exchange(right, left);
      gap_right_m = std::exchange(gap_left_m, at(left = high - golden * (high - low)));
    } else {
      low = std::exchange(left, right);
      gap_left_m = std::exchange(gap_right_m, at(right = low + golden * (high - low)));
    }
  }
  return std::min({gap_left_m, gap_right_m, gap_m(from_m), gap_m(to_m)});
}

Eigen::Vector3d seen_from(const State& other, const Eigen::Vector3d& point_m) {
  return other.orientation.normalized().conjugate() * (point_m - other.position_m);
}

template <typename... Lambdas>
struct Overloaded : Lambdas... {
  using Lambdas::operator()...;
};

}  // namespace

Passages::Solid Passages::solid_of(const Body& body) {
  Solid solid = std::visit(
      Overloaded{[](const BoxShape& box) {
                   return Solid{Solid::Kind::box, box.half_extents_m, box.half_extents_m.minCoeff(),
                                box.half_extents_m.norm()};
                 },
                 [](const SphereShape& ball) {
                   return Solid{Solid::Kind::sphere, Eigen::Vector3d::Constant(ball.radius_m),
                                ball.radius_m, ball.radius_m};
                 },
                 [](const PlaneShape&) { return Solid{Solid::Kind::plane}; }},
      body.shape);
  solid.fixed = body.fixed;
  return solid;
}

// Distance (m) of a point in the body's frame from its surface, negative inside. `ball`: that of
// the inscribed ball, which no turn moves.
double Passages::Solid::gap_m(const Eigen::Vector3d& point_m, bool ball) const {
  if (kind == Kind::plane) return point_m.z();
  if (ball || kind == Kind::sphere) return point_m.norm() - inner_m;
  const Eigen::Vector3d beyond_m = point_m.cwiseAbs() - half_m;
  const double most_m = beyond_m.maxCoeff();
  return most_m <= 0.0 ? most_m : beyond_m.cwiseMax(0.0).norm();
}

Passages::Passages(const World& world, double step_s)
    : step_s_(step_s), least_m_(std::numeric_limits<double>::infinity()) {
  for (std::uint32_t i = 0; i < world.bodies.size(); ++i) {
    shapes_.push_back(world.bodies[i].shape);
    solids_.push_back(solid_of(world.bodies[i]));
    const Solid& solid = solids_.back();
    if (!solid.fixed) least_m_ = std::min(least_m_, solid.inner_m);
    (solid.kind == Solid::Kind::plane ? planes_ : order_).push_back(i);
  }
  spin_radps_.assign(solids_.size(), 0.0);
  ways_.resize(solids_.size());
  centers_.resize(solids_.size());
}

const std::vector<Passage>& Passages::observe(std::span<const State> states) {
  passages_.clear();
  now_.assign(states.begin(), states.end());
  for (std::size_t i = 0; i < now_.size(); ++i) {
    spin_radps_[i] = std::max(spin_radps_[i], now_[i].angular_velocity_radps.norm());
  }
  const bool first = seen_.empty();
  if (first) seen_ = now_;
  if (!first && !has_moved(states)) return passages_;
  look();
  seen_.swap(now_);
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    spin_radps_[i] = seen_[i].angular_velocity_radps.norm();
  }
  return passages_;
}

bool Passages::has_moved(std::span<const State> states) const {
  const double enough_m = k_move_share * least_m_;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (solids_[i].fixed) continue;
    const double way_m = (states[i].position_m - seen_[i].position_m).norm();
    if (way_m > enough_m) return true;
    if (solids_[i].kind == Solid::Kind::sphere) continue;
    const double cosine = states[i].orientation.dot(seen_[i].orientation);
    // The outermost point moves by 2 r sin(turn / 2).
    const double swing_m =
        2.0 * solids_[i].outer_m * std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    if (way_m + swing_m > enough_m) return true;
  }
  return false;
}

double Passages::turn_rad(std::size_t body) const {
  return seen_[body].orientation.angularDistance(now_[body].orientation);
}

bool Passages::Bounds::meets(const Bounds& other) const {
  return (low_m.array() <= other.high_m.array()).all() &&
         (other.low_m.array() <= high_m.array()).all();
}

void Passages::bound(std::size_t body) {
  const Eigen::Vector3d before_m = seen_[body].position_m;
  const Eigen::Vector3d now_m = now_[body].position_m;
  const Eigen::Vector3d clear_m = Eigen::Vector3d::Constant(k_clear_share * solids_[body].inner_m);
  centers_[body] = {before_m.cwiseMin(now_m) - clear_m, before_m.cwiseMax(now_m) + clear_m};
  const Eigen::Vector3d reach_before_m = reach_m(place(shapes_[body], seen_[body]));
  const Eigen::Vector3d reach_now_m = reach_m(place(shapes_[body], now_[body]));
  // Between the two poses a corner rises over the chord of its arc by at most r (1 - cos(turn /
  // 2)).
  const double rise_m = solids_[body].outer_m * (1.0 - std::cos(0.5 * turn_rad(body)));
  const Eigen::Vector3d over_m = Eigen::Vector3d::Constant(rise_m);
  ways_[body] = {(before_m - reach_before_m).cwiseMin(now_m - reach_now_m) - over_m,
                 (before_m + reach_before_m).cwiseMax(now_m + reach_now_m) + over_m};
}

void Passages::look() {
  for (const std::uint32_t i : order_) bound(i);
  for (auto& [pair, inside] : inside_) {
    settle(pair.first, pair.second, seen_from(now_[pair.second], now_[pair.first].position_m),
           inside);
  }
  for (const std::uint32_t plane : planes_) {
    for (const std::uint32_t body : order_) {
      if (!solids_[body].fixed) look_one_way(body, plane);
    }
  }
  sweep();
  std::erase_if(inside_, [&](const auto& entry) {
    const auto& pair = entry.first;
    const Eigen::Vector3d now_m = seen_from(now_[pair.second], now_[pair.first].position_m);
    return solids_[pair.second].gap_m(now_m, false) >= k_clear_share * solids_[pair.first].inner_m;
  });
}

// Sweep and prune along the axis along which the bodies lay furthest apart at the start.
void Passages::sweep() {
  if (order_.empty()) return;
  if (axis_ < 0) {
    Bounds all = ways_[order_.front()];
    for (const std::uint32_t i : order_) {
      all = {all.low_m.cwiseMin(ways_[i].low_m), all.high_m.cwiseMax(ways_[i].high_m)};
    }
    (all.high_m - all.low_m).maxCoeff(&axis_);
  }
  std::ranges::sort(order_, {},
                    [&](std::uint32_t i) { return std::pair(ways_[i].low_m[axis_], i); });
  for (std::size_t n = 0; n < order_.size(); ++n) {
    const Bounds& way = ways_[order_[n]];
    for (std::size_t m = n + 1;
         m < order_.size() && ways_[order_[m]].low_m[axis_] <= way.high_m[axis_]; ++m) {
      if (way.meets(ways_[order_[m]])) look_at(order_[n], order_[m]);
    }
  }
}

void Passages::look_at(std::uint32_t a, std::uint32_t b) {
  if (solids_[a].fixed && solids_[b].fixed) return;
  if (centers_[a].meets(ways_[b])) look_one_way(a, b);
  if (centers_[b].meets(ways_[a])) look_one_way(b, a);
}

void Passages::look_one_way(std::uint32_t a, std::uint32_t b) {
  const Solid& other = solids_[b];
  const double radius_m = solids_[a].inner_m;
  if (inside_.contains({a, b})) return;
  const Eigen::Vector3d before_m = seen_from(seen_[b], seen_[a].position_m);
  const Eigen::Vector3d now_m = seen_from(now_[b], now_[a].position_m);
  const bool ball = spin_radps_[b] * step_s_ > k_known_turn_rad;
  const double gap_before_m = other.gap_m(before_m, false);
  const double gap_now_m = other.gap_m(now_m, false);
  if (gap_now_m < k_clear_share * radius_m) {
    Inside inside;
    if (gap_before_m >= k_clear_share * radius_m) inside.clear_m = before_m;
    settle(a, b, now_m, inside_.emplace(Pair{a, b}, inside).first->second);
    return;
  }
  // The way of the centre is at least as long as from clear to passed and back.
  const double way_m =
      (now_[a].position_m - seen_[a].position_m - (now_[b].position_m - seen_[b].position_m))
          .norm() +
      (ball ? 0.0 : turn_rad(b) * std::max(before_m.norm(), now_m.norm()));
  const double passed_m = k_passed_share * radius_m;
  const double nearest_m = 0.5 * (other.gap_m(before_m, ball) + other.gap_m(now_m, ball) - way_m);
  if (nearest_m < passed_m && crosses(a, b)) passages_.push_back({a, b});
}

// A body that is not clear of another, or no longer was: has it come out on another side, or sunk?
void Passages::settle(std::uint32_t a, std::uint32_t b, const Eigen::Vector3d& now_m,
                      Inside& inside) {
  if (!inside.clear_m || inside.told) return;
  const Solid& other = solids_[b];
  const double radius_m = solids_[a].inner_m;
  const double gap_m = other.gap_m(now_m, false);
  const auto gap_of = [&](const Eigen::Vector3d& point_m) { return other.gap_m(point_m, false); };
  const bool sunk = gap_m <= -radius_m;
  const bool out = gap_m >= k_clear_share * radius_m;
  if (!sunk && !(out && least_on(*inside.clear_m, now_m, gap_of) < k_passed_share * radius_m)) {
    return;
  }
  inside.told = true;
  passages_.push_back({a, b});
}

// Whether the way of a's centre since last looked at comes nearer to b than passed.
bool Passages::crosses(std::uint32_t a, std::uint32_t b) const {
  const bool ball = spin_radps_[b] * step_s_ > k_known_turn_rad;
  const Solid& other = solids_[b];
  const auto gap_of = [&](const Eigen::Vector3d& point_m) { return other.gap_m(point_m, ball); };
  const int pieces = ball ? 1 : 1 + static_cast<int>(turn_rad(b) / k_piece_rad);
  const auto way_m = [&](double share) -> Eigen::Vector3d {
    const Eigen::Vector3d apart_m = (1.0 - share) * (seen_[a].position_m - seen_[b].position_m) +
                                    share * (now_[a].position_m - now_[b].position_m);
    if (ball) return apart_m;
    return seen_[b]
               .orientation.normalized()
               .slerp(share, now_[b].orientation.normalized())
               .conjugate() *
           apart_m;
  };
  Eigen::Vector3d from_m = way_m(0.0);
  for (int piece = 1; piece <= pieces; ++piece) {
    const Eigen::Vector3d to_m = way_m(static_cast<double>(piece) / pieces);
    if (least_on(from_m, to_m, gap_of) < k_passed_share * solids_[a].inner_m) return true;
    from_m = to_m;
  }
  return false;
}

}  // namespace brickbench
