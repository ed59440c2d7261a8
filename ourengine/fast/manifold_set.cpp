#include "ourengine/fast/manifold_set.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "ourengine/model/by_kind.hpp"

namespace ourengine {
namespace {

constexpr std::size_t k_pairs_per_piece = 32;
constexpr std::size_t k_bodies_per_piece = 256;

std::vector<bool> fixed_flags(std::span<const BodyModel> bodies) {
  std::vector<bool> flags;
  for (const BodyModel& body : bodies) flags.push_back(body.fixed);
  return flags;
}

// How much fatter the boxes of the broad phase are: a few margins, or a tenth of the thinnest body,
// so that debris leaves its box every few steps only.
double slack_m(std::span<const BodyModel> bodies, double margin_m) {
  double thinnest_m = std::numeric_limits<double>::infinity();
  for (const BodyModel& body : bodies) {
    if (!body.fixed) thinnest_m = std::min(thinnest_m, thickness_m(body.geometry));
  }
  return std::isfinite(thinnest_m) ? std::max(4.0 * margin_m, 0.1 * thinnest_m) : 4.0 * margin_m;
}

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// Gaps, arms and normal where the bodies are now.
void move_along(SoftManifold& manifold, std::span<const Motion> motions,
                std::span<const BodyPose> poses) {
  const Eigen::Matrix3d& axes_a = poses[at(manifold.body_a)].axes;
  const Eigen::Matrix3d& axes_b = poses[at(manifold.body_b)].axes;
  manifold.centre_a_m = motions[at(manifold.body_a)].position_m;
  manifold.between_m = motions[at(manifold.body_b)].position_m - manifold.centre_a_m;
  manifold.normal.noalias() = axes_a * manifold.normal_in_a;
  for (std::size_t p = 0; p < at(manifold.count); ++p) {
    const Eigen::Vector3d on_a = axes_a * manifold.on_a_m[p];
    const Eigen::Vector3d on_b = axes_b * manifold.on_b_m[p] + manifold.between_m;
    manifold.gap_m[p] = manifold.normal.dot(on_b - on_a);
    manifold.arm_a_m[p] = 0.5 * (on_a + on_b);
  }
}

// Points of `made` that continue points of `old` take their impulses.
void inherit(const SoftManifold& old, SoftManifold& made, double thin_m) {
  if (old.normal_in_a.dot(made.normal_in_a) < ManifoldSet::k_same_normal) return;
  std::array<bool, SoftManifold::k_points> taken{};
  for (std::size_t p = 0; p < at(made.count); ++p) {
    double nearest = ManifoldSet::k_same_point * ManifoldSet::k_same_point * thin_m * thin_m;
    std::size_t found = SoftManifold::k_points;
    for (std::size_t q = 0; q < at(old.count); ++q) {
      const double distance = (old.on_b_m[q] - made.on_b_m[p]).squaredNorm();
      if (taken[q] || distance >= nearest) continue;
      nearest = distance;
      found = q;
    }
    if (found == SoftManifold::k_points) continue;
    taken[found] = true;
    made.impulse[p] = old.impulse[found];
  }
  if (std::ranges::none_of(taken, std::identity())) return;
  made.friction_impulse = old.friction_impulse;
  made.twist_impulse = old.twist_impulse;
  made.load_n = old.load_n;
}

}  // namespace

int choose_points(const Manifold& manifold, std::array<int, SoftManifold::k_points>& chosen) {
  if (manifold.count <= k_soft_points) {
    for (int k = 0; k < manifold.count; ++k) chosen[at(k)] = k;
    return manifold.count;
  }
  const auto point = [&](int k) -> const ManifoldPoint& { return manifold.points[at(k)]; };
  const auto best = [&](auto score) {
    int found = 0;
    for (int k = 1; k < manifold.count; ++k) {
      if (score(k) > score(found)) found = k;
    }
    return found;
  };
  const int first = best([&](int k) { return -point(k).gap_m; });
  const Eigen::Vector3d& origin = point(first).position_m;
  const int second = best([&](int k) { return (point(k).position_m - origin).squaredNorm(); });
  const auto area = [&](int k) {
    return (point(second).position_m - origin)
        .cross(point(k).position_m - origin)
        .dot(manifold.normal);
  };
  chosen = {first, second, best(area), best([&](int k) { return -area(k); })};
  return k_soft_points;
}

ManifoldSet::ManifoldSet(std::span<const BodyModel> bodies, double margin_m)
    : bodies_(bodies),
      margin_m_(margin_m),
      broad_phase_(fixed_flags(bodies), slack_m(bodies, margin_m)) {
  for (const BodyModel& body : bodies) {
    thickness_m_.push_back(thickness_m(body.geometry));
    radius_m_.push_back(bounding_radius_m(body.geometry));
  }
  boxes_.resize(bodies.size());
}

void ManifoldSet::clear() {
  broad_phase_.clear();
  manifolds_.clear();
}

void ManifoldSet::restore(const History& history) {
  broad_phase_.clear();
  manifolds_ = history;
}

void ManifoldSet::bound_bodies(std::span<const Motion> motions, std::span<const BodyPose> poses,
                               WorkerPool& pool) {
  pool.for_ranges(
      motions.size(), k_bodies_per_piece, [&](std::size_t begin, std::size_t end) noexcept {
        for (std::size_t i = begin; i < end; ++i) {
          const double margin_m = 0.5 * margin_m_ + poses[i].reach_m;
          const auto bound = [&] { return bounds(bodies_[i].geometry, motions[i], margin_m); };
          boxes_[i] = by_kind(
              bodies_[i].geometry,
              [&](const BoxGeometry& box) -> Aabb {
                const Eigen::Vector3d reach =
                    poses[i].axes.cwiseAbs() * box.half_m + Eigen::Vector3d::Constant(margin_m);
                return {motions[i].position_m - reach, motions[i].position_m + reach};
              },
              [&](const SphereGeometry&) { return bound(); },
              [&](const PlaneGeometry&) { return bound(); });
        }
      });
}

// Pairs whose boxes overlap, each with its manifold of the last update.
void ManifoldSet::list_jobs() {
  broad_phase_.update(boxes_);
  jobs_.clear();
  std::size_t old = 0;
  for (const BodyPair& pair : broad_phase_.pairs()) {
    if (!boxes_[at(pair.first)].overlaps(boxes_[at(pair.second)])) continue;
    const auto before = [&](const SoftManifold& m) {
      return m.body_a != pair.first ? m.body_a < pair.first : m.body_b < pair.second;
    };
    while (old < manifolds_.size() && before(manifolds_[old])) ++old;
    const bool known = old < manifolds_.size() && manifolds_[old].body_a == pair.first &&
                       manifolds_[old].body_b == pair.second;
    jobs_.push_back({pair, known ? static_cast<int>(old) : -1});
  }
}

bool ManifoldSet::may_recycle(const SoftManifold& old, std::span<const Motion> motions,
                              double margin_m) const {
  const std::size_t a = at(old.body_a);
  const std::size_t b = at(old.body_b);
  const double bound_m = k_recycle_share * std::min(thickness_m_[a], thickness_m_[b]);
  if (margin_m + 2.0 * bound_m > old.made_margin_m) return false;
  const Eigen::Quaterniond to_a = motions[a].attitude.conjugate();
  const Eigen::Quaterniond turned = to_a * motions[b].attitude;
  // |dq| is half the angle; q and -q are the same attitude.
  const double same = (turned.coeffs() - old.b_in_a.coeffs()).squaredNorm();
  const double flipped = (turned.coeffs() + old.b_in_a.coeffs()).squaredNorm();
  const Eigen::Vector3d between_m = motions[b].position_m - motions[a].position_m;
  // How far from the centre of b its contacts with a can be.
  const double lever_m = std::min(radius_m_[b], between_m.norm() + radius_m_[a]);
  const double turn_m = 2.0 * lever_m * std::sqrt(std::min(same, flipped));
  const double moved_m = (to_a * between_m - old.b_in_a_m).norm();
  return moved_m + turn_m <= bound_m;
}

SoftManifold ManifoldSet::make(const BodyPair& pair, std::span<const Motion> motions,
                               std::span<const BodyPose> poses, double step_s) const {
  const std::size_t a = at(pair.first);
  const std::size_t b = at(pair.second);
  const double approach_m = poses[a].reach_m + poses[b].reach_m;
  SoftManifold made;
  made.body_a = pair.first;
  made.body_b = pair.second;
  const double bound_m = k_recycle_share * std::min(thickness_m_[a], thickness_m_[b]);
  made.made_margin_m = 1.5 * margin_m_ + approach_m + 2.0 * bound_m;
  const Manifold manifold = collide_within_step(bodies_[a], motions[a], bodies_[b], motions[b],
                                                step_s, approach_m, made.made_margin_m);
  std::array<int, SoftManifold::k_points> chosen{};
  made.count = choose_points(manifold, chosen);
  const Eigen::Quaterniond to_a = motions[a].attitude.conjugate();
  made.centre_a_m = motions[a].position_m;
  made.between_m = motions[b].position_m - made.centre_a_m;
  made.b_in_a_m = to_a * made.between_m;
  made.b_in_a = to_a * motions[b].attitude;
  made.normal = manifold.normal;
  made.normal_in_a.noalias() = poses[a].axes.transpose() * manifold.normal;
  for (std::size_t p = 0; p < at(made.count); ++p) {
    const ManifoldPoint& point = manifold.points[at(chosen[p])];
    const Eigen::Vector3d half_gap = 0.5 * point.gap_m * manifold.normal;
    made.arm_a_m[p] = point.position_m - motions[a].position_m;
    made.gap_m[p] = point.gap_m;
    made.on_a_m[p].noalias() = poses[a].axes.transpose() * (made.arm_a_m[p] - half_gap);
    made.on_b_m[p].noalias() =
        poses[b].axes.transpose() * (made.arm_a_m[p] - made.between_m + half_gap);
  }
  return made;
}

void ManifoldSet::update(std::span<const Motion> motions, std::span<const BodyPose> poses,
                         double step_s, WorkerPool& pool) {
  bound_bodies(motions, poses, pool);
  list_jobs();
  // At rest the pairs stay the same, and manifolds are moved along where they lie.
  const bool in_place = jobs_.size() == manifolds_.size() &&
                        (jobs_.empty() || std::ranges::all_of(jobs_, [&](const Job& job) {
                           return job.old == static_cast<int>(&job - jobs_.data());
                         }));
  if (in_place) {
    next_.swap(manifolds_);
  } else {
    next_.resize(jobs_.size());
  }
  const std::vector<SoftManifold>& known = in_place ? next_ : manifolds_;
  std::atomic<int> made = 0;  // a count: the order of its sum does not matter
  pool.for_ranges(
      jobs_.size(), k_pairs_per_piece, [&](std::size_t begin, std::size_t end) noexcept {
        int fresh = 0;
        for (std::size_t k = begin; k < end; ++k) {
          const Job& job = jobs_[k];
          const std::size_t a = at(job.pair.first);
          const std::size_t b = at(job.pair.second);
          const double margin_m = margin_m_ + poses[a].reach_m + poses[b].reach_m;
          if (job.old >= 0 && may_recycle(known[at(job.old)], motions, margin_m)) {
            if (!in_place) next_[k] = known[at(job.old)];
            move_along(next_[k], motions, poses);
            continue;
          }
          ++fresh;
          SoftManifold fresh_one = make(job.pair, motions, poses, step_s);
          if (job.old >= 0) {
            inherit(known[at(job.old)], fresh_one, std::min(thickness_m_[a], thickness_m_[b]));
          }
          next_[k] = fresh_one;
        }
        made.fetch_add(fresh, std::memory_order_relaxed);
      });
  made_ = made.load(std::memory_order_relaxed);
  manifolds_.swap(next_);
}

}  // namespace ourengine
