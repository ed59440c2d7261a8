#include "experiments/exact/schemes/soft_map.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/exact/schemes/box_points.hpp"
#include "experiments/exact/schemes/scheme_map.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Matrix3d inverse_inertia(const Body& body, const Quaterniond& attitude) {
  const Matrix3d r = attitude.toRotationMatrix();
  return r * body.inertia_kgm2.cwiseInverse().asDiagonal() * r.transpose();
}

// With one rounding per product and sum.
float dot(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return std::fma(a.z(), b.z(), std::fma(a.y(), b.y(), a.x() * b.x()));
}
void add(Eigen::Vector3f& sum, const Eigen::Vector3f& direction, float scale) {
  for (Eigen::Index k = 0; k < 3; ++k) sum[k] = std::fma(direction[k], scale, sum[k]);
}
Eigen::Vector3f times(const Eigen::Matrix3f& m, const Eigen::Vector3f& v) {
  return {dot(m.row(0), v), dot(m.row(1), v), dot(m.row(2), v)};
}
float inverse(float x) { return x > 0.0F ? 1.0F / x : 0.0F; }
float norm_of(float x, float y) { return std::sqrt(std::fma(x, x, y * y)); }

}  // namespace

SoftMap::SoftMap(const Scheme& scheme, const ExactRun& run)
    : scheme_(scheme),
      soft_(*scheme.soft()),
      run_(run),
      velocity_(run.world.bodies.size()),
      moved_(run.world.bodies.size()) {
  if (!run_.geometry) run_.geometry = all_pairs(run_.world);
}

SoftMap::Side SoftMap::side(std::size_t body, const State& state) const {
  const Body& fact = run_.world.bodies[body];
  Side side;
  side.body = body;
  side.fixed = fact.fixed;
  if (fact.fixed) return side;
  side.inverse_mass = static_cast<float>(1.0 / fact.mass_kg);
  side.inverse_inertia = inverse_inertia(fact, state.orientation).cast<float>();
  return side;
}

SoftMap::Arm SoftMap::arm(const Row& row, const Vector& lever_a, const Vector& lever_b,
                          const Vector& direction) const {
  Arm arm;
  arm.on_a = lever_a.cross(direction);
  arm.on_b = lever_b.cross(direction);
  arm.turn_a = times(row.a.inverse_inertia, arm.on_a);
  arm.turn_b = times(row.b.inverse_inertia, arm.on_b);
  return arm;
}

// Effective masses: along the normal at each point, for the two tangents in the middle of the
// points, and about the normal, where friction acts at the points' mean distance from the middle.
void SoftMap::prepare(Row& row) const {
  const float inverse_mass = row.a.inverse_mass + row.b.inverse_mass;
  Vector middle = Vector::Zero();
  for (const Point& point : row.points) middle += point.lever_a;
  const float share = 1.0F / static_cast<float>(row.points.size());
  middle *= share;
  float distances_m = 0.0F;
  for (Point& point : row.points) {
    point.arm = arm(row, point.lever_a, point.lever_b, row.normal);
    point.mass = inverse(inverse_mass + (dot(point.arm.on_a, point.arm.turn_a) +
                                         dot(point.arm.on_b, point.arm.turn_b)));
    const Vector off = point.lever_a - middle;
    distances_m += std::sqrt(dot(off, off));
  }
  row.twist_lever_m = distances_m * share;
  row.twist.turn_a = times(row.a.inverse_inertia, row.normal);
  row.twist.turn_b = times(row.b.inverse_inertia, row.normal);
  row.twist_mass = inverse(dot(row.normal, row.twist.turn_a) + dot(row.normal, row.twist.turn_b));
  row.twist_ns = row.memory->twist_ns;
  prepare_friction(row);
}

