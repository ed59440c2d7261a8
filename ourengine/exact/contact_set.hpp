// The contacts of a step: which points of which bodies, how far apart, and which of them were there
// a step ago.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "ourengine/collision/collide.hpp"
#include "ourengine/model/body_model.hpp"
#include "ourengine/parallel/worker_pool.hpp"

namespace ourengine {

struct ContactPoint {
  int body_a = 0;  // body_a < body_b
  int body_b = 0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();     // from a to b
  double gap_m = 0.0;                                    // < 0: overlap
  Eigen::Vector3d impulse_ns = Eigen::Vector3d::Zero();  // on b, world frame: of the last solve
  Eigen::Vector3d anchor_m = Eigen::Vector3d::Zero();    // in the frame of b: recognises the point
  std::uint64_t id = 0;                                  // kept while the point persists
};

// Finds contacts with gaps and keeps their names and impulses from step to step. The order of the
// points is that of the pairs, then of the manifold: the same for the same states.
class ContactSet {
 public:
  // margin_m: points further apart than this, plus what the bodies can approach in a step, are left
  // out.
  ContactSet(std::span<const BodyModel> bodies, double margin_m);

  // (bodies) motions at the start of the step; reach_m: (bodies) how far any point of the body can
  // move in this step. Impulses of persisting points are carried over.
  // workers: share the work, and change no bit of the result.
  void update(std::span<const Motion> motions, std::span<const double> reach_m, double step_s,
              WorkerPool& workers);

  // Adds points that only show where the bodies get to; points() stays in the order of the pairs.
  void add(std::span<const ContactPoint> late);
  // Finds the pairs for another reach; points() stays.
  void find_pairs(std::span<const Motion> motions, std::span<const double> reach_m);
  // Pairs that may have come close within the reach of the last update() or find_pairs().
  std::span<const BodyPair> pairs() const { return broad_phase_.pairs(); }

  std::span<const ContactPoint> points() const { return points_; }
  std::span<ContactPoint> points() { return points_; }

  // Forgets all history: the next update() is as the first.
  void clear();

  // All that the next update() takes from the past.
  struct History {
    std::vector<ContactPoint> points;
    std::uint64_t next_id = 1;
  };
  History history() const { return {points_, next_id_}; }
  void restore(const History& history);

 private:
  void add_manifold(int a, int b, const Manifold& manifold, std::span<const Motion> motions);
  void inherit(ContactPoint& point, std::size_t first_of_pair);

  std::span<const BodyModel> bodies_;
  double margin_m_;
  BroadPhase broad_phase_;
  std::vector<double> thickness_m_;  // smallest edge or diameter per body
  std::vector<Aabb> boxes_;
  std::vector<Manifold> manifolds_;  // of the pairs
  std::vector<ContactPoint> points_;
  std::vector<ContactPoint> previous_;
  std::vector<bool> inherited_;
  std::uint64_t next_id_ = 1;
};

}  // namespace ourengine
