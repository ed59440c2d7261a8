// How a step of the fast engine ends once its contacts are settled: what they gave, islands of
// bodies that touched, and the laws of impact within them.
#include <algorithm>

#include "ourengine/collision/passage.hpp"
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

FastDynamics::SlotImpulses FastDynamics::impulses_of(const Slot& slot) const {
  const SoftBatch& batch = batches_[at(slot.batch)];
  const std::size_t lane = at(slot.lane);
  SlotImpulses sum;
  for (std::size_t p = 0; p < k_soft_points; ++p) sum.normal_ns[p] = batch.point[p].total[lane];
  for (std::size_t k = 0; k < 2; ++k) {
    sum.friction_ns += double{batch.friction_total[k][lane]} * lane_of(batch.tangent[k], lane);
  }
  sum.twist_nms = batch.twist_total[lane];
  return sum;
}

Eigen::Vector3d FastDynamics::middle_of(const SoftManifold& manifold) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& arm : std::span(manifold.arm_a_m).first(at(manifold.count))) {
    middle += arm / manifold.count;
  }
  return middle;
}

// The velocities that all impulses of the step give, in double precision. The sub-steps' own have
// the roundings of single precision in every one of them, which at high speeds is more than the
// friction of a step, and more than the energy that a light body has to pay with.
void FastDynamics::sum_impulses() {
  struct Momentum {
    Eigen::Vector3d linear_ns = Eigen::Vector3d::Zero();
    Eigen::Vector3d angular_nms = Eigen::Vector3d::Zero();
  };
  std::vector<Momentum> given(bodies_.size());
  for (const Slot& slot : slots_) {
    if (!slot.pushed) continue;
    const SoftManifold& m = solved_manifold(at(slot.manifold));
    const SlotImpulses sum = impulses_of(slot);
    Eigen::Vector3d force = sum.friction_ns;
    Eigen::Vector3d moment = middle_of(m).cross(sum.friction_ns) + sum.twist_nms * m.normal;
    for (std::size_t p = 0; p < at(m.count); ++p) {
      force += sum.normal_ns[p] * m.normal;
      moment += sum.normal_ns[p] * m.arm_a_m[p].cross(m.normal);
    }
    given[at(m.body_a)].linear_ns -= force;
    given[at(m.body_a)].angular_nms -= moment;
    given[at(m.body_b)].linear_ns += force;
    given[at(m.body_b)].angular_nms += moment - m.between_m.cross(force);
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (touched_[i] == 0 || bodies_[i].fixed) continue;
    const BodyModel& body = bodies_[i];
    ends_[i].velocity_mps = motions_[i].velocity_mps + step_s_ * options_.gravity_mps2 +
                            (step_s_ * loads_[i].force_n + given[i].linear_ns) / body.mass_kg;
    ends_[i].angular_momentum_kgm2ps =
        motions_[i].angular_momentum_kgm2ps + step_s_ * loads_[i].torque_nm + given[i].angular_nms;
  }
}

Twist FastDynamics::twist_of(std::size_t i) const {
  return {ends_[i].velocity_mps,
          angular_velocity_radps(motions_[i].attitude, bodies_[i].inertia_kgm2,
                                 ends_[i].angular_momentum_kgm2ps)};
}

Twist FastDynamics::twist_at_end(int body) const {
  return bodies_[at(body)].fixed ? Twist{} : twist_of(at(body));
}

void FastDynamics::set_twist(std::size_t i, const Twist& twist) {
  ends_[i].velocity_mps = twist.linear;
  ends_[i].angular_momentum_kgm2ps = momentum_of(i, twist.angular);
}

