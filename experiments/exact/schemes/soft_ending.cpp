// How a step of the soft map ends: Newton's law of restitution, attitudes, and the energy bound, in
// double precision.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "adapters/seam/shape.hpp"
#include "experiments/exact/schemes/scheme_map.hpp"
#include "experiments/exact/schemes/soft_map.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// A row is solved for itself in so many rounds at most.
constexpr int k_row_rounds = 64;
// Of what is enough between rows, and of what the first round changed: enough within one.
constexpr double k_row_share = 0.1;
constexpr double k_round_share = 0.01;

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

// Bodies that pushed each other belong together; what is fixed does not join them.
SoftMap::Islands SoftMap::islands() const {
  const std::size_t n = run_.world.bodies.size();
  Islands islands{std::vector<std::size_t>(n), std::vector<bool>(n), std::vector<bool>(n),
                  std::vector<bool>(n)};
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
    const std::size_t island = islands.of[row.a.fixed ? row.b.body : row.a.body];
    if (row.a.fixed || row.b.fixed) islands.grounded[island] = true;
    if (std::ranges::any_of(row.points, &Point::struck)) islands.struck[island] = true;
  }
  return islands;
}

std::vector<SoftMap::Row*> SoftMap::in_order_of_pairs() {
  std::vector<Row*> rows;
  for (Row& row : rows_) rows.push_back(&row);
  std::ranges::sort(rows, {}, [](const Row* row) { return row->memory; });
  return rows;
}

Vector3d SoftMap::spin_change(std::size_t i, const State& state, const Vector3d& moment_nms) const {
  const Body& body = run_.world.bodies[i];
  if (body.fixed) return Vector3d::Zero();
  const Matrix3d r = state.orientation.toRotationMatrix();
  return r * (r.transpose() * moment_nms).cwiseQuotient(body.inertia_kgm2);
}

// Projected Gauss-Seidel on the pushed points of one manifold. Returns by how much the velocity of
// one of them changed.
double SoftMap::settle_row(Row& row, double enough_mps, std::span<const State> states,
                           std::vector<Motion>& motions) const {
  const auto inverse_mass = [&](const Side& s) {
    return s.fixed ? 0.0 : 1.0 / run_.world.bodies[s.body].mass_kg;
  };
  const double mass_a = inverse_mass(row.a), mass_b = inverse_mass(row.b);
  std::vector<Point*> points;
  for (Point& point : row.points) {
    if (point.pushed()) points.push_back(&point);
  }
  const std::size_t n = points.size();
  if (n == 0) return 0.0;
  Motion& a = motions[row.a.body];
  Motion& b = motions[row.b.body];
  const Vector3d& normal = points.front()->view.normal;
  std::vector<Vector3d> turn_a(n), turn_b(n);
  std::vector<double> before(n), change(n, 0.0);
  const double apart = normal.dot(b.linear - a.linear);
  for (std::size_t p = 0; p < n; ++p) {
    turn_a[p] = spin_change(row.a.body, states[row.a.body], points[p]->on_a);
    turn_b[p] = spin_change(row.b.body, states[row.b.body], points[p]->on_b);
    const double target = points[p]->struck() ? double{points[p]->bounce_mps} : 0.0;
    before[p] = apart + points[p]->on_b.dot(b.angular) - points[p]->on_a.dot(a.angular) - target;
  }
  std::vector<double> now = before;
  const auto response = [&](std::size_t p, std::size_t q) {
    return mass_a + mass_b + points[p]->on_a.dot(turn_a[q]) + points[p]->on_b.dot(turn_b[q]);
  };
  double stop_mps = k_row_share * enough_mps;
  for (int round = 0; round < k_row_rounds; ++round) {
    double largest_mps = 0.0;
    for (std::size_t p = 0; p < n; ++p) {
      Point& point = *points[p];
      const double old_ns = point.rebound_ns;
      const double least_ns = point.struck() ? -double{point.total_ns} : 0.0;
      point.rebound_ns = std::max(least_ns, old_ns - now[p] / response(p, p));
      const double step_ns = point.rebound_ns - old_ns;
      change[p] += step_ns;
      for (std::size_t q = 0; q < n; ++q) now[q] += response(q, p) * step_ns;
      largest_mps = std::max(largest_mps, std::abs(step_ns) * response(p, p));
    }
    if (round == 0) stop_mps = std::max(stop_mps, k_round_share * largest_mps);
    if (largest_mps <= stop_mps) break;
  }
  double sum_ns = 0.0, changed_mps = 0.0;
  for (std::size_t p = 0; p < n; ++p) {
    sum_ns += change[p];
    a.angular -= change[p] * turn_a[p];
    b.angular += change[p] * turn_b[p];
    changed_mps = std::max(changed_mps, std::abs(now[p] - before[p]));
  }
  a.linear -= sum_ns * mass_a * normal;
  b.linear += sum_ns * mass_b * normal;
  return changed_mps;
}

