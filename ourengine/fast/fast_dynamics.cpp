#include "ourengine/fast/fast_dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ourengine/fast/soft_blows.hpp"
#include "ourengine/fast/soft_vector.hpp"

namespace ourengine {
namespace {

// The stiffest contact that a sub-step still resolves: its phase advances by one radian.
constexpr double k_phase_limit_rad = 1.0;
// A struck body may in turn strike its neighbours within the step: contacts are looked up again
// with the reach of the striker handed on, so often.
constexpr int k_reach_passes = 2;
constexpr std::size_t k_batches_per_piece = 4;
constexpr std::size_t k_bodies_per_piece = 256;

SoftVector soft(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular) {
  const Eigen::Vector3f l = linear.cast<float>();
  const Eigen::Vector3f a = angular.cast<float>();
  return {l.x(), l.y(), l.z(), 0.0F, a.x(), a.y(), a.z(), 0.0F};
}

using Floats = Eigen::Array<float, 8, 1>;

Eigen::Map<Floats> floats(SoftVector& v) { return Eigen::Map<Floats>(v.data()); }

}  // namespace

FastDynamics::FastDynamics(std::vector<BodyModel> bodies, std::vector<Motion> motions,
                           SurfaceLaws laws, FastOptions options)
    : bodies_(std::move(bodies)),
      motions_(std::move(motions)),
      laws_(std::move(laws)),
      options_(options),
      pool_(options.threads),
      loads_(bodies_.size()),
      contacts_(bodies_, options.margin_m),
      poses_(bodies_.size(), BodyPose{Eigen::Matrix3d::Identity(), 0.0}),
      spin_radps_(bodies_.size(), Eigen::Vector3d::Zero()),
      inertia_(bodies_.size() + 1, SoftInertia{}),
      velocity_(bodies_.size() + 1, SoftVector{}),
      moved_(velocity_),
      contact_change_(velocity_),
      free_change_(velocity_),
      free_velocity_(velocity_),
      touched_(bodies_.size(), 0) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    radius_m_.push_back(bounding_radius_m(bodies_[i].geometry));
    poses_[i].axes = motions_[i].attitude.toRotationMatrix();
  }
}

void FastDynamics::apply(std::span<const Load> loads) { std::ranges::copy(loads, loads_.begin()); }

void FastDynamics::set_motions(std::span<const Motion> motions) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (!bodies_[i].fixed) motions_[i] = motions[i];
  }
  contacts_.clear();
  late_.clear();
  slots_.clear();
  cut_contacts_.clear();
}

void FastDynamics::restore(const Snapshot& snapshot) {
  motions_ = snapshot.motions;
  contacts_.restore(snapshot.contacts);
  late_.clear();
  slots_.clear();
  cut_contacts_.clear();
}

const FastReport& FastDynamics::step() {
  report_ = {};
  cut_contacts_.clear();
  forget_ended_loads();
  advance(options_.step_s, 0);
  std::ranges::stable_sort(cut_contacts_, {}, [](const SoftContact& c) {
    return BodyPair{c.body_a, c.body_b};
  });
  std::ranges::fill(loads_, Load{});
  return report_;
}

// A step, or the part of one that is left after so many cuts.
void FastDynamics::advance(double step_s, int cuts) {
  step_s_ = step_s;
  impulse_share_ = std::ldexp(1.0F, -cuts);
  const bool may_cut = cuts < FastLimits::k_cuts;
  bool settled = settle(may_cut);
  if (settled || !may_cut) settled = close() && settled;
  if (!settled && may_cut) {
    for (int half = 0; half < 2; ++half) advance(0.5 * step_s, cuts + 1);
    return;
  }
  report_.ran_out = report_.ran_out || !settled;
  accept();
  if (cuts == 0) return;
  const std::vector<SoftContact> part = contacts_of_part();
  cut_contacts_.insert(cut_contacts_.end(), part.begin(), part.end());
}

// Trials until one leaves nothing that another would mend. Whether that was reached.
bool FastDynamics::settle(bool may_cut) {
  late_.clear();
  sweeps_ = 1;
  overlap_left_m_ = 0.0;
  pose_bodies();
  Look look = Look::again;
  bool search = true;
  std::size_t solved = 0;
  for (int trial = 0; trial < FastLimits::k_trials && look == Look::again; ++trial) {
    if (search) find_contacts();
    solved = late_.size();
    try_step();
    if (may_cut && turns_far()) return false;
    search = find_far();
    if (!search) look = look_ahead();
  }
  late_.resize(solved);
  return look == Look::settled;
}

bool FastDynamics::turns_far() const {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (touched_[i] != 0 && angular_part(moved_[i]).norm() > FastLimits::k_turn_rad) return true;
  }
  return false;
}

