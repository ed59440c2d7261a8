#include "ourengine/fast/fast_dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ourengine {
namespace {

// The stiffest contact that a sub-step still resolves: its phase advances by one radian.
constexpr double k_phase_limit_rad = 1.0;
// A struck body may in turn strike its neighbours within the step: contacts are looked up again
// with the reach of the striker handed on, so often.
constexpr int k_reach_passes = 2;
// A step is tried again with the contacts that its end showed to be missing, so often. Debris of a
// brick at 20 m/s never needs more than 8; at 200 m/s each trial still finds what the last did not.
constexpr int k_trial_limit = 24;
constexpr std::size_t k_batches_per_piece = 4;
constexpr std::size_t k_bodies_per_piece = 256;

SoftVector soft(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular) {
  const Eigen::Vector3f l = linear.cast<float>();
  const Eigen::Vector3f a = angular.cast<float>();
  return {l.x(), l.y(), l.z(), 0.0F, a.x(), a.y(), a.z(), 0.0F};
}

SoftVector plus(const SoftVector& a, const SoftVector& b) {
  SoftVector sum;
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] = a[k] + b[k];
  return sum;
}

SoftVector minus(const SoftVector& a, const SoftVector& b) {
  SoftVector difference;
  for (std::size_t k = 0; k < difference.size(); ++k) difference[k] = a[k] - b[k];
  return difference;
}

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
}

void FastDynamics::restore(const Snapshot& snapshot) {
  motions_ = snapshot.motions;
  contacts_.restore(snapshot.contacts);
  late_.clear();
  slots_.clear();
}

const FastReport& FastDynamics::step() {
  report_ = {};
  late_.clear();
  sweeps_ = 1;
  pose_bodies();
  bool search = true;
  bool missing = true;
  std::size_t solved = 0;
  while (missing && report_.passes < k_trial_limit) {
    if (search) find_contacts();
    try_step();
    solved = late_.size();
    search = find_far();
    missing = search || look_ahead();
  }
  late_.resize(solved);
  report_.ran_out = missing;
  keep_impulses();
  std::swap(motions_, ends_);
  std::ranges::fill(loads_, Load{});
  return report_;
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
  pool_.for_ranges(bodies_.size(), k_bodies_per_piece, [&](std::size_t begin, std::size_t end) {
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
      poses_[i] = {r, options_.step_s *
                          (motions_[i].velocity_mps.norm() + spin_radps_[i].norm() * radius_m_[i])};
    }
  });
}

// Whoever is struck later still than the last pass knows is found where the trial ends.
void FastDynamics::find_contacts() {
  bool handed_on = true;
  for (int pass = 0; handed_on && pass <= k_reach_passes; ++pass) {
    contacts_.update(motions_, poses_, options_.step_s, pool_);
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
          options_.step_s *
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
    pool_.for_ranges(batches.size(), k_batches_per_piece, [&](std::size_t begin, std::size_t end) {
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
    pool_.for_ranges(batches.size(), piece, [&](std::size_t begin, std::size_t end) {
      soft_sweep(batches.subspan(begin, end - begin), step, biased, velocity_, moved_);
    });
  }
}

SoftStep FastDynamics::soft_step() const {
  const double h = options_.step_s / options_.substeps;
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
  const double h = options_.step_s / options_.substeps;
  const auto for_bodies = [&](auto work) {
    pool_.for_ranges(bodies_.size(), k_bodies_per_piece, [&](std::size_t begin, std::size_t end) {
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
  for (int s = 0; s < options_.substeps; ++s) {
    // Impulses carried over act first. Their sum on a body is the velocity change that the contacts
    // made in the sub-step before, so no pass over the contacts is needed.
    for_bodies([&](std::size_t i) {
      const SoftVector carried =
          s == 0 ? contact_change_[i] : minus(velocity_[i], free_velocity_[i]);
      free_velocity_[i] = plus(velocity_[i], free_change_[i]);
      velocity_[i] = plus(free_velocity_[i], carried);
    });
    for (int k = 0; k < sweeps_; ++k) sweep(step, true, (s + k) % 2 == 0);
    for_bodies([&](std::size_t i) {
      for (std::size_t k = 0; k < 8; ++k) moved_[i][k] += step.step_s * velocity_[i][k];
    });
    for (int k = 0; k < sweeps_; ++k) {
      step.counted = k + 1 == sweeps_ ? 1.0F : 0.0F;
      sweep(step, false, (s + k) % 2 != 0);
    }
  }
  if (!bouncing_) return;
  for (std::size_t c = 0; c + 1 < colour_begin_.size(); ++c) soft_bounce(colour(c), velocity_);
}

}  // namespace ourengine