void SoftMap::prepare_friction(Row& row) const {
  const float inverse_mass = row.a.inverse_mass + row.b.inverse_mass;
  Eigen::Index least = 0;
  row.normal.cwiseAbs().minCoeff(&least);
  const Vector first = row.normal.cross(Vector::Unit(least));
  row.tangent[0] = first * inverse(std::sqrt(dot(first, first)));
  row.tangent[1] = row.normal.cross(row.tangent[0]);
  Vector middle_a = Vector::Zero(), middle_b = Vector::Zero();
  for (const Point& point : row.points) {
    middle_a += point.lever_a;
    middle_b += point.lever_b;
  }
  const float share = 1.0F / static_cast<float>(row.points.size());
  for (std::size_t k = 0; k < 2; ++k) {
    row.friction_arm[k] = arm(row, middle_a * share, middle_b * share, row.tangent[k]);
    row.friction_ns[k] = dot(row.tangent[k], row.memory->friction_ns);
  }
  const auto& [arm_1, arm_2] = row.friction_arm;
  const auto response = [](const Arm& felt, const Arm& pushed) {
    return dot(felt.on_a, pushed.turn_a) + dot(felt.on_b, pushed.turn_b);
  };
  const float k_11 = inverse_mass + response(arm_1, arm_1);
  const float k_22 = inverse_mass + response(arm_2, arm_2);
  const float k_12 = response(arm_1, arm_2);
  const float scale = inverse(k_11 * k_22 - k_12 * k_12);
  row.friction_mass_11 = k_22 * scale;
  row.friction_mass_22 = k_11 * scale;
  row.friction_mass_12 = -(k_12 * scale);
}

// Single precision adds thousands of small changes, so how each is rounded is part of the scheme:
// products and sums are contracted, impulse times inverse mass first. What an impulse (N s) on b
// and its reaction on a change in the velocities of the centres ...
void SoftMap::shift(const Row& row, const Vector& direction, float impulse_ns,
                    std::vector<Twist>& twists) {
  if (!row.a.fixed) add(twists[row.a.body].linear, direction, -(impulse_ns * row.a.inverse_mass));
  if (!row.b.fixed) add(twists[row.b.body].linear, direction, impulse_ns * row.b.inverse_mass);
}

// ... and in the spins.
void SoftMap::turn(const Row& row, const Arm& arm, float impulse_ns, std::vector<Twist>& twists) {
  if (!row.a.fixed) add(twists[row.a.body].angular, arm.turn_a, -impulse_ns);
  if (!row.b.fixed) add(twists[row.b.body].angular, arm.turn_b, impulse_ns);
}

// How fast b moves from a along the unit vector `direction`: what the centres do ...
float SoftMap::apart(const Row& row, const Vector& direction, const std::vector<Twist>& twists) {
  const auto linear = [&](const Side& s) -> Vector {
    return s.fixed ? Vector(Vector::Zero()) : twists[s.body].linear;
  };
  return dot(direction, linear(row.b) - linear(row.a));
}

// ... and what the spins add.
float SoftMap::turning(const Row& row, const Arm& arm, const std::vector<Twist>& twists) {
  const float on_a = row.a.fixed ? 0.0F : dot(arm.on_a, twists[row.a.body].angular);
  const float on_b = row.b.fixed ? 0.0F : dot(arm.on_b, twists[row.b.body].angular);
  return on_b - on_a;
}