ReboundRow FastDynamics::rebound_row(const Slot& slot) const {
  const SoftManifold& manifold = solved_manifold(at(slot.manifold));
  const SoftBatch& batch = batches_[at(slot.batch)];
  const std::size_t lane = at(slot.lane);
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
  const auto set = [&](ReboundRow::Arm& arm, const Eigen::Vector3d& on_a,
                       const Eigen::Vector3d& on_b) {
    arm = {on_a, on_b, turn(row.body_a, on_a), turn(row.body_b, on_b)};
  };
  const auto inverse_mass = [&](int i) {
    return bodies_[at(i)].fixed ? 0.0 : 1.0 / bodies_[at(i)].mass_kg;
  };
  row.inverse_mass_a = inverse_mass(row.body_a);
  row.inverse_mass_b = inverse_mass(row.body_b);
  for (std::size_t p = 0; p < at(manifold.count); ++p) {
    const SoftPoint& point = batch.point[p];
    if (!pushed(point, lane)) continue;
    const std::size_t q = row.count++;
    const Eigen::Vector3d& lever = manifold.arm_a_m[p];
    set(row.point[q], lever.cross(row.normal), (lever - manifold.between_m).cross(row.normal));
    row.impulse_ns[q] = point.total[lane];
    if (struck(point, lane)) row.target_mps[q] = point.bounce[lane];
  }
  row.friction = batch.friction[lane];
  if (row.friction == 0.0) return row;
  const Eigen::Vector3d middle = middle_of(manifold);
  for (std::size_t k = 0; k < 2; ++k) {
    row.tangent[k] = lane_of(batch.tangent[k], lane);
    set(row.slide[k], middle.cross(row.tangent[k]),
        (middle - manifold.between_m).cross(row.tangent[k]));
    row.friction_ns[k] = batch.friction_total[k][lane];
  }
  set(row.twist, row.normal, row.normal);
  row.twist_arm_m = batch.twist_arm[lane];
  row.twist_nms = batch.twist_total[lane];
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

// Whether a contact that nothing struck ends the step with a speed that only a blow can give: the
// friction of a body that trips (Painleve's paradox) has no law in the sub-steps.
bool FastDynamics::throws(const Slot& slot) const {
  const SoftManifold& m = solved_manifold(at(slot.manifold));
  const Twist a = twist_at_end(m.body_a), b = twist_at_end(m.body_b);
  // A point that was pushed and left since turns with its body, and falls.
  const auto turning_mps2 = [&](int body, const Twist& twist) {
    return bodies_[at(body)].fixed ? 0.0 : twist.angular.squaredNorm() * radius_m_[at(body)];
  };
  const double since_mps = step_s_ * (2.0 * options_.gravity_mps2.norm() +
                                      turning_mps2(m.body_a, a) + turning_mps2(m.body_b, b));
  const SoftBatch& batch = batches_[at(slot.batch)];
  for (std::size_t p = 0; p < at(m.count); ++p) {
    if (!pushed(batch.point[p], at(slot.lane))) continue;
    const Eigen::Vector3d& arm_a = m.arm_a_m[p];
    const Eigen::Vector3d apart =
        b.linear + b.angular.cross(arm_a - m.between_m) - a.linear - a.angular.cross(arm_a);
    if (m.normal.dot(apart) > options_.resting_approach_mps + since_mps) return true;
  }
  return false;
}

// How deep two bodies that may touch are in each other on the ways of the step, where they are not
// at its ends, m; 0 if nowhere.
double FastDynamics::passage_of_m(const SoftManifold& manifold) const {
  const auto a = at(manifold.body_a), b = at(manifold.body_b);
  const double thinner_m =
      std::min(thickness_m(bodies_[a].geometry), thickness_m(bodies_[b].geometry));
  if (poses_[a].reach_m + poses_[b].reach_m < thinner_m) return 0.0;
  const auto way_of = [&](std::size_t i) -> Way {
    if (bodies_[i].fixed) return {motions_[i], motions_[i]};
    const Eigen::AngleAxisd turn(ends_[i].attitude * motions_[i].attitude.conjugate());
    return {motions_[i], ends_[i], turn.angle() * turn.axis()};
  };
  const Way way_a = way_of(a), way_b = way_of(b);
  const double shift_m = (way_a.end.position_m - way_a.start.position_m - way_b.end.position_m +
                          way_b.start.position_m)
                             .norm();
  // A plane has no end, but does not turn.
  const auto turned_m = [&](std::size_t i, const Way& way) {
    return bodies_[i].fixed ? 0.0 : way.turn_rad.norm() * radius_m_[i];
  };
  if (shift_m + turned_m(a, way_a) + turned_m(b, way_b) < thinner_m) return 0.0;
  return ourengine::passage_m(bodies_[a], way_a, bodies_[b], way_b);
}

// Newton's and Coulomb's laws at the end of the step, for all contacts of the islands in which
// something was struck: what the sub-steps gave to one that now separates too fast, it gives back.
void FastDynamics::rebound() {
  rebound_left_mps_ = 0.0;
  laws_held_.assign(bodies_.size(), Law::none);
  double fastest_mps = 0.0;
  for (const Slot& slot : slots_) {
    const double approach_mps = slot.pushed ? fastest_approach_mps(slot) : 0.0;
    if (approach_mps == 0.0) continue;
    const SoftManifold& m = solved_manifold(at(slot.manifold));
    const SurfaceLaw& law = laws_(bodies_[at(m.body_a)].surface, bodies_[at(m.body_b)].surface);
    fastest_mps = std::max(fastest_mps, approach_mps);
    Law& held = laws_held_[root_of(slot)];
    held = law.restitution > 0.0 || held == Law::bounce ? Law::bounce : Law::plastic;
  }
  for (const Slot& slot : slots_) {
    if (slot.pushed && laws_held_[root_of(slot)] == Law::none && throws(slot)) unsolved_ = true;
  }
  if (fastest_mps == 0.0) return;
  std::vector<const Slot*> slots;
  for (const Slot& slot : slots_) {
    if (slot.pushed && laws_held_[root_of(slot)] != Law::none) slots.push_back(&slot);
  }
  const Settling settling = settle_rows(slots, fastest_mps, true);
  rebound_left_mps_ = settling.left_mps;
  unsolved_ = unsolved_ || settling.unsolved;
}

// A hit takes place when it takes place: bodies of the islands that were struck go on from the last
// blow with the velocities that they end with, not with those that the sub-steps had by then.
void FastDynamics::move_on() {
  const std::vector<SoftVector> trial = moved_;
  const auto moves = [&](std::size_t i) {
    return touched_[i] != 0 && !bodies_[i].fixed && laws_held_[at(island_[i])] != Law::none;
  };
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (!moves(i)) continue;
    const Twist end = twist_of(i);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      moved_[i][k] += static_cast<float>(after_blow_s_ * (end.linear[axis] - velocity_[i][k]));
      moved_[i][4 + k] +=
          static_cast<float>(after_blow_s_ * (end.angular[axis] - velocity_[i][4 + k]));
    }
  }
  move_back_what_meets(trial);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (!moves(i)) continue;
    ends_[i].position_m = motions_[i].position_m + linear_part(moved_[i]);
    ends_[i].attitude = turned_freely(i, angular_part(moved_[i]));
  }
}

