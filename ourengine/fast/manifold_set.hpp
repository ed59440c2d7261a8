// The contacts of the fast engine: manifolds that are kept, and only moved along, while the two
// bodies hardly move against each other.
//
// A manifold is made by separating axes and clipping, and its points are then fixed to both bodies.
// As long as the pose of b relative to a stays within k_recycle_share of the thinner body from the
// pose it was made in, only the gaps are computed anew, exactly for those points; what is
// approximated is where on the faces the points lie, by no more than that bound. Manifolds are
// made with a margin wider by more than that, so that no point is missed meanwhile. After
// E. Catto, Box3D (contact recycling, with a bound of 50 mm there).
//
// The set depends on history through this, not on how the broad phase found it: same calls, same
// bits, whatever the number of threads.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "ourengine/collision/collide.hpp"
#include "ourengine/fast/soft_batch.hpp"
#include "ourengine/model/body_model.hpp"
#include "ourengine/parallel/worker_pool.hpp"

namespace ourengine {

// What the set needs of a body in this step.
struct BodyPose {
  Eigen::Matrix3d axes;  // columns: body axes in the world
  double reach_m = 0.0;  // how far any point of the body can move in this step
};

struct SoftManifold {
  static constexpr std::size_t k_points = k_soft_points;
  int body_a = 0;  // body_a < body_b
  int body_b = 0;
  int count = 0;  // of points; 0: the bodies are apart by more than made_margin_m

  // World axes, of this step.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // from a to b
  Eigen::Vector3d centre_a_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d between_m = Eigen::Vector3d::Zero();  // centre of b minus centre of a
  std::array<Eigen::Vector3d, k_points> arm_a_m;        // from the centre of a to the point
  std::array<double, k_points> gap_m{};                 // < 0: overlap

  // As made.
  Eigen::Vector3d normal_in_a = Eigen::Vector3d::UnitZ();
  std::array<Eigen::Vector3d, k_points> on_a_m;  // on the surface of a, in the frame of a
  std::array<Eigen::Vector3d, k_points> on_b_m;
  Eigen::Vector3d b_in_a_m = Eigen::Vector3d::Zero();  // pose of b in the frame of a
  Eigen::Quaterniond b_in_a = Eigen::Quaterniond::Identity();
  double made_margin_m = 0.0;

  // Of the last sub-step, N s (N m s for the twist about the normal).
  std::array<float, k_points> impulse{};
  Eigen::Vector3f friction_impulse = Eigen::Vector3f::Zero();  // on b, world axes
  float twist_impulse = 0.0F;
  float load_n = 0.0F;  // size of the loads on both bodies in that step
};

// At most four of the manifold's points: the deepest, the furthest from it, then the points that
// add most area on either side. Returns how many.
int choose_points(const Manifold& manifold, std::array<int, SoftManifold::k_points>& chosen);

class ManifoldSet {
 public:
  // Of the thinner body: relative motion up to which a manifold is kept. As large as the bias of
  // edge axes, which is the accuracy of a manifold's shape to begin with.
  static constexpr double k_recycle_share = 1e-3;
  // Of the thinner body: a point that moved less than this over its body is the same point.
  static constexpr double k_same_point = 0.1;
  // Cosine between normals of the same manifold.
  static constexpr double k_same_normal = 0.9;

  ManifoldSet(std::span<const BodyModel> bodies, double margin_m);

  // (bodies) both, at the start of the step. Impulses of persisting points are carried over.
  void update(std::span<const Motion> motions, std::span<const BodyPose> poses, double step_s,
              WorkerPool& pool);

  // Sorted by pair; those with count 0 are remembered only to save work.
  std::span<const SoftManifold> manifolds() const { return manifolds_; }
  std::span<SoftManifold> manifolds() { return manifolds_; }

  // All that the next update() takes from the past.
  using History = std::vector<SoftManifold>;
  const History& history() const { return manifolds_; }
  void restore(const History& history);

  // Forgets all history: the next update() is as the first.
  void clear();

  // How many manifolds the last update() made by separating axes.
  int made() const { return made_; }

 private:
  struct Job {
    BodyPair pair;
    int old = -1;  // into manifolds_
  };

  void bound_bodies(std::span<const Motion> motions, std::span<const BodyPose> poses,
                    WorkerPool& pool);
  void list_jobs();
  bool may_recycle(const SoftManifold& old, std::span<const Motion> motions, double margin_m) const;
  SoftManifold make(const BodyPair& pair, std::span<const Motion> motions,
                    std::span<const BodyPose> poses, double step_s) const;

  std::span<const BodyModel> bodies_;
  double margin_m_;
  BroadPhase broad_phase_;
  std::vector<double> thickness_m_;
  std::vector<double> radius_m_;
  std::vector<Aabb> boxes_;
  std::vector<Job> jobs_;
  std::vector<SoftManifold> manifolds_;
  std::vector<SoftManifold> next_;
  int made_ = 0;
};

}  // namespace ourengine
