// How a step of the soft map ends: Newton's law of restitution, attitudes, and the energy bound, in
// double precision.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>

#include "adapters/seam/shape.hpp"
#include "experiments/exact/schemes/scheme_map.hpp"
#include "experiments/exact/schemes/soft_map.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d world_inertia(const Body& body, const State& state) {
  const Matrix3d r = state.orientation.toRotationMatrix();
  return r * body.inertia_kgm2.asDiagonal() * r.transpose();
}

double kinetic_energy_j(const Body& body, const State& state, const Vector3d& velocity_mps,
                        const Vector3d& spin_radps) {
  return 0.5 * body.mass_kg * velocity_mps.squaredNorm() +
         0.5 * spin_radps.dot(world_inertia(body, state) * spin_radps);
}

}  // namespace

std::size_t SoftMap::island_of(const Row& row, const Islands& islands) const {
  return islands.of[row.a.fixed ? row.b.body : row.a.body];
}

// Bodies that pushed each other belong together; what is fixed does not join them.
SoftMap::Islands SoftMap::islands() const {
  const std::size_t n = run_.world.bodies.size();
  Islands islands{std::vector<std::size_t>(n), std::vector<bool>(n), std::vector<bool>(n),
                  std::vector<Law>(n, Law::none)};
  for (std::size_t i = 0; i < n; ++i) islands.of[i] = i;
  const auto pushed = [](const Row& row) {
    return std::ranges::any_of(row.points, &Point::pushed);
  };
  for (const Row& row : rows_) {
    if (!pushed(row)) continue;
    islands.touched[row.a.body] = islands.touched[row.b.body] = true;
    if (row.a.fixed || row.b.fixed) continue;
    const auto [least, most] = std::minmax(islands.of[row.a.body], islands.of[row.b.body]);
    const std::size_t from = most, to = least;
    std::ranges::replace(islands.of, from, to);
  }
  for (const Row& row : rows_) {
    if (!pushed(row)) continue;
    const std::size_t island = island_of(row, islands);
    if (row.a.fixed || row.b.fixed) islands.grounded[island] = true;
    if (std::ranges::none_of(row.points, &Point::struck)) continue;
    const bool bounces = contact_law(run_.world, row.a.body, row.b.body).restitution > 0.0;
    Law& law = islands.law[island];
    law = bounces || law == Law::bounce ? Law::bounce : Law::plastic;
  }
  return islands;
}

std::vector<SoftMap::Row*> SoftMap::in_order_of_pairs() {
  std::vector<Row*> rows;
  for (Row& row : rows_) rows.push_back(&row);
  std::ranges::sort(rows, {}, [](const Row* row) { return row->memory; });
  return rows;
}

// Newton's and Coulomb's laws as one problem of all contacts of the islands that were struck
// (Moreau 1988).
void SoftMap::bounce(const Islands& islands, std::span<const State> states,
                     std::vector<Motion>& motions) {
  std::vector<Firm> rows;
  double fastest_mps = 0.0;
  for (Row* row : in_order_of_pairs()) {
    if (islands.law[island_of(*row, islands)] == Law::none) continue;
    if (std::ranges::none_of(row->points, &Point::pushed)) continue;
    rows.push_back(firm(*row, states));
    for (const Point& point : row->points) {
      if (point.struck()) fastest_mps = std::max(fastest_mps, point.approach_mps);
    }
  }
  settle(rows, fastest_mps, motions);
  for (const Firm& row : rows) take(row);
}

