// Broad phase: which pairs of bodies are close enough to look at.
//
// Each body keeps a fat axis-aligned box, larger than its true one by a slack; pairs of fat boxes
// are found once and stay valid while every body is inside its fat box, which for a standing wall
// is for ever. A body that leaves is looked up anew; when many leave, a uniform grid rebuilds
// everything.
//
// The *set* of pairs depends on history (how fat a box happens to be), its order never does: pairs
// come sorted by (first, second), and a pair whose true boxes are apart yields no manifold.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace ourengine {

// Axis-aligned bounding box, world frame, metres; infinite corners for a half space.
struct Aabb {
  Eigen::Vector3d lower_m;
  Eigen::Vector3d upper_m;

  bool overlaps(const Aabb& other) const {
    return (lower_m.array() <= other.upper_m.array()).all() &&
           (other.lower_m.array() <= upper_m.array()).all();
  }
  bool contains(const Aabb& other) const {
    return (lower_m.array() <= other.lower_m.array()).all() &&
           (other.upper_m.array() <= upper_m.array()).all();
  }
};

struct BodyPair {
  int first = 0;  // first < second
  int second = 0;
  auto operator<=>(const BodyPair&) const = default;
};

class BroadPhase {
 public:
  // fixed[i]: body i never moves; two fixed bodies make no pair. slack_m > 0: how much fatter.
  BroadPhase(std::vector<bool> fixed, double slack_m);

  // boxes: (bodies), each already enlarged by its contact margin. Afterwards pairs() holds at least
  // every pair whose boxes overlap.
  void update(std::span<const Aabb> boxes);

  std::span<const BodyPair> pairs() const { return pairs_; }

  // Forgets everything, as after construction.
  void clear();

 private:
  void rebuild();
  void replace(std::span<const int> escaped);
  bool is_pair(int i, int j) const;

  std::vector<bool> fixed_;
  double slack_m_;
  std::vector<Aabb> fat_;
  std::vector<BodyPair> pairs_;
};

}  // namespace ourengine