// Islands that would meet on that way what they did not meet in the trial stay where it left them,
// those that turn so far that a gap is no longer linear in the motion, and those on the ground that
// would be lifted though nothing bounces.
void FastDynamics::move_back_what_meets(std::span<const SoftVector> trial) {
  std::vector<char> meets(bodies_.size(), 0);
  for (const Slot& slot : slots_) {
    const SoftManifold& m = solved_manifold(at(slot.manifold));
    const double tolerance_m = look_tolerance_m(m.body_a, m.body_b);
    for (std::size_t p = 0; p < at(m.count); ++p) {
      if (m.gap_m[p] + opened_m(m, p, moved_) >= std::min(0.0, m.gap_m[p]) - tolerance_m) continue;
      if (opened_m(m, p, moved_) >= opened_m(m, p, trial)) continue;
      for (const int body : {m.body_a, m.body_b}) meets[at(island_[at(body)])] = 1;
    }
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const double bent_m = 0.5 * radius_m_[i] * angular_part(moved_[i]).squaredNorm();
    if (bent_m <= look_tolerance_m(static_cast<int>(i), static_cast<int>(i))) continue;
    meets[at(island_[i])] = 1;
  }
  std::vector<double> gained_j(bodies_.size(), 0.0);  // by gravity and loads, beyond the trial
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (bodies_[i].fixed) continue;
    const Eigen::Vector3d force_n = bodies_[i].mass_kg * options_.gravity_mps2 + loads_[i].force_n;
    gained_j[at(island_[i])] += force_n.dot(linear_part(moved_[i]) - linear_part(trial[i]));
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const auto root = at(island_[i]);
    const bool lifts =
        grounded_[root] != 0 && laws_held_[root] == Law::plastic && gained_j[root] < 0.0;
    if (meets[root] != 0 || lifts) moved_[i] = trial[i];
  }
}

std::size_t FastDynamics::root_of(const Slot& slot) const {
  const SoftManifold& m = solved_manifold(at(slot.manifold));
  return at(island_[at(bodies_[at(m.body_a)].fixed ? m.body_b : m.body_a)]);
}

// The laws of impact for the manifolds of the slots; without a bounce all targets are zero.
Settling FastDynamics::settle_rows(std::span<const Slot* const> slots, double fastest_mps,
                                   bool bounce) {
  std::vector<ReboundRow> rows;
  std::vector<Twist> velocity(bodies_.size());
  std::vector<char> takes_part(bodies_.size(), 0);
  for (const Slot* slot : slots) {
    rows.push_back(rebound_row(*slot));
    if (!bounce) rows.back().target_mps.fill(0.0);
    for (const int i : {rows.back().body_a, rows.back().body_b}) {
      if (bodies_[at(i)].fixed || takes_part[at(i)] != 0) continue;
      takes_part[at(i)] = 1;
      velocity[at(i)] = twist_of(at(i));
    }
  }
  // What gravity gives in a step counts too: a scale that cannot vanish.
  const double scale_mps = std::max(fastest_mps, options_.gravity_mps2.norm() * step_s_);
  const Settling settling = settle_rebound(rows, scale_mps, velocity);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (takes_part[i] != 0) set_twist(i, velocity[i]);
  }
  for (std::size_t k = 0; k < rows.size(); ++k) take_rebound(*slots[k], rows[k]);
  return settling;
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
    point.total[lane] = static_cast<float>(row.impulse_ns[q++]);
    bounced = bounced || point.bounce[lane] > 0.0F;
  }
  for (std::size_t k = 0; k < 2; ++k) {
    batch.friction_total[k][lane] = static_cast<float>(row.friction_ns[k]);
  }
  batch.twist_total[lane] = static_cast<float>(row.twist_nms);
  if (!bounced) return;
  for (SoftPoint& point : points) point.impulse[lane] = 0.0F;
  for (Lane& impulse : batch.friction_impulse) impulse[lane] = 0.0F;
  batch.twist_impulse[lane] = 0.0F;
}

}  // namespace ourengine