// Bodies of islands that were struck go on from the last blow with the velocities that they end
// with, but for islands that would get deeper into something than the sub-steps brought them, or on
// the ground be lifted though nothing bounces.
void SoftMap::move_on(const Islands& islands, std::span<const Wrench> wrenches,
                      const std::vector<Motion>& motions) {
  const std::vector<Twist> trial = moved_;
  for (std::size_t i = 0; i < moved_.size(); ++i) {
    if (run_.world.bodies[i].fixed || !islands.touched[i]) continue;
    if (islands.law[islands.of[i]] == Law::none) continue;
    const Vector3d slower = motions[i].linear - velocity_[i].linear.cast<double>();
    const Vector3d turns = motions[i].angular - velocity_[i].angular.cast<double>();
    moved_[i].linear += (after_blow_s_ * slower).cast<float>();
    moved_[i].angular += (after_blow_s_ * turns).cast<float>();
  }
  std::vector<bool> meets(moved_.size(), false);
  for (const Row& row : rows_) {
    for (const Point& point : row.points) {
      const auto opened_m = [&](const std::vector<Twist>& moved) {
        return apart(row, row.normal, moved) + turning(row, point.arm, moved);
      };
      const double least_m = std::min(0.0F, point.gap_m) - too_deep_m(row.a.body, row.b.body);
      if (point.gap_m + opened_m(moved_) >= least_m) continue;
      if (opened_m(moved_) >= opened_m(trial)) continue;
      meets[islands.of[row.a.body]] = meets[islands.of[row.b.body]] = true;
    }
  }
  for (std::size_t i = 0; i < moved_.size(); ++i) {
    const double turn_rad = moved_[i].angular.cast<double>().norm();
    const double bent_m = 0.5 * bounding_radius_m(run_.world.bodies[i].shape) * turn_rad * turn_rad;
    if (bent_m > too_deep_m(i, i)) meets[islands.of[i]] = true;
  }
  std::vector<double> gained_j(moved_.size(), 0.0);
  for (std::size_t i = 0; i < moved_.size(); ++i) {
    const Body& body = run_.world.bodies[i];
    if (body.fixed) continue;
    const Vector3d force = body.mass_kg * run_.world.gravity_mps2 + wrenches[i].force_n;
    gained_j[islands.of[i]] +=
        force.dot(moved_[i].linear.cast<double>() - trial[i].linear.cast<double>());
  }
  for (std::size_t i = 0; i < moved_.size(); ++i) {
    const std::size_t root = islands.of[i];
    const bool lifts =
        islands.grounded[root] && islands.law[root] == Law::plastic && gained_j[root] < 0.0;
    if (meets[root] || lifts) moved_[i] = trial[i];
  }
}

// A manifold that bounced is open: nothing of its impulses goes on.
void SoftMap::remember_impulses(bool quiet) {
  for (Row& row : rows_) {
    const bool open = !quiet && std::ranges::any_of(row.points, &Point::bounced);
    for (std::size_t p = 0; p < row.points.size(); ++p) {
      row.memory->impulse_ns[p] = open ? 0.0F : row.points[p].impulse_ns;
    }
    row.memory->friction_ns =
        row.friction_ns[0] * row.tangent[0] + row.friction_ns[1] * row.tangent[1];
    row.memory->twist_ns = row.twist_ns;
    if (!open) continue;
    row.memory->friction_ns.setZero();
    row.memory->twist_ns = 0.0F;
  }
}

// Of a body that was pushed: it turns as in free flight from its mean spin over the step.
State SoftMap::end_of(std::size_t i, const State& state, const Motion& motion) const {
  const Body& body = run_.world.bodies[i];
  const Vector3d momentum = world_inertia(body, state) * motion.angular;
  const Vector3d turn_rad = moved_[i].angular.cast<double>();
  State end = state;
  end.position_m += moved_[i].linear.cast<double>();
  end.velocity_mps = motion.linear;
  if (turn_rad.norm() > soft_.small_turn_rad) {
    end.angular_velocity_radps = turn_rad / run_.step_s;
    turn_with_momentum(scheme_, body.inertia_kgm2, turn_rad / run_.step_s, run_.step_s, end);
  } else {
    const Vector3d moment = (world_inertia(body, state) * turn_rad).cross(turn_rad);
    const Vector3d bent_rad = turn_rad + 0.5 * spin_change(i, state, moment);
    end.orientation = (rotation_of(bent_rad) * state.orientation).normalized();
  }
  end.angular_velocity_radps = spin_change(i, end, momentum);
  return end;
}

// By the first body of each island.
std::vector<double> SoftMap::kinetic_j(const Islands& islands, std::span<const State> ends) const {
  std::vector<double> sums(ends.size(), 0.0);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const Body& body = run_.world.bodies[i];
    if (!islands.touched[i] || body.fixed) continue;
    sums[islands.of[i]] +=
        kinetic_energy_j(body, ends[i], ends[i].velocity_mps, ends[i].angular_velocity_radps);
  }
  return sums;
}

// What they had, and what gravity and loads did on the way.
std::vector<double> SoftMap::allowed_j(const Islands& islands, std::span<const Wrench> wrenches,
                                       std::span<const State> starts) const {
  std::vector<double> sums = kinetic_j(islands, starts);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const Body& body = run_.world.bodies[i];
    if (!islands.touched[i] || body.fixed) continue;
    const Vector3d force = body.mass_kg * run_.world.gravity_mps2 + wrenches[i].force_n;
    sums[islands.of[i]] += force.dot(moved_[i].linear.cast<double>()) +
                           wrenches[i].torque_nm.dot(moved_[i].angular.cast<double>());
  }
  return sums;
}