// Newton's law, and no energy that was not there, for what the last trial found. Whether the energy
// could be held.
bool FastDynamics::close() {
  rebound_left_mps_ = 0.0;
  unsolved_ = false;
  energy_taken_j_ = 0.0;
  deepest_m_ = 0.0;
  for (const Slot& slot : slots_) {
    const SoftManifold& m = solved_manifold(static_cast<std::size_t>(slot.manifold));
    const auto thin_m = [&](int i) {
      return thickness_m(bodies_[static_cast<std::size_t>(i)].geometry);
    };
    deepest_m_ = std::max(deepest_m_, double{slot.deepest_m});
    if (slot.deepest_m > FastLimits::k_told_share * std::min(thin_m(m.body_a), thin_m(m.body_b))) {
      overlap_left_m_ = std::max(overlap_left_m_, double{slot.deepest_m});
    }
  }
  sum_impulses();
  if (is_quiet()) return true;
  join_islands();
  rebound();
  if (after_blow_s_ > 0.0) move_on();
  return limit_energies();
}

void FastDynamics::accept() {
  ++report_.parts;
  for (const SoftManifold& manifold : contacts_.manifolds()) {
    overlap_left_m_ = std::max(overlap_left_m_, passage_of_m(manifold));
  }
  report_.overlap_left_m = std::max(report_.overlap_left_m, overlap_left_m_);
  report_.rebound_left_mps = std::max(report_.rebound_left_mps, rebound_left_mps_);
  report_.unsolved = report_.unsolved || unsolved_;
  report_.energy_taken_j += energy_taken_j_;
  report_.deepest_m = deepest_m_;
  keep_impulses();
  std::swap(motions_, ends_);
}

// The step with the contacts known so far, from its start; motions and carried impulses stay.
void FastDynamics::try_step() {
  ++report_.passes;
  colour_manifolds();
  warm_start();
  run_substeps();
  mark_touched();
  find_ends();
}

// What of a body stays as it is during the step.
void FastDynamics::pose_bodies() {
  pool_.for_ranges(
      bodies_.size(), k_bodies_per_piece, [&](std::size_t begin, std::size_t end) noexcept {
        for (std::size_t i = begin; i < end; ++i) {
          if (bodies_[i].fixed) continue;
          const Eigen::Matrix3d r = motions_[i].attitude.toRotationMatrix();
          const Eigen::Vector3d inverse = bodies_[i].inertia_kgm2.cwiseInverse();
          const Eigen::Matrix3d inertia = r * inverse.asDiagonal() * r.transpose();
          const auto entry = [&](int row, int column) {
            return static_cast<float>(inertia(row, column));
          };
          inertia_[i] = {entry(0, 0),
                         entry(0, 1),
                         entry(0, 2),
                         entry(1, 1),
                         entry(1, 2),
                         entry(2, 2),
                         static_cast<float>(1.0 / bodies_[i].mass_kg),
                         0.0F};
          spin_radps_[i] =
              r * inverse.cwiseProduct(r.transpose() * motions_[i].angular_momentum_kgm2ps);
          double speed_mps = motions_[i].velocity_mps.norm();
          double spin_radps = spin_radps_[i].norm();
          // What loads add counts, what gravity adds does not: it adds the same to all.
          if (!loads_[i].force_n.isZero(0.0) || !loads_[i].torque_nm.isZero(0.0)) {
            speed_mps += step_s_ * loads_[i].force_n.norm() / bodies_[i].mass_kg;
            spin_radps += step_s_ * loads_[i].torque_nm.norm() * inverse.maxCoeff();
          }
          poses_[i] = {r, step_s_ * (speed_mps + spin_radps * radius_m_[i])};
        }
      });
}

// Whoever is struck later still than the last pass knows is found where the trial ends.
void FastDynamics::find_contacts() {
  bool handed_on = true;
  for (int pass = 0; handed_on && pass <= k_reach_passes; ++pass) {
    contacts_.update(motions_, poses_, step_s_, pool_);
    report_.remade += contacts_.made();
    handed_on = pass < k_reach_passes && hand_on_reach();
  }
}

// A body that something fast strikes within this step may take over its speed. Whether some body
// now reaches further than the search for contacts assumed.
bool FastDynamics::hand_on_reach() {
  bool handed_on = false;
  for (const SoftManifold& manifold : contacts_.manifolds()) {
    const auto a = static_cast<std::size_t>(manifold.body_a);
    const auto b = static_cast<std::size_t>(manifold.body_b);
    if (poses_[a].reach_m + poses_[b].reach_m <= options_.margin_m) continue;
    for (std::size_t p = 0; p < static_cast<std::size_t>(manifold.count); ++p) {
      const Eigen::Vector3d& arm_a = manifold.arm_a_m[p];
      const double approach_m =
          step_s_ *
          manifold.normal.dot(velocity_at(a, arm_a) - velocity_at(b, arm_a - manifold.between_m));
      if (approach_m <= std::max(manifold.gap_m[p], 0.0) + options_.margin_m) continue;
      for (const std::size_t i : {a, b}) {
        if (bodies_[i].fixed || poses_[i].reach_m >= approach_m) continue;
        poses_[i].reach_m = approach_m;
        handed_on = true;
      }
    }
  }
  return handed_on;
}

Eigen::Vector3d FastDynamics::velocity_at(std::size_t body, const Eigen::Vector3d& arm_m) const {
  return motions_[body].velocity_mps + spin_radps_[body].cross(arm_m);
}

