// How a step of the fast engine ends once its contacts are settled: islands of bodies that touched,
// Newton's law of restitution within them, and their energy.
#include <algorithm>

#include "ourengine/fast/fast_dynamics.hpp"
#include "ourengine/fast/soft_vector.hpp"
#include "ourengine/integration/rotation.hpp"

namespace ourengine {
namespace {

constexpr std::size_t k_bodies_per_piece = 256;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

bool pushed(const SoftPoint& point, std::size_t lane) { return point.max_impulse[lane] > 0.0F; }
bool struck(const SoftPoint& point, std::size_t lane) {
  return pushed(point, lane) && point.bounce[lane] >= 0.0F;
}

}  // namespace

int FastDynamics::island_of(int body) {
  while (island_[at(body)] != body) {
    island_[at(body)] = island_[at(island_[at(body)])];
    body = island_[at(body)];
  }
  return body;
}

// Whether nothing that was pushed is, or was, faster than gravity makes it in a sub-step: then
// there was no hit, and any energy is less than that of the springs at rest.
bool FastDynamics::is_quiet() const {
  const double slow_mps = options_.gravity_mps2.norm() * step_s_ / options_.substeps;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (touched_[i] == 0 || bodies_[i].fixed) continue;
    if (poses_[i].reach_m > step_s_ * slow_mps) return false;
    const double speed_mps =
        linear_part(velocity_[i]).norm() + angular_part(velocity_[i]).norm() * radius_m_[i];
    if (speed_mps > slow_mps) return false;
  }
  return true;
}

// Bodies that pushed each other are of one island, whose root is its first body.
void FastDynamics::join_islands() {
  island_.resize(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) island_[i] = static_cast<int>(i);
  grounded_.assign(bodies_.size(), 0);
  for (const Slot& slot : slots_) {
    if (!slot.pushed) continue;
    const SoftManifold& manifold = solved_manifold(at(slot.manifold));
    const bool a_fixed = bodies_[at(manifold.body_a)].fixed;
    if (a_fixed || bodies_[at(manifold.body_b)].fixed) {
      grounded_[at(a_fixed ? manifold.body_b : manifold.body_a)] = 1;
      continue;
    }
    const int a = island_of(manifold.body_a);
    const int b = island_of(manifold.body_b);
    island_[at(std::max(a, b))] = std::min(a, b);
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    island_[i] = island_of(static_cast<int>(i));
    if (grounded_[i] != 0) grounded_[at(island_[i])] = 1;
  }
}

// Islands with nothing fixed have the momentum that gravity and loads give them, in double
// precision: the roundings of the sub-steps would be energy of their common motion, of which a
// light body that a heavy one strikes has too little to pay for.
void FastDynamics::restore_momentum() {
  struct Sum {
    double mass_kg = 0.0;
    Eigen::Vector3d missing_ns = Eigen::Vector3d::Zero();
  };
  std::vector<Sum> islands(bodies_.size());
  const auto is_afloat = [&](std::size_t i) {
    return touched_[i] != 0 && !bodies_[i].fixed && grounded_[at(island_[i])] == 0;
  };
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (!is_afloat(i)) continue;
    const double mass_kg = bodies_[i].mass_kg;
    Sum& island = islands[at(island_[i])];
    island.mass_kg += mass_kg;
    island.missing_ns += mass_kg * (motions_[i].velocity_mps - ends_[i].velocity_mps) +
                         step_s_ * (mass_kg * options_.gravity_mps2 + loads_[i].force_n);
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (!is_afloat(i)) continue;
    const Sum& island = islands[at(island_[i])];
    ends_[i].velocity_mps += island.missing_ns / island.mass_kg;
  }
}

Twist FastDynamics::twist_of(std::size_t i) const {
  return {ends_[i].velocity_mps,
          angular_velocity_radps(motions_[i].attitude, bodies_[i].inertia_kgm2,
                                 ends_[i].angular_momentum_kgm2ps)};
}

void FastDynamics::set_twist(std::size_t i, const Twist& twist) {
  ends_[i].velocity_mps = twist.linear;
  ends_[i].angular_momentum_kgm2ps = momentum_of(i, twist.angular);
}

