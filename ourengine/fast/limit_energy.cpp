// No island of bodies that touched leaves a step of the fast engine with more energy than it had.
#include <algorithm>
#include <cmath>

#include "ourengine/fast/fast_dynamics.hpp"
#include "ourengine/fast/soft_vector.hpp"

namespace ourengine {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

double FastDynamics::kinetic_j(std::size_t i) const {
  const Eigen::Vector3d spin = ends_[i].attitude.conjugate() * ends_[i].angular_momentum_kgm2ps;
  return 0.5 * bodies_[i].mass_kg * ends_[i].velocity_mps.squaredNorm() +
         0.5 * spin.dot(spin.cwiseQuotient(bodies_[i].inertia_kgm2));
}

// (bodies) by root: kinetic energy of islands at the end of the step, and what it may be: that of
// the start and what gravity and loads did on the way.
std::vector<FastDynamics::Energy> FastDynamics::island_energies() const {
  std::vector<Energy> sum(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (touched_[i] == 0 || bodies_[i].fixed) continue;
    const BodyModel& body = bodies_[i];
    const Eigen::Vector3d force_n = body.mass_kg * options_.gravity_mps2 + loads_[i].force_n;
    const Motion& start = motions_[i];
    Energy& island = sum[at(island_[i])];
    island.allowed_j += 0.5 * body.mass_kg * start.velocity_mps.squaredNorm() +
                        0.5 * start.angular_momentum_kgm2ps.dot(spin_radps_[i]) +
                        force_n.dot(linear_part(moved_[i])) +
                        loads_[i].torque_nm.dot(angular_part(moved_[i]));
    island.kinetic_j += kinetic_j(i);
  }
  return sum;
}

// No island leaves the step with more energy than it had. Its contacts give less: something between
// what they gave and what they would give without any bounce, which lies in all cones if those two
// do. What that cannot hold is taken from the motion of the bodies against each other where nothing
// fixed is among them. Whether it was held, if not the step is cut: a motion of the island as one
// body is never slowed, and turning it may cost more than there was. On the ground a step may be
// off by what gravity and loads do on the way that contacts cut short.
bool FastDynamics::limit_energies() {
  energy_taken_j_ = 0.0;
  std::vector<Energy> sum = island_energies();
  std::vector<char> exceeds(bodies_.size(), 0);
  const auto note = [&](std::size_t root) {
    exceeds[root] = sum[root].kinetic_j > sum[root].allowed_j ? 1 : 0;
  };
  for (std::size_t i = 0; i < bodies_.size(); ++i) note(i);
  if (std::ranges::count(exceeds, 0) == std::ssize(exceeds)) return true;
  bounce_less(exceeds, sum);
  for (std::size_t i = 0; i < bodies_.size(); ++i) note(i);
  std::vector<std::vector<int>> afloat(bodies_.size());
  std::vector<double> room_j(bodies_.size(), 0.0);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const auto root = at(island_[i]);
    if (touched_[i] == 0 || bodies_[i].fixed || exceeds[root] == 0) continue;
    if (grounded_[root] == 0) afloat[root].push_back(static_cast<int>(i));
    const Eigen::Vector3d force_n = bodies_[i].mass_kg * options_.gravity_mps2 + loads_[i].force_n;
    room_j[root] += force_n.norm() * (poses_[i].reach_m + linear_part(moved_[i]).norm());
  }
  bool held = true;
  for (std::size_t root = 0; root < bodies_.size(); ++root) {
    if (exceeds[root] == 0) continue;
    const double before_j = sum[root].kinetic_j;
    double left_j = before_j - std::max(sum[root].allowed_j, 0.0);
    if (grounded_[root] == 0) left_j = limit_island(afloat[root], sum[root].allowed_j);
    if (grounded_[root] != 0) left_j -= room_j[root];
    held = held && left_j <= FastLimits::k_energy_share * before_j;
  }
  return held;
}

// The largest share of the way from one motion to another, both of an island, whose energy is
// allowed; it is quadratic along that way.
double FastDynamics::share_within(double first_j, double middle_j, double last_j,
                                  double allowed_j) {
  if (first_j >= allowed_j) return 0.0;
  const double bend_j = std::max(0.0, 2.0 * (first_j + last_j - 2.0 * middle_j));
  const double slope_j = last_j - first_j - bend_j;
  const double room_j = allowed_j - first_j;
  const double root = std::sqrt(slope_j * slope_j + 4.0 * bend_j * room_j);
  return std::clamp(2.0 * room_j / (slope_j + root), 0.0, 1.0);
}