// The velocity that the impulses carried over from the last step give to each body.
void FastDynamics::warm_start() {
  std::ranges::fill(contact_change_, SoftVector{});
  for (std::size_t c = 0; c + 1 < colour_begin_.size(); ++c) {
    const std::span<SoftBatch> batches = colour(c);
    pool_.for_ranges(batches.size(), k_batches_per_piece,
                     [&](std::size_t begin, std::size_t end) noexcept {
                       soft_push(batches.subspan(begin, end - begin), contact_change_);
                     });
  }
}

std::span<SoftBatch> FastDynamics::colour(std::size_t index) {
  return std::span(batches_).subspan(colour_begin_[index],
                                     colour_begin_[index + 1] - colour_begin_[index]);
}

// All colours, forwards or backwards: alternating keeps errors from marching one way up the wall.
void FastDynamics::sweep(const SoftStep& step, bool biased, bool forwards) {
  const std::size_t colours = colour_begin_.size() - 1;
  for (std::size_t c = 0; c < colours; ++c) {
    const std::span<SoftBatch> batches = colour(forwards ? c : colours - 1 - c);
    // Two pieces per thread: fewer meetings of the threads than with the smallest pieces.
    const std::size_t piece = std::max(
        k_batches_per_piece, batches.size() / (2 * static_cast<std::size_t>(pool_.threads())) + 1);
    pool_.for_ranges(batches.size(), piece, [&](std::size_t begin, std::size_t end) noexcept {
      soft_sweep(batches.subspan(begin, end - begin), step, biased, velocity_, moved_);
    });
  }
}

void FastDynamics::drop_blows() {
  for (std::size_t c = 0; c + 1 < colour_begin_.size(); ++c) {
    const std::span<SoftBatch> batches = colour(c);
    pool_.for_ranges(batches.size(), k_batches_per_piece,
                     [&](std::size_t begin, std::size_t end) noexcept {
                       soft_drop_blows(batches.subspan(begin, end - begin), free_velocity_);
                     });
  }
}

SoftStep FastDynamics::soft_step() const {
  const double h = step_s_ / options_.substeps;
  const double omega =
      std::min(2.0 * std::numbers::pi * options_.contact_hz, k_phase_limit_rad / h);
  const double damping = 2.0 * options_.damping_ratio + h * omega;
  const double forget = 1.0 / (1.0 + h * omega * damping);
  return {static_cast<float>(h), static_cast<float>(omega / damping),
          static_cast<float>(1.0 - forget), static_cast<float>(forget),
          static_cast<float>(options_.push_limit_mps)};
}

void FastDynamics::run_substeps() {
  SoftStep step = soft_step();
  const double h = step_s_ / options_.substeps;
  const bool blows = std::ranges::any_of(batches_, &SoftBatch::struck);
  after_blow_s_ = 0.0;
  const auto for_bodies = [&](auto work) {
    pool_.for_ranges(bodies_.size(), k_bodies_per_piece,
                     [&](std::size_t begin, std::size_t end) noexcept {
                       for (std::size_t i = begin; i < end; ++i) work(i);
                     });
  };
  for_bodies([&](std::size_t i) {
    moved_[i] = {};
    if (bodies_[i].fixed) return;
    velocity_[i] = soft(motions_[i].velocity_mps, spin_radps_[i]);
    const Eigen::Matrix3d& r = poses_[i].axes;
    const Eigen::Vector3d turn =
        r * (r.transpose() * loads_[i].torque_nm).cwiseQuotient(bodies_[i].inertia_kgm2);
    free_change_[i] =
        soft(h * (options_.gravity_mps2 + loads_[i].force_n / bodies_[i].mass_kg), h * turn);
  });
  const auto fly_on = [&](std::size_t i, const Floats& carried) {
    const Floats free = floats(velocity_[i]) + floats(free_change_[i]);
    floats(free_velocity_[i]) = free;
    floats(velocity_[i]) = free + carried;
  };
  for (int s = 0; s < options_.substeps; ++s) {
    // Impulses carried over act first. Their sum on a body is the velocity change that the contacts
    // made in the sub-step before, so no pass over the contacts is needed.
    if (s == 0) {
      for_bodies([&](std::size_t i) { fly_on(i, floats(contact_change_[i])); });
    } else {
      for_bodies(
          [&](std::size_t i) { fly_on(i, floats(velocity_[i]) - floats(free_velocity_[i])); });
    }
    int sweeps = sweeps_;
    for (int k = 0; k < sweeps; ++k) {
      sweep(step, true, (s + k) % 2 == 0);
      if (k > 0 || !blows || !soft_has_blow(batches_)) continue;
      sweeps = FastLimits::k_sweeps;
      after_blow_s_ = h * (options_.substeps - 1 - s);
    }
    for_bodies([&](std::size_t i) { floats(moved_[i]) += step.step_s * floats(velocity_[i]); });
    for (int k = 0; k < sweeps; ++k) {
      step.counted = k + 1 == sweeps ? 1.0F : 0.0F;
      sweep(step, false, (s + k) % 2 != 0);
    }
    if (blows) drop_blows();
  }
}

}  // namespace ourengine
