// Contacts into coloured batches: which manifold is solved where, and what identifies it there.
#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include "ourengine/fast/fast_dynamics.hpp"
#include "ourengine/fast/soft_vector.hpp"

namespace ourengine {
namespace {

constexpr std::uint64_t k_all_colours = ~std::uint64_t{0};
constexpr std::size_t k_batches_per_piece = 4;
constexpr std::size_t k_slots_per_piece = 256;
constexpr int k_few_points = 2;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

void put(Lane3& lanes, std::size_t i, const Eigen::Vector3d& v) {
  for (std::size_t k = 0; k < 3; ++k) {
    lanes[k][i] = static_cast<float>(v[static_cast<Eigen::Index>(k)]);
  }
}

SoftBatch empty_batch(std::size_t bodies) {
  SoftBatch batch{};
  batch.body_a.fill(static_cast<std::int32_t>(bodies));
  batch.body_b = batch.body_a;
  return batch;
}

}  // namespace

// Whether some point may close within the step: the others are known, but need not be solved.
bool FastDynamics::is_near(const SoftManifold& manifold) const {
  const double margin_m =
      options_.margin_m + poses_[at(manifold.body_a)].reach_m + poses_[at(manifold.body_b)].reach_m;
  const auto gaps = std::span(manifold.gap_m).first(at(manifold.count));
  return std::ranges::any_of(gaps, [&](double gap_m) { return gap_m <= margin_m; });
}

// Those of the contact set, then those that only the end of the step shows.
SoftManifold& FastDynamics::solved_manifold(std::size_t index) {
  const std::span<SoftManifold> known = contacts_.manifolds();
  return index < known.size() ? known[index] : late_[index - known.size()];
}

const SoftManifold& FastDynamics::solved_manifold(std::size_t index) const {
  const std::span<const SoftManifold> known = contacts_.manifolds();
  return index < known.size() ? known[index] : late_[index - known.size()];
}

// Greedy colouring in the order of the pairs: the lowest colour that neither moving body has yet.
void FastDynamics::colour_manifolds() {
  slots_.clear();
  used_.assign(bodies_.size(), 0);
  std::vector<int> sizes;
  report_.contacts = 0;
  const std::size_t known = contacts_.manifolds().size();
  for (std::size_t m = 0; m < known + late_.size(); ++m) {
    SoftManifold& manifold = solved_manifold(m);
    if (m < known && !is_near(manifold)) {
      manifold.impulse.fill(0.0F);
      manifold.friction_impulse.setZero();
      manifold.twist_impulse = 0.0F;
      continue;
    }
    const auto a = at(manifold.body_a);
    const auto b = at(manifold.body_b);
    std::uint64_t taken = (bodies_[a].fixed ? 0 : used_[a]) | (bodies_[b].fixed ? 0 : used_[b]);
    Slot slot;
    slot.manifold = static_cast<int>(m);
    // More than 64 contacts on one body: each further one opens a colour of its own, since the
    // lanes of a batch must not share a body.
    if (taken == k_all_colours) {
      slot.colour = std::max(static_cast<int>(sizes.size()), 64);
    } else {
      slot.colour = std::countr_one(taken);
      used_[a] |= std::uint64_t{1} << slot.colour;
      used_[b] |= std::uint64_t{1} << slot.colour;
    }
    sizes.resize(std::max(sizes.size(), at(slot.colour) + 1), 0);
    ++sizes[at(slot.colour)];
    slots_.push_back(slot);
    report_.contacts += manifold.count;
  }
  report_.manifolds = static_cast<int>(slots_.size());
  report_.colours = static_cast<int>(sizes.size());
  place_slots(sizes);
  fill_batches();
}

void FastDynamics::place_slots(std::span<const int> sizes) {
  colour_begin_.assign(1, 0);
  for (const int size : sizes) {
    colour_begin_.push_back(colour_begin_.back() + at((size + k_lanes - 1) / k_lanes));
  }
  batches_.resize(colour_begin_.back());
  lane_slot_.assign(k_lanes * batches_.size(), -1);
  std::vector<int> next(sizes.size(), 0);
  // A batch costs as much as its largest manifold: faces first, then edges and corners.
  for (const bool few : {false, true}) {
    for (std::size_t s = 0; s < slots_.size(); ++s) {
      Slot& slot = slots_[s];
      if ((solved_manifold(at(slot.manifold)).count <= k_few_points) != few) continue;
      const int place = next[at(slot.colour)]++;
      slot.batch = static_cast<int>(colour_begin_[at(slot.colour)]) + place / k_lanes;
      slot.lane = place % k_lanes;
      lane_slot_[at(k_lanes * slot.batch + slot.lane)] = static_cast<int>(s);
    }
  }
}

void FastDynamics::fill_batches() {
  const SoftBatch empty = empty_batch(bodies_.size());
  pool_.for_ranges(batches_.size(), k_batches_per_piece,
                   [&](std::size_t begin, std::size_t end) noexcept {
                     for (std::size_t k = begin; k < end; ++k) {
                       SoftBatch& batch = batches_[k];
                       const auto lanes = std::span(lane_slot_).subspan(k_lanes * k, k_lanes);
                       if (lanes.back() < 0) batch = empty;  // lanes are taken from the front
                       batch.points = 0;
                       batch.struck = false;
                       batch.lanes = static_cast<int>(std::ranges::find(lanes, -1) - lanes.begin());
                       for (std::size_t i = 0; i < lanes.size() && lanes[i] >= 0; ++i) {
                         fill(batch, i, solved_manifold(at(slots_[at(lanes[i])].manifold)));
                       }
                     }
                     soft_prepare(std::span(batches_).subspan(begin, end - begin), inertia_);
                   });
}

// What identifies the contact; soft_prepare() makes the rest of it.
void FastDynamics::fill(SoftBatch& batch, std::size_t i, const SoftManifold& manifold) {
  const auto a = at(manifold.body_a);
  const auto b = at(manifold.body_b);
  const auto rest = static_cast<std::int32_t>(bodies_.size());
  batch.body_a[i] = bodies_[a].fixed ? rest : manifold.body_a;
  batch.body_b[i] = bodies_[b].fixed ? rest : manifold.body_b;
  put(batch.normal, i, manifold.normal);
  batch.points = std::max(batch.points, manifold.count);
  const SurfaceLaw& law = laws_(bodies_[a].surface, bodies_[b].surface);
  batch.friction[i] = static_cast<float>(law.friction);
  const bool fast = poses_[a].reach_m + poses_[b].reach_m > step_s_ * options_.resting_approach_mps;
  const auto weight_n = [&](std::size_t body) {
    return bodies_[body].fixed ? 0.0 : bodies_[body].mass_kg * options_.gravity_mps2.norm();
  };
  batch.weight[i] = static_cast<float>(step_s_ / options_.substeps *
                                       (weight_n(a) + weight_n(b) + double{load_n(manifold)}));
  batch.twist_impulse[i] = impulse_share_ * manifold.twist_impulse;
  batch.twist_total[i] = 0.0F;
  for (Lane& total : batch.friction_total) total[i] = 0.0F;
  put(batch.carried_friction, i, (impulse_share_ * manifold.friction_impulse).cast<double>());
  for (std::size_t p = 0; p < k_soft_points; ++p) {
    SoftPoint& point = batch.point[p];
    const bool present = p < at(manifold.count);
    const Eigen::Vector3d arm_a = present ? manifold.arm_a_m[p] : Eigen::Vector3d::Zero();
    const Eigen::Vector3d arm_b =
        present ? Eigen::Vector3d(arm_a - manifold.between_m) : Eigen::Vector3d::Zero();
    put(point.row.arm_a, i, arm_a);
    put(point.row.arm_b, i, arm_b);
    point.mass[i] = present ? 1.0F : 0.0F;
    point.gap[i] = present ? static_cast<float>(manifold.gap_m[p]) : 0.0F;
    point.gap_now[i] = point.gap[i];
    point.impulse[i] = present ? impulse_share_ * manifold.impulse[p] : 0.0F;
    point.carried[i] = point.impulse[i];
    point.bounce[i] = -1.0F;
    point.max_impulse[i] = 0.0F;
    point.total[i] = 0.0F;
    if (!present || !fast) continue;
    const double approach = manifold.normal.dot(velocity_at(b, arm_b) - velocity_at(a, arm_a));
    if (approach < -options_.resting_approach_mps) {
      point.bounce[i] = static_cast<float>(-law.restitution * approach);
      batch.struck = true;
    }
  }
}

// The bodies that some contact pushed during the trial. Several threads may mark a body: all with
// the same mark, so that the order does not matter.
void FastDynamics::mark_touched() {
  std::ranges::fill(touched_, 0);
  pool_.for_ranges(
      slots_.size(), k_slots_per_piece, [&](std::size_t begin, std::size_t end) noexcept {
        for (Slot& slot : std::span(slots_).subspan(begin, end - begin)) {
          const SoftBatch& batch = batches_[at(slot.batch)];
          const std::size_t i = at(slot.lane);
          const SoftManifold& manifold = solved_manifold(at(slot.manifold));
          slot.pushed = false;
          slot.deepest_m = 0.0F;
          for (const SoftPoint& point : std::span(batch.point).first(at(manifold.count))) {
            slot.deepest_m = std::max(slot.deepest_m, -point.gap_now[i]);
            slot.pushed = slot.pushed || point.max_impulse[i] > 0.0F;
          }
          if (!slot.pushed) continue;
          for (const int body : {manifold.body_a, manifold.body_b}) {
            std::atomic_ref(touched_[at(body)]).store(1, std::memory_order_relaxed);
          }
        }
      });
}

// Size of the loads on both bodies, torques with the lever of the body's radius.
float FastDynamics::load_n(const SoftManifold& manifold) const {
  double sum_n = 0.0;
  for (const int body : {manifold.body_a, manifold.body_b}) {
    if (bodies_[at(body)].fixed) continue;
    const Load& load = loads_[at(body)];
    if (load.force_n.isZero(0.0) && load.torque_nm.isZero(0.0)) continue;
    sum_n += load.force_n.norm() + load.torque_nm.norm() / radius_m_[at(body)];
  }
  return static_cast<float>(sum_n);
}

// Impulses that held a load which is gone would throw the body: they are not carried over.
void FastDynamics::forget_ended_loads() {
  for (SoftManifold& manifold : contacts_.manifolds()) {
    if (manifold.load_n == 0.0F) continue;
    if (load_n(manifold) >= FastLimits::k_load_left * manifold.load_n) continue;
    manifold.impulse.fill(0.0F);
    manifold.friction_impulse.setZero();
    manifold.twist_impulse = 0.0F;
    manifold.load_n = 0.0F;
  }
}

// Back into the manifolds, of which each has one slot, as what a sub-step of an uncut step would
// apply.
void FastDynamics::keep_impulses() {
  const float scale = 1.0F / impulse_share_;
  pool_.for_ranges(slots_.size(), k_slots_per_piece,
                   [&](std::size_t begin, std::size_t end) noexcept {
                     for (const Slot& slot : std::span(slots_).subspan(begin, end - begin)) {
                       const SoftBatch& batch = batches_[at(slot.batch)];
                       const std::size_t i = at(slot.lane);
                       SoftManifold& manifold = solved_manifold(at(slot.manifold));
                       for (std::size_t p = 0; p < at(manifold.count); ++p) {
                         manifold.impulse[p] = scale * batch.point[p].impulse[i];
                       }
                       for (std::size_t k = 0; k < 3; ++k) {
                         manifold.friction_impulse[static_cast<Eigen::Index>(k)] =
                             scale * (batch.friction_impulse[0][i] * batch.tangent[0][k][i] +
                                      batch.friction_impulse[1][i] * batch.tangent[1][k][i]);
                       }
                       manifold.twist_impulse = scale * batch.twist_impulse[i];
                       manifold.load_n = load_n(manifold);
                     }
                   });
}

std::vector<SoftContact> FastDynamics::contacts() const {
  return report_.parts > 1 ? cut_contacts_ : contacts_of_part();
}

// What the part applied; friction and twist of a manifold become forces at its points.
std::vector<SoftContact> FastDynamics::contacts_of_part() const {
  std::vector<SoftContact> contacts;
  for (const Slot& slot : slots_) {
    const SoftManifold& manifold = solved_manifold(at(slot.manifold));
    const SoftBatch& batch = batches_[at(slot.batch)];
    const std::size_t i = at(slot.lane);
    const auto arms = std::span(manifold.arm_a_m).first(at(manifold.count));
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& arm : arms) centre += arm / manifold.count;
    double squares = 0.0;
    for (const Eigen::Vector3d& arm : arms) squares += (arm - centre).squaredNorm();
    const Eigen::Vector3d friction = batch.friction_total[0][i] * lane_of(batch.tangent[0], i) +
                                     batch.friction_total[1][i] * lane_of(batch.tangent[1], i);
    const double turn = squares > 0.0 ? batch.twist_total[i] / squares : 0.0;
    for (std::size_t p = 0; p < arms.size(); ++p) {
      contacts.push_back({manifold.body_a, manifold.body_b, manifold.centre_a_m + arms[p],
                          manifold.normal, manifold.gap_m[p],
                          batch.point[p].total[i] * manifold.normal + friction / manifold.count +
                              turn * manifold.normal.cross(arms[p] - centre)});
    }
  }
  return contacts;
}

}  // namespace ourengine
