#include "ourengine/fast/fast_dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ourengine/integration/rotation.hpp"

namespace ourengine {
namespace {

// Contact frequency over sub-step rate above which the soft step is no longer a spring.
constexpr double k_frequency_share = 0.125;
// A struck body may in turn strike its neighbours within the step: contacts are looked up again
// with the reach of the striker handed on, so often.
constexpr int k_reach_passes = 3;

SoftVector soft(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular) {
  const Eigen::Vector3f l = linear.cast<float>();
  const Eigen::Vector3f a = angular.cast<float>();
  return {l.x(), l.y(), l.z(), 0.0F, a.x(), a.y(), a.z(), 0.0F};
}

Eigen::Vector3d linear_part(const SoftVector& v) { return {v[0], v[1], v[2]}; }
Eigen::Vector3d angular_part(const SoftVector& v) { return {v[4], v[5], v[6]}; }

SoftVector plus(const SoftVector& a, const SoftVector& b) {
  SoftVector sum;
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] = a[k] + b[k];
  return sum;
}

}  // namespace

FastDynamics::FastDynamics(std::vector<BodyModel> bodies, std::vector<Motion> motions,
                           SurfaceLaws laws, FastOptions options)
    : bodies_(std::move(bodies)),
      motions_(std::move(motions)),
      laws_(std::move(laws)),
      options_(options),
      loads_(bodies_.size()),
      contacts_(bodies_, options.margin_m),
      reach_m_(bodies_.size(), 0.0),
      inverse_inertia_(bodies_.size()),
      touched_(bodies_.size(), false) {}

void FastDynamics::apply(std::span<const Load> loads) { std::ranges::copy(loads, loads_.begin()); }

void FastDynamics::set_motions(std::span<const Motion> motions) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (!bodies_[i].fixed) motions_[i] = motions[i];
  }
  contacts_.clear();
}

const FastReport& FastDynamics::step() {
  find_contacts();
  colour_manifolds();
  warm_start();
  run_substeps();
  keep_impulses();
  move_bodies();
  std::ranges::fill(loads_, Load{});
  return report_;
}

void FastDynamics::find_contacts() {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    reach_m_[i] = 0.0;
    inverse_inertia_[i].setZero();
    if (bodies_[i].fixed) continue;
    const Eigen::Matrix3d r = motions_[i].attitude.toRotationMatrix();
    inverse_inertia_[i] = r * bodies_[i].inertia_kgm2.cwiseInverse().asDiagonal() * r.transpose();
    const Eigen::Vector3d spin = inverse_inertia_[i] * motions_[i].angular_momentum_kgm2ps;
    reach_m_[i] = options_.step_s * (motions_[i].velocity_mps.norm() +
                                     spin.norm() * bounding_radius_m(bodies_[i].geometry));
  }
  for (int pass = 0; pass < k_reach_passes; ++pass) {
    contacts_.update(motions_, reach_m_, options_.step_s);
    bool handed_on = false;
    for (const ContactPoint& point : contacts_.points()) {
      const auto a = static_cast<std::size_t>(point.body_a);
      const auto b = static_cast<std::size_t>(point.body_b);
      const double approach_m =
          options_.step_s * point.normal.dot(velocity_at(a, point) - velocity_at(b, point));
      // Struck within this step by something fast: the body may take over its speed.
      if (approach_m <= std::max(point.gap_m, 0.0) + options_.margin_m) continue;
      for (const std::size_t i : {a, b}) {
        if (bodies_[i].fixed || reach_m_[i] >= approach_m) continue;
        reach_m_[i] = approach_m;
        handed_on = true;
      }
    }
    if (!handed_on) break;
  }
}

Eigen::Vector3d FastDynamics::velocity_at(std::size_t body, const ContactPoint& point) const {
  const Motion& motion = motions_[body];
  const Eigen::Vector3d spin = inverse_inertia_[body] * motion.angular_momentum_kgm2ps;
  return motion.velocity_mps + spin.cross(point.position_m - motion.position_m);
}