ReboundRow FastDynamics::rebound_row(const Slot& slot) const {
  const SoftManifold& manifold = solved_manifold(at(slot.manifold));
  const SoftBatch& batch = batches_[at(slot.batch)];
  ReboundRow row;
  row.body_a = manifold.body_a;
  row.body_b = manifold.body_b;
  row.normal = manifold.normal;
  const auto turn = [&](int i, const Eigen::Vector3d& arm) -> Eigen::Vector3d {
    const BodyModel& body = bodies_[at(i)];
    if (body.fixed) return Eigen::Vector3d::Zero();
    const Eigen::Matrix3d& r = poses_[at(i)].axes;
    return r * (r.transpose() * arm).cwiseQuotient(body.inertia_kgm2);
  };
  const auto inverse_mass = [&](int i) {
    return bodies_[at(i)].fixed ? 0.0 : 1.0 / bodies_[at(i)].mass_kg;
  };
  row.inverse_mass_a = inverse_mass(row.body_a);
  row.inverse_mass_b = inverse_mass(row.body_b);
  for (std::size_t p = 0; p < at(manifold.count); ++p) {
    const SoftPoint& point = batch.point[p];
    if (!pushed(point, at(slot.lane))) continue;
    const std::size_t q = row.count++;
    const Eigen::Vector3d& lever = manifold.arm_a_m[p];
    row.arm_a[q] = lever.cross(row.normal);
    row.arm_b[q] = (lever - manifold.between_m).cross(row.normal);
    row.turn_a[q] = turn(row.body_a, row.arm_a[q]);
    row.turn_b[q] = turn(row.body_b, row.arm_b[q]);
    if (!struck(point, at(slot.lane))) continue;
    row.target_mps[q] = point.bounce[at(slot.lane)];
    row.least_ns[q] = -point.total[at(slot.lane)];
  }
  return row;
}

// The fastest approach at the step's start of the points that were struck, m/s; 0 if none was.
double FastDynamics::fastest_approach_mps(const Slot& slot) const {
  const SoftManifold& manifold = solved_manifold(at(slot.manifold));
  if (poses_[at(manifold.body_a)].reach_m + poses_[at(manifold.body_b)].reach_m <=
      step_s_ * options_.resting_approach_mps) {
    return 0.0;
  }
  const SoftBatch& batch = batches_[at(slot.batch)];
  double fastest_mps = 0.0;
  for (std::size_t p = 0; p < at(manifold.count); ++p) {
    if (!struck(batch.point[p], at(slot.lane))) continue;
    const Eigen::Vector3d& arm_a = manifold.arm_a_m[p];
    fastest_mps =
        std::max(fastest_mps,
                 manifold.normal.dot(velocity_at(at(manifold.body_a), arm_a) -
                                     velocity_at(at(manifold.body_b), arm_a - manifold.between_m)));
  }
  return fastest_mps;
}

// Newton's law: struck points leave with their share of the approach, and may give back what they
// got too much of; the others do not approach. Where something bounces that is a problem of all
// contacts of the islands that were struck; else the sub-steps have solved it but for the last
// blows, and it is one of the struck contacts.
void FastDynamics::rebound() {
  rebound_left_mps_ = 0.0;
  std::vector<const Slot*> struck_slots, all;
  std::vector<char> struck_island(bodies_.size(), 0);
  const auto root = [&](const Slot& slot) {
    const SoftManifold& m = solved_manifold(at(slot.manifold));
    return at(island_[at(bodies_[at(m.body_a)].fixed ? m.body_b : m.body_a)]);
  };
  double fastest_mps = 0.0;
  bool bounce = false;
  for (const Slot& slot : slots_) {
    const double approach_mps = slot.pushed ? fastest_approach_mps(slot) : 0.0;
    if (approach_mps == 0.0) continue;
    const SoftManifold& m = solved_manifold(at(slot.manifold));
    bounce = bounce ||
             laws_(bodies_[at(m.body_a)].surface, bodies_[at(m.body_b)].surface).restitution > 0.0;
    fastest_mps = std::max(fastest_mps, approach_mps);
    struck_island[root(slot)] = 1;
    struck_slots.push_back(&slot);
  }
  if (struck_slots.empty()) return;
  const double enough_mps = k_rebound_share * fastest_mps;
  if (!bounce) {
    rebound_left_mps_ = settle_rows(struck_slots, enough_mps);
    return;
  }
  for (const Slot& slot : slots_) {
    if (slot.pushed && struck_island[root(slot)] != 0) all.push_back(&slot);
  }
  rebound_left_mps_ = settle_rows(all, enough_mps);
}

double FastDynamics::settle_rows(std::span<const Slot* const> slots, double enough_mps) {
  std::vector<ReboundRow> rows;
  std::vector<Twist> velocity(bodies_.size());
  std::vector<char> takes_part(bodies_.size(), 0);
  for (const Slot* slot : slots) {
    rows.push_back(rebound_row(*slot));
    for (const int i : {rows.back().body_a, rows.back().body_b}) {
      if (bodies_[at(i)].fixed || takes_part[at(i)] != 0) continue;
      takes_part[at(i)] = 1;
      velocity[at(i)] = twist_of(at(i));
    }
  }
  const double left_mps = settle_rebound(rows, enough_mps, velocity);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (takes_part[i] != 0) set_twist(i, velocity[i]);
  }
  for (std::size_t k = 0; k < rows.size(); ++k) take_rebound(*slots[k], rows[k]);
  return left_mps;
}