// E. Catto, Solver2D, 2024: an overlap is a damped spring in the biased sweep and rigid in the
// relaxing one; an open gap may close within the sub-step in both. Points in their order; the
// centres get the sum of their impulses. Returns the load: the sum of all impulses they hold.
float SoftMap::serve_points(Row& row, bool biased) {
  const double h = run_.step_s / soft_.substeps;
  const double omega = std::min(2.0 * std::numbers::pi * soft_.frequency_hz, 1.0 / h);
  const double damping = 2.0 * soft_.damping_ratio + h * omega;
  const double forget = 1.0 / (1.0 + h * omega * damping);
  const float inverse_step = 1.0F / static_cast<float>(h);
  const float inverse_mass = row.a.inverse_mass + row.b.inverse_mass;
  float approach_mps = apart(row, row.normal, velocity_);
  float applied_ns = 0.0F, load_ns = 0.0F;
  for (Point& point : row.points) {
    if (!biased) {
      point.gap_now_m =
          (point.gap_m + apart(row, row.normal, moved_)) + turning(row, point.arm, moved_);
    }
    float bias_mps = point.gap_now_m * inverse_step;
    float mass_share = 1.0F, impulse_share = 0.0F;
    if (!(point.gap_now_m > 0.0F)) {
      bias_mps = biased ? std::max(static_cast<float>(omega / damping) * point.gap_now_m,
                                   -static_cast<float>(soft_.push_limit_mps))
                        : 0.0F;
      mass_share = biased ? static_cast<float>(1.0 - forget) : 1.0F;
      impulse_share = biased ? static_cast<float>(forget) : 0.0F;
    }
    const float speed_mps = approach_mps + turning(row, point.arm, velocity_);
    const float wanted_ns =
        std::fma(point.mass * mass_share, speed_mps + bias_mps, impulse_share * point.impulse_ns);
    const float next_ns = std::max(point.impulse_ns - wanted_ns, 0.0F);
    const float change_ns = next_ns - point.impulse_ns;
    point.impulse_ns = next_ns;
    point.largest_ns = std::max(point.largest_ns, next_ns);
    approach_mps = std::fma(change_ns, inverse_mass, approach_mps);
    applied_ns += change_ns;
    load_ns += next_ns;
    turn(row, point.arm, change_ns, velocity_);
  }
  shift(row, row.normal, applied_ns, velocity_);
  return load_ns;
}

// Coulomb's law for the manifold as a whole, in the middle of its points: one step that stops it,
// or, where that takes too much, one against the slip by the least mass of any direction.
void SoftMap::serve_friction(Row& row, float load_ns) {
  std::array<float, 2> slip_mps{};
  for (std::size_t k = 0; k < 2; ++k) {
    slip_mps[k] =
        apart(row, row.tangent[k], velocity_) + turning(row, row.friction_arm[k], velocity_);
  }
  std::array<float, 2> next_ns = {
      row.friction_ns[0] -
          std::fma(row.friction_mass_11, slip_mps[0], row.friction_mass_12 * slip_mps[1]),
      row.friction_ns[1] -
          std::fma(row.friction_mass_22, slip_mps[1], row.friction_mass_12 * slip_mps[0])};
  const float limit_ns = row.friction * load_ns;
  if (norm_of(next_ns[0], next_ns[1]) > limit_ns) {
    const float mass =
        0.5F * (row.friction_mass_11 + row.friction_mass_22) -
        norm_of(0.5F * (row.friction_mass_11 - row.friction_mass_22), row.friction_mass_12);
    for (std::size_t k = 0; k < 2; ++k) next_ns[k] = row.friction_ns[k] - mass * slip_mps[k];
    const float length_ns = norm_of(next_ns[0], next_ns[1]);
    const float scale = length_ns > limit_ns ? limit_ns / length_ns : 1.0F;
    for (float& next : next_ns) next *= scale;
  }
  for (std::size_t k = 0; k < 2; ++k) {
    const float change_ns = next_ns[k] - row.friction_ns[k];
    row.friction_ns[k] = next_ns[k];
    shift(row, row.tangent[k], change_ns, velocity_);
    turn(row, row.friction_arm[k], change_ns, velocity_);
  }
}

void SoftMap::serve_twist(Row& row, float load_ns) {
  const auto spin = [&](const Side& s) -> Vector {
    return s.fixed ? Vector(Vector::Zero()) : velocity_[s.body].angular;
  };
  const float spin_radps = dot(row.normal, spin(row.b) - spin(row.a));
  const float limit = row.friction * load_ns * row.twist_lever_m;
  const float next = std::clamp(row.twist_ns - row.twist_mass * spin_radps, -limit, limit);
  const float change = next - row.twist_ns;
  row.twist_ns = next;
  turn(row, row.twist, change, velocity_);
}

void SoftMap::sweep(bool biased, bool forwards) {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Row& row = rows_[forwards ? i : rows_.size() - 1 - i];
    const float load_ns = serve_points(row, biased);
    serve_friction(row, load_ns);
    serve_twist(row, load_ns);
  }
}

