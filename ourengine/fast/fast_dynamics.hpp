// The fast engine: small steps with soft contacts, coloured and solved eight manifolds at a time.
//
// Contacts are found once per step; the step is then cut into sub-steps, each with one biased
// sweep, a move, and one relaxing sweep with friction. Velocities inside a step are single
// precision, positions double. A body that no contact touches flies as in dynamics/dynamics.hpp.
//
// Source: E. Catto, Solver2D, 2024 (soft step); sub-steps after M. Macklin et al., Small Steps in
// Physics Simulation, SCA 2019. Deterministic: same bodies, options and calls give the same bits.
#pragma once

#include <span>
#include <vector>

#include "ourengine/dynamics/contact_set.hpp"
#include "ourengine/dynamics/model.hpp"
#include "ourengine/fast/soft_batch.hpp"

namespace ourengine {

struct FastOptions {
  double step_s = 1.0 / 240.0;
  int substeps = 4;
  Eigen::Vector3d gravity_mps2 = {0.0, 0.0, -9.81};
  double margin_m = 1e-3;  // as in DynamicsOptions
  // Stiffness of contacts: natural frequency, at most 1/8 of the sub-step rate, and damping ratio.
  double contact_hz = 1e9;
  double damping_ratio = 10.0;
  double push_limit_mps = 3.0;
  double resting_approach_mps = 0.1;  // slower approaches do not bounce
};

struct FastReport {
  int contacts = 0;
  int manifolds = 0;
  int colours = 0;
};

class FastDynamics {
 public:
  // (bodies) both. A fixed body has zero velocity and momentum.
  FastDynamics(std::vector<BodyModel> bodies, std::vector<Motion> motions, SurfaceLaws laws,
               FastOptions options);
  FastDynamics(const FastDynamics&) = delete;
  FastDynamics& operator=(const FastDynamics&) = delete;

  // (bodies): in effect during the next step only.
  void apply(std::span<const Load> loads);
  const FastReport& step();

  std::span<const Motion> motions() const { return motions_; }
  std::span<const BodyModel> bodies() const { return bodies_; }
  const FastOptions& options() const { return options_; }
  const SurfaceLaws& laws() const { return laws_; }
  // Contacts of the last step; impulses on body b over the whole step, world frame.
  std::span<const ContactPoint> contacts() const { return contacts_.points(); }
  const FastReport& report() const { return report_; }

  // (bodies) replaces all motions and forgets contact history.
  void set_motions(std::span<const Motion> motions);

 private:
  struct Slot {     // where a manifold went
    int first = 0;  // its points in contacts_
    int count = 0;
    int colour = 0;
    int batch = 0;  // index into batches_
    int lane = 0;
    std::array<int, k_soft_points> chosen{};  // points of contacts_ that are solved
    int solved = 0;
  };

  void find_contacts();
  // Velocity (m/s) of the body's material point at the contact.
  Eigen::Vector3d velocity_at(std::size_t body, const ContactPoint& point) const;
  void colour_manifolds();
  void fill(const Slot& slot);
  void warm_start();
  std::span<SoftBatch> colour(std::size_t index);
  void sweep(const SoftStep& step, bool biased, bool forwards);
  void run_substeps();
  void keep_impulses();
  void move_bodies();

  std::vector<BodyModel> bodies_;
  std::vector<Motion> motions_;
  SurfaceLaws laws_;
  FastOptions options_;
  std::vector<Load> loads_;
  ContactSet contacts_;
  std::vector<double> reach_m_;
  std::vector<Slot> slots_;
  std::vector<std::size_t> colour_begin_;  // colours + 1, into batches_
  std::vector<SoftBatch> batches_;
  std::vector<SoftVector> velocity_;  // (bodies + 1)
  std::vector<SoftVector> moved_;
  std::vector<SoftVector> contact_change_;  // velocity that the contacts gave in the last sub-step
  std::vector<SoftVector> free_change_;     // velocity that gravity and loads give per sub-step
  std::vector<Eigen::Matrix3d> inverse_inertia_;  // world axes; 0 if fixed
  std::vector<bool> touched_;
  bool bouncing_ = false;
  FastReport report_;
};

}  // namespace ourengine