// Newton's law of restitution as one problem of all contacts (Moreau 1988), by sweeps to and fro
// over the manifolds; those whose bodies no longer move are left out. Where no pair that was struck
// bounces, of the struck manifolds alone.
void SoftMap::bounce(const Islands& islands, std::span<const State> states,
                     std::vector<Motion>& motions) {
  std::vector<Row*> rows;
  double fastest_mps = 0.0;
  bool bounces = false;
  for (const Row& row : rows_) {
    const bool struck = std::ranges::any_of(row.points, &Point::struck);
    bounces =
        bounces || (struck && contact_law(run_.world, row.a.body, row.b.body).restitution > 0.0);
  }
  for (Row* row : in_order_of_pairs()) {
    if (!bounces && std::ranges::none_of(row->points, &Point::struck)) continue;
    if (!islands.struck[islands.of[row->a.fixed ? row->b.body : row->a.body]]) continue;
    if (std::ranges::none_of(row->points, &Point::pushed)) continue;
    rows.push_back(row);
    for (const Point& point : row->points) {
      if (point.struck()) fastest_mps = std::max(fastest_mps, point.approach_mps);
    }
  }
  const double enough_mps = soft_.rebound_share * fastest_mps;
  std::vector<int> moved_in(motions.size(), 0);
  for (int sweep = 1; sweep <= soft_.rebound_sweeps; ++sweep) {
    bool changed = false;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      Row& row = *rows[sweep % 2 == 1 ? k : rows.size() - 1 - k];
      if (std::max(moved_in[row.a.body], moved_in[row.b.body]) < sweep - 1) continue;
      if (settle_row(row, enough_mps, states, motions) <= enough_mps) continue;
      changed = true;
      for (const Side* side : {&row.a, &row.b}) {
        if (!side->fixed) moved_in[side->body] = sweep;
      }
    }
    if (!changed) break;
  }
}

// A manifold that bounced is open: nothing of its impulses goes on.
void SoftMap::remember_impulses(bool quiet) {
  for (Row& row : rows_) {
    const bool open = !quiet && std::ranges::any_of(row.points, &Point::bounced);
    for (std::size_t p = 0; p < row.points.size(); ++p) {
      row.points[p].total_ns += static_cast<float>(row.points[p].rebound_ns);
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

// An island whose kinetic energy exceeds what it had and what gravity and loads did on the way
// loses of all motion against itself, or against what is fixed, by one factor. Whether that is
// enough.
bool SoftMap::limit_energy(const Islands& islands, std::span<const Wrench> wrenches,
                           std::span<const State> starts, std::span<State> ends) const {
  const std::size_t n = ends.size();
  const auto& bodies = run_.world.bodies;
  bool held = true;
  for (std::size_t root = 0; root < n; ++root) {
    std::vector<std::size_t> members;
    double allowed_j = 0.0, kinetic_j = 0.0, mass_kg = 0.0;
    Vector3d centre = Vector3d::Zero(), drift = Vector3d::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      if (islands.of[i] != root || !islands.touched[i] || bodies[i].fixed) continue;
      members.push_back(i);
      const Vector3d force = bodies[i].mass_kg * run_.world.gravity_mps2 + wrenches[i].force_n;
      allowed_j += kinetic_energy_j(bodies[i], starts[i], starts[i].velocity_mps,
                                    starts[i].angular_velocity_radps) +
                   force.dot(moved_[i].linear.cast<double>()) +
                   wrenches[i].torque_nm.dot(moved_[i].angular.cast<double>());
      kinetic_j += kinetic_energy_j(bodies[i], ends[i], ends[i].velocity_mps,
                                    ends[i].angular_velocity_radps);
      mass_kg += bodies[i].mass_kg;
      centre += bodies[i].mass_kg * ends[i].position_m;
      drift += bodies[i].mass_kg * ends[i].velocity_mps;
    }
    if (members.empty() || kinetic_j <= allowed_j) continue;
    Vector3d spin = Vector3d::Zero();
    centre /= mass_kg;
    drift /= mass_kg;
    if (islands.grounded[root]) {
      centre.setZero();
      drift.setZero();
    } else {
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
      spin = inertia.inverse() * momentum;
    }
    double common_j = 0.0, relative_j = 0.0;
    const auto shared = [&](std::size_t i) -> Vector3d {
      return drift + spin.cross(ends[i].position_m - centre);
    };
    for (const std::size_t i : members) {
      common_j += kinetic_energy_j(bodies[i], ends[i], shared(i), spin);
      relative_j += kinetic_energy_j(bodies[i], ends[i], ends[i].velocity_mps - shared(i),
                                     ends[i].angular_velocity_radps - spin);
    }
    const double scale = relative_j > 0.0
                             ? std::sqrt(std::clamp((allowed_j - common_j) / relative_j, 0.0, 1.0))
                             : 0.0;
    for (const std::size_t i : members) {
      State& s = ends[i];
      s.velocity_mps = shared(i) + scale * (s.velocity_mps - shared(i));
      s.angular_velocity_radps = spin + scale * (s.angular_velocity_radps - spin);
    }
    const double left_j = common_j + scale * scale * relative_j;
    held = held && left_j - std::max(allowed_j, 0.0) <= soft_.energy_share * kinetic_j;
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
  std::vector<Motion> motions(states.size());
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (run_.world.bodies[i].fixed) continue;
    motions[i] = {velocity_[i].linear.cast<double>(), velocity_[i].angular.cast<double>()};
  }
  const bool quiet = is_quiet(found, wrenches, states);
  if (!quiet) bounce(found, states, motions);
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