// A manifold that bounced is open: nothing of its impulses goes on.
void FastDynamics::take_rebound(const Slot& slot, const ReboundRow& row) {
  SoftBatch& batch = batches_[at(slot.batch)];
  const std::size_t lane = at(slot.lane);
  const auto points = std::span(batch.point).first(at(solved_manifold(at(slot.manifold)).count));
  std::size_t q = 0;
  bool bounced = false;
  for (SoftPoint& point : points) {
    if (!pushed(point, lane)) continue;
    point.total[lane] += static_cast<float>(row.impulse_ns[q++]);
    bounced = bounced || point.bounce[lane] > 0.0F;
  }
  if (!bounced) return;
  for (SoftPoint& point : points) point.impulse[lane] = 0.0F;
  for (Lane& impulse : batch.friction_impulse) impulse[lane] = 0.0F;
  batch.twist_impulse[lane] = 0.0F;
}

// Kinetic energy at the end of the step, and what it may be: that of the start and what gravity and
// loads did on the way.
void FastDynamics::find_energies() {
  energy_.assign(bodies_.size(), Energy{});
  pool_.for_ranges(bodies_.size(), k_bodies_per_piece, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (touched_[i] == 0 || bodies_[i].fixed) continue;
      const BodyModel& body = bodies_[i];
      const Eigen::Vector3d force_n = body.mass_kg * options_.gravity_mps2 + loads_[i].force_n;
      const Motion& start = motions_[i];
      energy_[i].allowed_j = 0.5 * body.mass_kg * start.velocity_mps.squaredNorm() +
                             0.5 * start.angular_momentum_kgm2ps.dot(spin_radps_[i]) +
                             force_n.dot(linear_part(moved_[i])) +
                             loads_[i].torque_nm.dot(angular_part(moved_[i]));
      const Eigen::Vector3d spin = ends_[i].attitude.conjugate() * ends_[i].angular_momentum_kgm2ps;
      energy_[i].kinetic_j = 0.5 * body.mass_kg * ends_[i].velocity_mps.squaredNorm() +
                             0.5 * spin.dot(spin.cwiseQuotient(body.inertia_kgm2));
    }
  });
}

// No island leaves the step with more energy than it had. Whether that could be reached: a motion
// of the island as one body is never slowed, and turning it may cost more than there was.
bool FastDynamics::limit_energies() {
  find_energies();
  energy_taken_j_ = 0.0;
  std::vector<Energy> sum(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    Energy& island = sum[at(island_[i])];
    island.allowed_j += energy_[i].allowed_j;
    island.kinetic_j += energy_[i].kinetic_j;
  }
  const auto exceeds = [&](int root) { return sum[at(root)].kinetic_j > sum[at(root)].allowed_j; };
  std::vector<int> order;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (touched_[i] != 0 && !bodies_[i].fixed && exceeds(island_[i])) {
      order.push_back(static_cast<int>(i));
    }
  }
  std::ranges::stable_sort(order, {}, [&](int i) { return island_[at(i)]; });
  bool held = true;
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    const int root = island_[at(order[begin])];
    while (end < order.size() && island_[at(order[end])] == root) ++end;
    const double before_j = sum[at(root)].kinetic_j;
    limit_island(std::span(order).subspan(begin, end - begin), sum[at(root)]);
    const Energy& left = sum[at(root)];
    held = held &&
           left.kinetic_j - std::max(left.allowed_j, 0.0) <= FastLimits::k_energy_share * before_j;
  }
  return held;
}

void FastDynamics::limit_island(std::span<const int> bodies, Energy& energy) {
  std::vector<GroupMember> members;
  for (const int i : bodies) {
    const Eigen::Matrix3d r = ends_[at(i)].attitude.toRotationMatrix();
    const BodyModel& body = bodies_[at(i)];
    const Eigen::Vector3d& momentum = ends_[at(i)].angular_momentum_kgm2ps;
    members.push_back({body.mass_kg,
                       r * body.inertia_kgm2.asDiagonal() * r.transpose(),
                       ends_[at(i)].position_m,
                       {ends_[at(i)].velocity_mps,
                        r * (r.transpose() * momentum).cwiseQuotient(body.inertia_kgm2)}});
  }
  const bool grounded = grounded_[at(island_[at(bodies.front())])] != 0;
  const double taken_j = limit_energy(members, grounded, energy.allowed_j);
  energy.kinetic_j -= taken_j;
  energy_taken_j_ += taken_j;
  for (std::size_t k = 0; k < members.size(); ++k) {
    Motion& end = ends_[at(bodies[k])];
    if (grounded) {
      momentum_taken_ns_ += members[k].mass_kg * (end.velocity_mps - members[k].velocity.linear);
    }
    end.velocity_mps = members[k].velocity.linear;
    end.angular_momentum_kgm2ps = members[k].inertia_kgm2 * members[k].velocity.angular;
  }
}

}  // namespace ourengine