// Between what the contacts of an island gave and what they would give without any bounce: as much
// of the first as the energy allows, which is quadratic along the way.
void SoftMap::bounce_less(const Islands& islands, const std::vector<bool>& exceeds,
                          const std::vector<double>& allowed, std::span<const Wrench> wrenches,
                          std::span<const State> starts, std::span<State> ends) {
  std::vector<Motion> motions(ends.size());
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const Vector3d momentum =
        world_inertia(run_.world.bodies[i], ends[i]) * ends[i].angular_velocity_radps;
    motions[i] = {ends[i].velocity_mps, spin_change(i, starts[i], momentum)};
  }
  std::vector<Firm> rows;
  double fastest_m = 0.0;
  for (Row* row : in_order_of_pairs()) {
    const std::size_t island = island_of(*row, islands);
    if (!exceeds[island] || islands.law[island] == Law::plastic) continue;
    if (std::ranges::none_of(row->points, &Point::pushed)) continue;
    rows.push_back(firm(*row, starts));
    std::ranges::fill(rows.back().target_mps, 0.0);
    for (const std::size_t i : {row->a.body, row->b.body}) {
      fastest_m = std::max(fastest_m, reach_m(i, starts[i], wrenches[i]));
    }
  }
  if (rows.empty()) return;
  settle(rows, fastest_m / run_.step_s, motions);
  const std::vector<State> more(ends.begin(), ends.end());
  std::vector<State> less = more, middle = more;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (run_.world.bodies[i].fixed || !exceeds[islands.of[i]] || !islands.touched[i]) continue;
    less[i].velocity_mps = motions[i].linear;
    less[i].angular_velocity_radps = spin_change(
        i, less[i], world_inertia(run_.world.bodies[i], starts[i]) * motions[i].angular);
  }
  const auto blend = [&](std::size_t i, double share, State& into) {
    into.velocity_mps =
        less[i].velocity_mps + share * (more[i].velocity_mps - less[i].velocity_mps);
    into.angular_velocity_radps =
        less[i].angular_velocity_radps +
        share * (more[i].angular_velocity_radps - less[i].angular_velocity_radps);
  };
  for (std::size_t i = 0; i < ends.size(); ++i) blend(i, 0.5, middle[i]);
  const std::vector<double> first = kinetic_j(islands, less), half = kinetic_j(islands, middle),
                            last = kinetic_j(islands, more);
  std::vector<double> share(ends.size(), 1.0);
  for (std::size_t k = 0; k < ends.size(); ++k) {
    if (!exceeds[k]) continue;
    const double bend = std::max(0.0, 2.0 * (first[k] + last[k] - 2.0 * half[k]));
    const double slope = last[k] - first[k] - bend;
    const double room = allowed[k] - first[k];
    share[k] = room <= 0.0
                   ? 0.0
                   : std::clamp(2.0 * room / (slope + std::sqrt(slope * slope + 4.0 * bend * room)),
                                0.0, 1.0);
  }
  for (std::size_t i = 0; i < ends.size(); ++i) blend(i, share[islands.of[i]], ends[i]);
  for (Firm& row : rows) {
    const double part = share[island_of(*row.row, islands)];
    for (std::size_t p = 0; p < row.points.size(); ++p) {
      row.given_ns[p] += part * (row.points[p]->total_ns - row.given_ns[p]);
    }
    for (std::size_t k = 0; k < 2; ++k) {
      double& friction_ns = row.friction_ns[static_cast<Eigen::Index>(k)];
      friction_ns += part * (row.row->friction_total_ns[k] - friction_ns);
    }
    row.twist_nms += part * (row.row->twist_total_ns - row.twist_nms);
    take(row);
  }
}

// All motion of the members against each other shrinks by one factor.
void SoftMap::slow_down(const std::vector<std::size_t>& members, double allowed_j,
                        std::span<State> ends) const {
  const auto& bodies = run_.world.bodies;
  double mass_kg = 0.0;
  Vector3d centre = Vector3d::Zero(), drift = Vector3d::Zero();
  for (const std::size_t i : members) {
    mass_kg += bodies[i].mass_kg;
    centre += bodies[i].mass_kg * ends[i].position_m;
    drift += bodies[i].mass_kg * ends[i].velocity_mps;
  }
  centre /= mass_kg;
  drift /= mass_kg;
  Matrix3d inertia = Matrix3d::Zero();
  Vector3d momentum = Vector3d::Zero();
  for (const std::size_t i : members) {
    const Vector3d r = ends[i].position_m - centre;
    const Matrix3d own = world_inertia(bodies[i], ends[i]);
    inertia +=
        own + bodies[i].mass_kg * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
    momentum += own * ends[i].angular_velocity_radps +
                bodies[i].mass_kg * r.cross(ends[i].velocity_mps - drift);
  }
  const Vector3d spin = inertia.inverse() * momentum;
  const auto shared = [&](std::size_t i) -> Vector3d {
    return drift + spin.cross(ends[i].position_m - centre);
  };
  double common_j = 0.0, relative_j = 0.0;
  for (const std::size_t i : members) {
    common_j += kinetic_energy_j(bodies[i], ends[i], shared(i), spin);
    relative_j += kinetic_energy_j(bodies[i], ends[i], ends[i].velocity_mps - shared(i),
                                   ends[i].angular_velocity_radps - spin);
  }
  if (common_j + relative_j <= allowed_j) return;
  const double scale =
      relative_j > 0.0 ? std::sqrt(std::clamp((allowed_j - common_j) / relative_j, 0.0, 1.0)) : 0.0;
  for (const std::size_t i : members) {
    State& s = ends[i];
    s.velocity_mps = shared(i) + scale * (s.velocity_mps - shared(i));
    s.angular_velocity_radps = spin + scale * (s.angular_velocity_radps - spin);
  }
}