// What the last sweep of a sub-step holds is what the sub-step applied.
void SoftMap::count() {
  for (Row& row : rows_) {
    for (Point& point : row.points) point.total_ns += point.impulse_ns;
    for (std::size_t k = 0; k < 2; ++k) row.friction_total_ns[k] += row.friction_ns[k];
    row.twist_total_ns += row.twist_ns;
  }
}

// Whether some impulse is beyond twice what the sub-step began with and the weight.
bool SoftMap::has_blow() const {
  return std::ranges::any_of(rows_, [](const Row& row) {
    return std::ranges::any_of(row.points, [&](const Point& point) {
      return point.impulse_ns > 2.0F * point.carried_ns + row.weight_ns;
    });
  });
}

// What is beyond does not go on to the next sub-step: it is added to the velocities that the bodies
// would have without contact.
void SoftMap::drop_blows(std::vector<Twist>& flown) {
  const auto push = [&](const Row& row, const Vector* direction, const Arm& arm, float impulse) {
    for (const bool of_b : {false, true}) {
      const Side& side = of_b ? row.b : row.a;
      if (side.fixed) continue;
      const float sign = of_b ? 1.0F : -1.0F;
      if (direction != nullptr) {
        flown[side.body].linear += sign * (impulse * side.inverse_mass) * *direction;
      }
      flown[side.body].angular += sign * impulse * (of_b ? arm.turn_b : arm.turn_a);
    }
  };
  for (Row& row : rows_) {
    float all_ns = 0.0F, kept_ns = 0.0F;
    for (Point& point : row.points) {
      const float load_ns = std::min(point.impulse_ns, 2.0F * point.carried_ns + row.weight_ns);
      all_ns += point.impulse_ns;
      kept_ns += load_ns;
      if (load_ns < point.impulse_ns) {
        push(row, &row.normal, point.arm, point.impulse_ns - load_ns);
      }
      point.carried_ns = point.impulse_ns = load_ns;
    }
    if (!(kept_ns < all_ns)) continue;
    const float share = 1.0F - kept_ns / all_ns;
    for (std::size_t k = 0; k < 2; ++k) {
      const float dropped_ns = share * row.friction_ns[k];
      push(row, &row.tangent[k], row.friction_arm[k], dropped_ns);
      row.friction_ns[k] -= dropped_ns;
    }
    const float dropped = share * row.twist_ns;
    push(row, nullptr, row.twist, dropped);
    row.twist_ns -= dropped;
  }
}

double SoftMap::too_deep_m(std::size_t body_a, std::size_t body_b) const {
  return soft_.too_deep_share *
         std::min(soft_.margin_m, soft_.same_point_share * thinner_m(body_a, body_b));
}

// Whether some known point ends deeper than it was, and than zero, by too much.
bool SoftMap::leaves_too_deep() const {
  for (const Row& row : rows_) {
    if (row.reach_m <= soft_.margin_m) continue;
    for (const Point& point : row.points) {
      const float end_m =
          point.gap_m + apart(row, row.normal, moved_) + turning(row, point.arm, moved_);
      const double deeper_m = std::min(0.0F, point.gap_m) - end_m;
      if (deeper_m > too_deep_m(row.a.body, row.b.body)) return true;
    }
  }
  return false;
}

// Whether two boxes end deeper in each other, by as much, than their contacts say.
bool SoftMap::overlooks(std::span<const State> ends) const {
  const auto box = [&](std::size_t i) { return box_of(run_.world.bodies[i].shape); };
  for (const Memory& memory : memories_) {
    const std::size_t a = memory.body_a, b = memory.body_b;
    if (box(a) == nullptr || box(b) == nullptr) continue;
    const auto row = std::ranges::find_if(rows_, [&](const Row& r) { return r.memory == &memory; });
    const double tolerance_m = too_deep_m(a, b);
    double seen_m = 0.0;
    if (row != rows_.end()) {
      if (row->reach_m <= soft_.margin_m) continue;
      for (const Point& point : row->points) {
        const float end_m =
            point.gap_m + apart(*row, row->normal, moved_) + turning(*row, point.arm, moved_);
        seen_m = std::min(seen_m, static_cast<double>(end_m));
      }
    }
    const BoxPoints end =
        box_points(soft_.boxes, box(a)->half_extents_m, ends[a], box(b)->half_extents_m, ends[b]);
    if (end.gap_m > -tolerance_m) continue;
    for (const BoxPoint& point : end.points) {
      if (seen_m - point.gap_m > tolerance_m) return true;
    }
  }
  return false;
}