// Islands, by root, with too much energy: their contacts are solved without any bounce as well.
void FastDynamics::bounce_less(std::span<const char> islands, std::span<Energy> energy) {
  std::vector<const Slot*> slots;
  std::vector<SlotImpulses> given;
  double fastest_m = 0.0;
  for (const Slot& slot : slots_) {
    if (!slot.pushed || islands[root_of(slot)] == 0) continue;
    if (laws_held_[root_of(slot)] == Law::plastic) continue;
    slots.push_back(&slot);
    given.push_back(impulses_of(slot));
    const SoftManifold& m = solved_manifold(at(slot.manifold));
    fastest_m = std::max({fastest_m, poses_[at(m.body_a)].reach_m, poses_[at(m.body_b)].reach_m});
  }
  if (slots.empty()) return;
  const std::vector<Motion> more = ends_;
  settle_rows(slots, fastest_m / step_s_, false);
  const std::vector<Motion> less = ends_;
  std::vector<Energy> first = island_energies();
  const auto blend = [&](std::size_t i, double share) {
    ends_[i].velocity_mps += share * (more[i].velocity_mps - less[i].velocity_mps);
    ends_[i].angular_momentum_kgm2ps +=
        share * (more[i].angular_momentum_kgm2ps - less[i].angular_momentum_kgm2ps);
  };
  for (std::size_t i = 0; i < bodies_.size(); ++i) blend(i, 0.5);
  const std::vector<Energy> middle = island_energies();
  ends_ = less;
  std::vector<double> share(bodies_.size(), 1.0);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (islands[i] == 0) continue;
    share[i] = share_within(first[i].kinetic_j, middle[i].kinetic_j, energy[i].kinetic_j,
                            energy[i].allowed_j);
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) blend(i, share[at(island_[i])]);
  for (std::size_t k = 0; k < slots.size(); ++k) {
    blend_impulses(*slots[k], given[k], share[root_of(*slots[k])]);
  }
  const std::vector<Energy> now = island_energies();
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (islands[i] == 0) continue;
    energy_taken_j_ += energy[i].kinetic_j - now[i].kinetic_j;
    energy[i].kinetic_j = now[i].kinetic_j;
  }
}

// Towards what it was given.
void FastDynamics::blend_impulses(const Slot& slot, const SlotImpulses& given, double share) {
  SoftBatch& batch = batches_[at(slot.batch)];
  const std::size_t lane = at(slot.lane);
  const auto part = static_cast<float>(share);
  const auto blend = [&](float& total, double to) {
    total += part * (static_cast<float>(to) - total);
  };
  for (std::size_t p = 0; p < k_soft_points; ++p) {
    blend(batch.point[p].total[lane], given.normal_ns[p]);
  }
  for (std::size_t k = 0; k < 2; ++k) {
    blend(batch.friction_total[k][lane], given.friction_ns.dot(lane_of(batch.tangent[k], lane)));
  }
  blend(batch.twist_total[lane], given.twist_nms);
}

// Of an island with nothing fixed. Returns the energy beyond what is allowed that it is left with.
double FastDynamics::limit_island(std::span<const int> bodies, double allowed_j) {
  std::vector<GroupMember> members;
  double kinetic_sum_j = 0.0;
  for (const int i : bodies) {
    const Eigen::Matrix3d r = ends_[at(i)].attitude.toRotationMatrix();
    const BodyModel& body = bodies_[at(i)];
    const Eigen::Vector3d& momentum = ends_[at(i)].angular_momentum_kgm2ps;
    members.push_back({body.mass_kg,
                       r * body.inertia_kgm2.asDiagonal() * r.transpose(),
                       ends_[at(i)].position_m,
                       {ends_[at(i)].velocity_mps,
                        r * (r.transpose() * momentum).cwiseQuotient(body.inertia_kgm2)}});
    kinetic_sum_j += kinetic_j(at(i));
  }
  const double taken_j = limit_energy(members, allowed_j);
  energy_taken_j_ += taken_j;
  for (std::size_t k = 0; k < members.size(); ++k) {
    Motion& end = ends_[at(bodies[k])];
    end.velocity_mps = members[k].velocity.linear;
    end.angular_momentum_kgm2ps = members[k].inertia_kgm2 * members[k].velocity.angular;
  }
  return kinetic_sum_j - taken_j - std::max(allowed_j, 0.0);
}

}  // namespace ourengine
