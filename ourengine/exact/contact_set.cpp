#include "ourengine/exact/contact_set.hpp"

#include <algorithm>

namespace ourengine {
namespace {

// Of the thinner body: a point that moved less than this over its body is the same point.
constexpr double k_same_point = 0.1;
// Cosine between normals of the same point.
constexpr double k_same_normal = 0.9;

// Pairs that one thread takes at a time: some 50 us.
constexpr std::size_t k_pairs_at_once = 64;

std::vector<bool> fixed_flags(std::span<const BodyModel> bodies) {
  std::vector<bool> flags;
  for (const BodyModel& body : bodies) flags.push_back(body.fixed);
  return flags;
}

bool same_pair(const ContactPoint& point, int a, int b) {
  return point.body_a == a && point.body_b == b;
}

bool before(const ContactPoint& point, int a, int b) {
  return point.body_a != a ? point.body_a < a : point.body_b < b;
}

}  // namespace

ContactSet::ContactSet(std::span<const BodyModel> bodies, double margin_m)
    : bodies_(bodies), margin_m_(margin_m), broad_phase_(fixed_flags(bodies), 4.0 * margin_m) {
  for (const BodyModel& body : bodies) thickness_m_.push_back(thickness_m(body.geometry));
}

void ContactSet::clear() {
  broad_phase_.clear();
  points_.clear();
  previous_.clear();
  next_id_ = 1;
}

void ContactSet::restore(const History& history) {
  clear();
  points_ = history.points;
  next_id_ = history.next_id;
}

void ContactSet::inherit(ContactPoint& point, std::size_t first_of_pair) {
  const double thin = std::min(thickness_m_[static_cast<std::size_t>(point.body_a)],
                               thickness_m_[static_cast<std::size_t>(point.body_b)]);
  double nearest = k_same_point * k_same_point * thin * thin;
  std::size_t found = previous_.size();
  for (std::size_t k = first_of_pair;
       k < previous_.size() && same_pair(previous_[k], point.body_a, point.body_b); ++k) {
    if (inherited_[k] || previous_[k].normal.dot(point.normal) < k_same_normal) continue;
    const double distance = (previous_[k].anchor_m - point.anchor_m).squaredNorm();
    if (distance < nearest) {
      nearest = distance;
      found = k;
    }
  }
  if (found == previous_.size()) {
    point.id = next_id_++;
    return;
  }
  inherited_[found] = true;
  point.id = previous_[found].id;
  point.impulse_ns = previous_[found].impulse_ns;
}

void ContactSet::add_manifold(int a, int b, const Manifold& manifold,
                              std::span<const Motion> motions) {
  const Motion& frame = motions[static_cast<std::size_t>(b)];
  for (int p = 0; p < manifold.count; ++p) {
    const ManifoldPoint& from = manifold.points[static_cast<std::size_t>(p)];
    ContactPoint point;
    point.body_a = a;
    point.body_b = b;
    point.position_m = from.position_m;
    point.normal = manifold.normal;
    point.gap_m = from.gap_m;
    point.anchor_m = frame.attitude.conjugate() * (from.position_m - frame.position_m);
    points_.push_back(point);
  }
}

void ContactSet::find_pairs(std::span<const Motion> motions, std::span<const double> reach_m) {
  boxes_.resize(motions.size());
  for (std::size_t i = 0; i < motions.size(); ++i) {
    boxes_[i] = bounds(bodies_[i].geometry, motions[i], 0.5 * margin_m_ + reach_m[i]);
  }
  broad_phase_.update(boxes_);
}

void ContactSet::update(std::span<const Motion> motions, std::span<const double> reach_m,
                        double step_s, WorkerPool& workers) {
  std::swap(points_, previous_);
  points_.clear();
  inherited_.assign(previous_.size(), false);
  find_pairs(motions, reach_m);

  const auto pairs = broad_phase_.pairs();
  manifolds_.resize(pairs.size());
  workers.for_ranges(
      pairs.size(), k_pairs_at_once, [&](std::size_t begin, std::size_t end) noexcept {
        for (std::size_t p = begin; p < end; ++p) {
          const auto i = static_cast<std::size_t>(pairs[p].first);
          const auto j = static_cast<std::size_t>(pairs[p].second);
          manifolds_[p].count = 0;
          if (!boxes_[i].overlaps(boxes_[j])) continue;
          const double approach_m = reach_m[i] + reach_m[j];
          manifolds_[p] = collide_within_step(bodies_[i], motions[i], bodies_[j], motions[j],
                                              step_s, approach_m, margin_m_ + approach_m);
        }
      });
  std::size_t old = 0;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const BodyPair& pair = pairs[p];
    const std::size_t first_new = points_.size();
    add_manifold(pair.first, pair.second, manifolds_[p], motions);
    while (old < previous_.size() && before(previous_[old], pair.first, pair.second)) ++old;
    for (std::size_t k = first_new; k < points_.size(); ++k) inherit(points_[k], old);
  }
}

void ContactSet::add(std::span<const ContactPoint> late) {
  for (ContactPoint point : late) {
    point.id = next_id_++;
    points_.push_back(point);
  }
  std::ranges::stable_sort(points_, [](const ContactPoint& x, const ContactPoint& y) {
    return before(x, y.body_a, y.body_b);
  });
}

}  // namespace ourengine