// The velocity that the impulses carried over from the last step give to each body.
void FastDynamics::warm_start() {
  contact_change_.assign(bodies_.size() + 1, SoftVector{});
  for (const Slot& slot : slots_) {
    const SoftBatch& batch = batches_[static_cast<std::size_t>(slot.batch)];
    const auto i = static_cast<std::size_t>(slot.lane);
    SoftVector& a = contact_change_[static_cast<std::size_t>(batch.body_a[i])];
    SoftVector& b = contact_change_[static_cast<std::size_t>(batch.body_b[i])];
    const auto push = [&](const Lane3& direction, const SoftRow& row, float impulse) {
      for (std::size_t k = 0; k < 3; ++k) {
        a[k] -= impulse * batch.inverse_mass_a[i] * direction[k][i];
        b[k] += impulse * batch.inverse_mass_b[i] * direction[k][i];
        a[4 + k] -= impulse * row.turn_a[k][i];
        b[4 + k] += impulse * row.turn_b[k][i];
      }
    };
    for (int p = 0; p < slot.solved; ++p) {
      const SoftPoint& point = batch.point[static_cast<std::size_t>(p)];
      push(batch.normal, point.row, point.impulse[i]);
    }
    push(batch.tangent[0], batch.friction_row[0], batch.friction_impulse[0][i]);
    push(batch.tangent[1], batch.friction_row[1], batch.friction_impulse[1][i]);
    for (std::size_t k = 0; k < 3; ++k) {
      a[4 + k] -= batch.twist_impulse[i] * batch.twist_a[k][i];
      b[4 + k] += batch.twist_impulse[i] * batch.twist_b[k][i];
    }
  }
  contact_change_.back().fill(0.0F);
}

std::span<SoftBatch> FastDynamics::colour(std::size_t index) {
  return std::span(batches_).subspan(colour_begin_[index],
                                     colour_begin_[index + 1] - colour_begin_[index]);
}

// All colours, forwards or backwards: alternating keeps errors from marching one way up the wall.
void FastDynamics::sweep(const SoftStep& step, bool biased, bool forwards) {
  const std::size_t colours = colour_begin_.size() - 1;
  for (std::size_t c = 0; c < colours; ++c) {
    soft_sweep(colour(forwards ? c : colours - 1 - c), step, biased, velocity_, moved_);
  }
}

void FastDynamics::run_substeps() {
  const double h = options_.step_s / options_.substeps;
  const double omega =
      2.0 * std::numbers::pi * std::min(options_.contact_hz, k_frequency_share / h);
  const double damping = 2.0 * options_.damping_ratio + h * omega;
  const double forget = 1.0 / (1.0 + h * omega * damping);
  const SoftStep step{static_cast<float>(h), static_cast<float>(omega / damping),
                      static_cast<float>(1.0 - forget), static_cast<float>(forget),
                      static_cast<float>(options_.push_limit_mps)};
  const std::size_t count = bodies_.size() + 1;
  velocity_.assign(count, SoftVector{});
  moved_.assign(count, SoftVector{});
  free_change_.assign(count, SoftVector{});
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (bodies_[i].fixed) continue;
    velocity_[i] =
        soft(motions_[i].velocity_mps, inverse_inertia_[i] * motions_[i].angular_momentum_kgm2ps);
    free_change_[i] = soft(h * (options_.gravity_mps2 + loads_[i].force_n / bodies_[i].mass_kg),
                           h * inverse_inertia_[i] * loads_[i].torque_nm);
  }
  for (int s = 0; s < options_.substeps; ++s) {
    // Impulses carried over act first. Their sum on a body is the velocity change that the contacts
    // made in the sub-step before, so no pass over the contacts is needed.
    for (std::size_t i = 0; i + 1 < count; ++i) {
      const SoftVector free = plus(velocity_[i], free_change_[i]);
      velocity_[i] = plus(free, contact_change_[i]);
      contact_change_[i] = free;
    }
    sweep(step, true, s % 2 == 0);
    for (std::size_t i = 0; i + 1 < count; ++i) {
      for (std::size_t k = 0; k < 8; ++k) moved_[i][k] += step.step_s * velocity_[i][k];
    }
    sweep(step, false, s % 2 != 0);
    for (std::size_t i = 0; i + 1 < count; ++i) {
      for (std::size_t k = 0; k < 8; ++k) {
        contact_change_[i][k] = velocity_[i][k] - contact_change_[i][k];
      }
    }
  }
  if (!bouncing_) return;
  for (std::size_t c = 0; c + 1 < colour_begin_.size(); ++c) soft_bounce(colour(c), velocity_);
}