void SoftMap::run_substeps(std::span<const Wrench> wrenches, std::span<const State> states) {
  const double h = run_.step_s / soft_.substeps;
  std::vector<Twist> carried(states.size()), free(states.size());
  for (const Row& row : rows_) {
    for (const Point& point : row.points) {
      shift(row, row.normal, point.impulse_ns, carried);
      turn(row, point.arm, point.impulse_ns, carried);
    }
    for (std::size_t k = 0; k < 2; ++k) {
      shift(row, row.tangent[k], row.friction_ns[k], carried);
      turn(row, row.friction_arm[k], row.friction_ns[k], carried);
    }
    turn(row, row.twist, row.twist_ns, carried);
  }
  for (std::size_t i = 0; i < states.size(); ++i) {
    moved_[i] = {};
    const Body& body = run_.world.bodies[i];
    if (body.fixed) continue;
    velocity_[i] = {states[i].velocity_mps.cast<float>(),
                    states[i].angular_velocity_radps.cast<float>()};
    const Vector3d pull = run_.world.gravity_mps2 + wrenches[i].force_n / body.mass_kg;
    const Vector3d turn = inverse_inertia(body, states[i].orientation) * wrenches[i].torque_nm;
    free[i] = {(h * pull).cast<float>(), (h * turn).cast<float>()};
  }
  const auto for_twists = [&](auto change) {
    for (std::size_t i = 0; i < states.size(); ++i) {
      if (!run_.world.bodies[i].fixed) change(i);
    }
  };
  after_blow_s_ = 0.0;
  const bool blows = std::ranges::any_of(rows_, [](const Row& row) {
    return std::ranges::any_of(row.points, [](const Point& p) { return p.approach_mps > 0.0; });
  });
  for (int s = 0; s < soft_.substeps; ++s) {
    for_twists([&](std::size_t i) {
      const Twist flown = {velocity_[i].linear + free[i].linear,
                           velocity_[i].angular + free[i].angular};
      velocity_[i] = {flown.linear + carried[i].linear, flown.angular + carried[i].angular};
      carried[i] = flown;
    });
    int sweeps = sweeps_;
    for (int k = 0; k < sweeps; ++k) {
      sweep(true, (s + k) % 2 == 0);
      if (k > 0 || !blows || !has_blow()) continue;
      sweeps = soft_.most_sweeps;
      after_blow_s_ = h * (soft_.substeps - 1 - s);
    }
    for_twists([&](std::size_t i) {
      moved_[i].linear += static_cast<float>(h) * velocity_[i].linear;
      moved_[i].angular += static_cast<float>(h) * velocity_[i].angular;
    });
    for (int k = 0; k < sweeps; ++k) sweep(false, (s + k) % 2 != 0);
    count();
    if (blows) drop_blows(carried);
    for_twists([&](std::size_t i) {
      carried[i] = {velocity_[i].linear - carried[i].linear,
                    velocity_[i].angular - carried[i].angular};
    });
  }
}

// A step is done again with twice the sweeps per sub-step where known contacts end too deep.
bool SoftMap::advance(std::span<const Wrench> wrenches, std::span<State> states, std::string& why) {
  if (!remember(wrenches, states, why)) return false;
  sweeps_ = 1;
  bool settled = false;
  for (int trial = 0; trial < soft_.most_trials; ++trial) {
    make_rows(wrenches, states);
    run_substeps(wrenches, states);
    settled = !leaves_too_deep();
    if (settled || sweeps_ == soft_.most_sweeps) break;
    sweeps_ = std::min(2 * sweeps_, soft_.most_sweeps);
  }
  if (!settled || turns_far(islands()) || !finish(wrenches, states)) {
    why = "a step is cut";
    return false;
  }
  if (overlooks(states)) {
    why = "a step ends with an overlap that its contacts do not show";
    return false;
  }
  return true;
}

}  // namespace brickbench::exact