// Whether no island ends with more energy than it may have; on the ground, up to what gravity and
// loads do on the way that contacts cut short.
bool SoftMap::limit_energy(const Islands& islands, std::span<const Wrench> wrenches,
                           std::span<const State> starts, std::span<State> ends) {
  const std::size_t n = ends.size();
  const std::vector<double> allowed = allowed_j(islands, wrenches, starts);
  std::vector<double> now = kinetic_j(islands, ends);
  std::vector<bool> exceeds(n);
  const auto note = [&] {
    for (std::size_t k = 0; k < n; ++k) exceeds[k] = now[k] > allowed[k];
  };
  note();
  if (std::ranges::none_of(exceeds, std::identity())) return true;
  bounce_less(islands, exceeds, allowed, wrenches, starts, ends);
  now = kinetic_j(islands, ends);
  note();
  bool held = true;
  for (std::size_t root = 0; root < n; ++root) {
    if (!exceeds[root]) continue;
    std::vector<std::size_t> members;
    double room_j = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const Body& body = run_.world.bodies[i];
      if (islands.of[i] != root || !islands.touched[i] || body.fixed) continue;
      members.push_back(i);
      const Vector3d force = body.mass_kg * run_.world.gravity_mps2 + wrenches[i].force_n;
      room_j += force.norm() *
                (reach_m(i, starts[i], wrenches[i]) + moved_[i].linear.cast<double>().norm());
    }
    if (!islands.grounded[root]) {
      slow_down(members, allowed[root], ends);
      room_j = 0.0;
    }
    const double left_j = kinetic_j(islands, ends)[root] - std::max(allowed[root], 0.0) - room_j;
    held = held && left_j <= soft_.energy_share * now[root];
  }
  return held;
}

// Whether nothing that was pushed is, or was, faster than gravity makes it in a sub-step.
bool SoftMap::is_quiet(const Islands& islands, std::span<const Wrench> wrenches,
                       std::span<const State> states) const {
  const double slow_mps = run_.world.gravity_mps2.norm() * run_.step_s / soft_.substeps;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!islands.touched[i] || run_.world.bodies[i].fixed) continue;
    const double radius_m = bounding_radius_m(run_.world.bodies[i].shape);
    const double speed_mps = velocity_[i].linear.cast<double>().norm() +
                             velocity_[i].angular.cast<double>().norm() * radius_m;
    if (speed_mps > slow_mps || reach_m(i, states[i], wrenches[i]) > run_.step_s * slow_mps) {
      return false;
    }
  }
  return true;
}

bool SoftMap::turns_far(const Islands& islands) const {
  for (std::size_t i = 0; i < moved_.size(); ++i) {
    if (islands.touched[i] && moved_[i].angular.norm() > soft_.turn_limit_rad) return true;
  }
  return false;
}

// Bodies that a contact pushed take what the sub-steps gave, with Newton's law; the others fly
// freely. False where the step would be cut.
bool SoftMap::finish(std::span<const Wrench> wrenches, std::span<State> states) {
  const Islands found = islands();
  std::vector<Motion> motions = given(wrenches, states);
  const bool quiet = is_quiet(found, wrenches, states);
  if (!quiet) bounce(found, states, motions);
  if (!quiet && after_blow_s_ > 0.0) move_on(found, wrenches, motions);
  remember_impulses(quiet);
  const std::vector<State> starts(states.begin(), states.end());
  for (std::size_t i = 0; i < states.size(); ++i) {
    const Body& body = run_.world.bodies[i];
    if (body.fixed) continue;
    states[i] = found.touched[i] ? end_of(i, starts[i], motions[i])
                                 : next_free_state(scheme_, body, starts[i], wrenches[i],
                                                   run_.world.gravity_mps2, run_.step_s);
  }
  return quiet || limit_energy(found, wrenches, starts, states);
}

}  // namespace brickbench::exact