// Back into the contacts: friction and twist of a manifold become forces at its points.
void FastDynamics::keep_impulses() {
  std::fill(touched_.begin(), touched_.end(), false);
  const auto points = contacts_.points();
  for (const Slot& slot : slots_) {
    const SoftBatch& batch = batches_[static_cast<std::size_t>(slot.batch)];
    const auto i = static_cast<std::size_t>(slot.lane);
    const auto own =
        points.subspan(static_cast<std::size_t>(slot.first), static_cast<std::size_t>(slot.count));
    for (ContactPoint& point : own) point.impulse_ns.setZero();
    const auto vector = [&](const Lane3& lanes) {
      return Eigen::Vector3d(lanes[0][i], lanes[1][i], lanes[2][i]);
    };
    const Eigen::Vector3d friction =
        static_cast<double>(batch.friction_impulse[0][i]) * vector(batch.tangent[0]) +
        static_cast<double>(batch.friction_impulse[1][i]) * vector(batch.tangent[1]);
    const auto chosen = [&](int p) -> ContactPoint& {
      return own[static_cast<std::size_t>(slot.chosen[static_cast<std::size_t>(p)])];
    };
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (int p = 0; p < slot.solved; ++p) centre += chosen(p).position_m / slot.solved;
    double arms = 0.0;
    for (int p = 0; p < slot.solved; ++p) arms += (chosen(p).position_m - centre).squaredNorm();
    const double turn = arms > 0.0 ? static_cast<double>(batch.twist_impulse[i]) / arms : 0.0;
    bool touched = false;
    for (int p = 0; p < slot.solved; ++p) {
      ContactPoint& point = chosen(p);
      const SoftPoint& solved = batch.point[static_cast<std::size_t>(p)];
      touched = touched || solved.max_impulse[i] > 0.0F;
      point.impulse_ns =
          options_.substeps *
          (static_cast<double>(solved.impulse[i]) * point.normal + friction / slot.solved +
           turn * point.normal.cross(point.position_m - centre));
    }
    if (!touched) continue;
    touched_[static_cast<std::size_t>(own[0].body_a)] = true;
    touched_[static_cast<std::size_t>(own[0].body_b)] = true;
  }
}

void FastDynamics::move_bodies() {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (bodies_[i].fixed) continue;
    Motion& motion = motions_[i];
    if (touched_[i]) {
      motion.position_m += linear_part(moved_[i]);
      motion.velocity_mps = linear_part(velocity_[i]);
      const Eigen::Matrix3d r = motion.attitude.toRotationMatrix();
      motion.angular_momentum_kgm2ps =
          r * bodies_[i].inertia_kgm2.cwiseProduct(r.transpose() * angular_part(velocity_[i]));
      motion.attitude = turned(motion.attitude, angular_part(moved_[i]));
      continue;
    }
    const Eigen::Vector3d change =
        options_.step_s * (options_.gravity_mps2 + loads_[i].force_n / bodies_[i].mass_kg);
    motion.position_m += options_.step_s * (motion.velocity_mps + 0.5 * change);
    motion.velocity_mps += change;
    motion.angular_momentum_kgm2ps += options_.step_s * loads_[i].torque_nm;
    motion.attitude = rotate_moser_veselov(motion.attitude, bodies_[i].inertia_kgm2,
                                           motion.angular_momentum_kgm2ps, options_.step_s);
  }
}

}  // namespace ourengine
