// Where a trial of the step brings the bodies, and which contacts it did without.
#include <algorithm>

#include "ourengine/fast/fast_dynamics.hpp"
#include "ourengine/fast/soft_vector.hpp"
#include "ourengine/integration/rotation.hpp"

namespace ourengine {
namespace {

// Of the thinner body: who gets further than the search for contacts assumed by less than this has
// met, where the step ends, whomever it meets.
constexpr double k_pass_share = 0.25;
// Room for the next trial to bring bodies a little further still.
constexpr double k_reach_growth = 1.25;
// What free flight would make of a turn like this cannot be told from it in double precision.
constexpr double k_no_turn_rad = 1e-7;
constexpr std::size_t k_bodies_per_piece = 256;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

// Bodies that the trial brought further than the search for contacts assumed, into far_. Whether
// one of them got so far that it may have passed through another: then the search is repeated.
bool FastDynamics::find_far() {
  bool passed = false;
  far_.clear();
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (bodies_[i].fixed) continue;
    const double travel_m =
        linear_part(moved_[i]).norm() + angular_part(moved_[i]).norm() * radius_m_[i];
    const double beyond_m = travel_m - poses_[i].reach_m;
    if (beyond_m <= 0.5 * options_.margin_m) continue;
    far_.push_back(static_cast<int>(i));
    passed = passed || beyond_m > k_pass_share * thickness_m(bodies_[i].geometry);
    poses_[i].reach_m = travel_m;
  }
  if (!passed) return false;
  for (const int i : far_) poses_[at(i)].reach_m *= k_reach_growth;
  return true;
}

// By how much the trial opens a gap, as its sweeps count it: linear in what the bodies moved.
double FastDynamics::opened_m(const SoftManifold& manifold, std::size_t point,
                              std::span<const SoftVector> moved) {
  const Eigen::Vector3d& arm_a = manifold.arm_a_m[point];
  const Eigen::Vector3d arm_b = arm_a - manifold.between_m;
  const SoftVector& a = moved[at(manifold.body_a)];
  const SoftVector& b = moved[at(manifold.body_b)];
  return manifold.normal.dot(linear_part(b) + angular_part(b).cross(arm_b) - linear_part(a) -
                             angular_part(a).cross(arm_a));
}

// New overlap that is not worth another trial: half a margin, of thin bodies half the distance
// within which points are the same.
double FastDynamics::look_tolerance_m(int a, int b) const {
  const double thinner_m =
      std::min(thickness_m(bodies_[at(a)].geometry), thickness_m(bodies_[at(b)].geometry));
  return FastLimits::k_look_tolerance *
         std::min(options_.margin_m, ManifoldSet::k_same_point * thinner_m);
}

// Finds the pairs that the trial leaves overlapping though its contacts say otherwise: bricks that
// turn or slide over each other within the step meet with other corners than those they showed at
// its start, and struck bodies meet those that were out of their reach. late_ gets contacts made
// where the trial ends, with gaps that are exact there and linear in the motion. Where contacts
// that the trial does have are left deeper than they were, its sweeps were too few for the blow:
// the next one has twice as many. Stuck where they have as many as they may and nothing is new:
// another trial would be the same.
FastDynamics::Look FastDynamics::look_ahead() {
  const std::size_t before = late_.size();
  overlap_left_m_ = 0.0;
  double unsettled_m = 0.0;
  for (const SoftManifold& known : contacts_.manifolds()) {
    if (poses_[at(known.body_a)].reach_m + poses_[at(known.body_b)].reach_m <= options_.margin_m) {
      continue;
    }
    double seen_m = 0.0;
    double deeper_m = 0.0;
    for (std::size_t p = 0; p < at(known.count); ++p) {
      const double end_m = known.gap_m[p] + opened_m(known, p, moved_);
      seen_m = std::min(seen_m, end_m);
      deeper_m = std::max(deeper_m, std::min(0.0, known.gap_m[p]) - end_m);
    }
    if (deeper_m > look_tolerance_m(known.body_a, known.body_b)) {
      unsettled_m = std::max(unsettled_m, deeper_m);
    }
    look_at({known.body_a, known.body_b}, seen_m);
  }
  if (!far_.empty()) look_around_far();
  const bool unsettled = unsettled_m > 0.0;
  if (unsettled) overlap_left_m_ = std::max(overlap_left_m_, unsettled_m);
  const bool found = late_.size() > before;
  if (!unsettled && !found) return Look::settled;
  if (!found && sweeps_ == FastLimits::k_sweeps) return Look::stuck;
  if (unsettled) sweeps_ = std::min(2 * sweeps_, FastLimits::k_sweeps);
  return Look::again;
}

// Pairs with a far body that the search for contacts did not even list.
void FastDynamics::look_around_far() {
  end_boxes_.resize(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    end_boxes_[i] = bounds(bodies_[i].geometry, ends_[i], 0.0);
  }
  const auto known = contacts_.manifolds();
  for (const int i : far_) {
    for (int j = 0; j < static_cast<int>(bodies_.size()); ++j) {
      if (j == i || !end_boxes_[at(i)].overlaps(end_boxes_[at(j)])) continue;
      if (j < i && std::ranges::binary_search(far_, j)) continue;  // was looked at from j
      const BodyPair pair{std::min(i, j), std::max(i, j)};
      const auto place = std::ranges::lower_bound(known, pair, {}, [](const SoftManifold& m) {
        return BodyPair{m.body_a, m.body_b};
      });
      if (place != known.end() && place->body_a == pair.first && place->body_b == pair.second) {
        continue;
      }
      look_at(pair, 0.0);
    }
  }
}

// seen_m <= 0: the deepest gap that the trial's contacts of this pair end with.
void FastDynamics::look_at(const BodyPair& pair, double seen_m) {
  const auto a = at(pair.first);
  const auto b = at(pair.second);
  const double tolerance_m = look_tolerance_m(pair.first, pair.second);
  if (collide(bodies_[a], ends_[a], bodies_[b], ends_[b], -tolerance_m).count == 0) return;
  const Manifold end = collide(bodies_[a], ends_[a], bodies_[b], ends_[b], 0.0);
  double deepest_m = 0.0;
  for (int p = 0; p < end.count; ++p) deepest_m = std::min(deepest_m, end.points[at(p)].gap_m);
  if (seen_m - deepest_m <= tolerance_m) return;
  overlap_left_m_ = std::max(overlap_left_m_, seen_m - deepest_m);
  late_.push_back(late_manifold(pair, end));
}

SoftManifold FastDynamics::late_manifold(const BodyPair& pair, const Manifold& end) const {
  const auto a = at(pair.first);
  const auto b = at(pair.second);
  SoftManifold late;
  late.body_a = pair.first;
  late.body_b = pair.second;
  late.normal = end.normal;
  late.centre_a_m = motions_[a].position_m;
  late.between_m = motions_[b].position_m - late.centre_a_m;
  std::array<int, SoftManifold::k_points> chosen{};
  late.count = choose_points(end, chosen);
  for (std::size_t p = 0; p < at(late.count); ++p) {
    const ManifoldPoint& point = end.points[at(chosen[p])];
    // Where it is on the one body and on the other at the start of the step: midway, so that the
    // impulses on both act along one line. What is fixed does not care.
    const auto start = [&](std::size_t i) {
      return Eigen::Vector3d(motions_[i].position_m +
                             motions_[i].attitude * (ends_[i].attitude.conjugate() *
                                                     (point.position_m - ends_[i].position_m)));
    };
    const Eigen::Vector3d on_a = start(bodies_[a].fixed ? b : a);
    const Eigen::Vector3d on_b = start(bodies_[b].fixed ? a : b);
    late.arm_a_m[p] = 0.5 * (on_a + on_b) - late.centre_a_m;
    late.gap_m[p] = 0.0;
    late.gap_m[p] = point.gap_m - opened_m(late, p, moved_);
  }
  return late;
}

void FastDynamics::find_ends() {
  ends_.resize(bodies_.size());
  pool_.for_ranges(bodies_.size(), k_bodies_per_piece,
                   [&](std::size_t begin, std::size_t end) noexcept {
                     for (std::size_t i = begin; i < end; ++i)
                       ends_[i] = bodies_[i].fixed ? motions_[i] : end_of(i);
                   });
}

// Of a spin (rad/s) at the attitude of the start.
Eigen::Vector3d FastDynamics::momentum_of(std::size_t i, const Eigen::Vector3d& spin_radps) const {
  const Eigen::Matrix3d& r = poses_[i].axes;
  return r * bodies_[i].inertia_kgm2.cwiseProduct(r.transpose() * spin_radps);
}

// The attitude after a turn (rad) that a touched body makes in sub-steps of constant spin: as in
// free flight from the spin that it has on average, since a body that kept its spin instead of its
// angular momentum would not keep its energy.
Eigen::Quaterniond FastDynamics::turned_freely(std::size_t i,
                                               const Eigen::Vector3d& turn_rad) const {
  const Eigen::Quaterniond& start = motions_[i].attitude;
  if (turn_rad.squaredNorm() < k_no_turn_rad * k_no_turn_rad) return turned(start, turn_rad);
  const Eigen::Vector3d& inertia = bodies_[i].inertia_kgm2;
  if (turn_rad.squaredNorm() > FastLimits::k_small_turn_rad * FastLimits::k_small_turn_rad) {
    return rotate_moser_veselov(start, inertia, momentum_of(i, turn_rad / step_s_), step_s_);
  }
  const Eigen::Matrix3d& r = poses_[i].axes;
  const Eigen::Vector3d turn = r.transpose() * turn_rad;
  const Eigen::Vector3d bend = inertia.cwiseProduct(turn).cross(turn).cwiseQuotient(inertia);
  return turned(start, r * (turn + 0.5 * bend));
}

Motion FastDynamics::end_of(std::size_t i) const {
  Motion motion = motions_[i];
  if (touched_[i] != 0) {
    motion.position_m += linear_part(moved_[i]);
    motion.velocity_mps = linear_part(velocity_[i]);
    motion.angular_momentum_kgm2ps = momentum_of(i, angular_part(velocity_[i]));
    motion.attitude = turned_freely(i, angular_part(moved_[i]));
    return motion;
  }
  const Eigen::Vector3d change =
      step_s_ * (options_.gravity_mps2 + loads_[i].force_n / bodies_[i].mass_kg);
  motion.position_m += step_s_ * (motion.velocity_mps + 0.5 * change);
  motion.velocity_mps += change;
  motion.angular_momentum_kgm2ps += step_s_ * loads_[i].torque_nm;
  motion.attitude = rotate_moser_veselov(motion.attitude, bodies_[i].inertia_kgm2,
                                         motion.angular_momentum_kgm2ps, step_s_);
  return motion;
}

}  // namespace ourengine
