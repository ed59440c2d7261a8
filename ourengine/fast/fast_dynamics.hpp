// The fast engine: small steps with soft contacts, coloured and solved sixteen manifolds at a time.
//
// Contacts are found once per step; the step is then cut into sub-steps, each with one biased
// sweep, a move, and one relaxing sweep with friction. Velocities inside a step are single
// precision, positions double. A body that no contact touches flies as in dynamics/dynamics.hpp.
//
// Source: E. Catto, Solver2D, 2024 (soft step); sub-steps after M. Macklin et al., Small Steps in
// Physics Simulation, SCA 2019. Deterministic: same bodies, options and calls give the same bits.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ourengine/fast/manifold_set.hpp"
#include "ourengine/fast/rebound.hpp"
#include "ourengine/fast/soft_batch.hpp"
#include "ourengine/model/body_model.hpp"
#include "ourengine/parallel/worker_pool.hpp"

namespace ourengine {

struct FastOptions {
  double step_s = 1.0 / 240.0;
  int substeps = 20;
  Eigen::Vector3d gravity_mps2 = {0.0, 0.0, -9.81};
  double margin_m = 5e-4;  // as in DynamicsOptions
  // Stiffness of contacts: natural frequency, at most one radian per sub-step, and damping ratio.
  double contact_hz = 1e9;
  double damping_ratio = 5.0;
  double push_limit_mps = 3.0;
  double resting_approach_mps = 0.1;  // slower approaches do not bounce
  int threads = 1;                    // changes the time of a step, never its bits
};

struct FastReport {
  int contacts = 0;
  int manifolds = 0;
  int colours = 0;
  int remade = 0;  // manifolds that separating axes had to make anew
  int passes = 0;  // trials of the step: more than 1 where impacts met with contacts unknown before
  int parts = 0;   // that the step was cut into; the four numbers above are of the last one
  // Deepest overlap (m) at the step's end that is new and that the last trial still left, or old
  // and deeper than k_told_share, or on the way, where bodies pass; 0 if below tolerance.
  double overlap_left_m = 0.0;
  // Deepest overlap (m) of a contact point when the step ended, new or old, as the sweeps count it.
  double deepest_m = 0.0;
  // The last sweep over the laws of impact changed a velocity by this much still, m/s.
  double rebound_left_mps = 0.0;
  // ... which is more than is tolerated (rebound.hpp), or a contact that nothing struck throws its
  // bodies apart.
  bool unsolved = false;
  // Kinetic energy (J) taken from groups of touching bodies that would have had more than before.
  double energy_taken_j = 0.0;
  // The limits stopped the smallest part of the step: contacts may be missing, or the sweeps made
  // were too few.
  bool ran_out = false;
};

// Constants of the scheme that are not options.
struct FastLimits {
  // Of the margin, or of ManifoldSet::k_same_point of the thinner body if that is less: overlaps at
  // the end of a step that its contacts did not see count from here on.
  static constexpr double k_look_tolerance = 0.5;
  // Of the thinner body: an overlap that is deeper counts as left over, old or new.
  static constexpr double k_told_share = 0.05;
  // A step is tried again with what its end shows to be missing, so often, and with so many sweeps
  // per sub-step at most.
  static constexpr int k_trials = 8;
  static constexpr int k_sweeps = 8;
  // A touched body may turn so far in a step: its contacts are linear in the turn.
  static constexpr double k_turn_rad = 0.5;
  // Up to here the turn of a touched body is taken to second order: off by less than 1e-9 rad.
  static constexpr double k_small_turn_rad = 1e-3;
  // More energy than was there, that slowing the contacts cannot take away, is no more than this
  // share.
  static constexpr double k_energy_share = 1e-6;
  // Of the loads that carried impulses held: where less is left, the impulses are forgotten.
  static constexpr float k_load_left = 0.5F;
  // What is not settled then is cut in halves with as many sub-steps each, so often.
  static constexpr int k_cuts = 5;
};

struct SoftContact {
  int body_a = 0;
  int body_b = 0;
  Eigen::Vector3d position_m;
  Eigen::Vector3d normal;  // from a to b
  double gap_m;
  Eigen::Vector3d impulse_ns;  // on b, over the whole step, world frame
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
  // Contacts that the last step solved, in the order of the pairs; gaps at its start.
  std::vector<SoftContact> contacts() const;
  const FastReport& report() const { return report_; }

  // (bodies) replaces all motions and forgets contact history.
  void set_motions(std::span<const Motion> motions);

  // Everything that the future depends on, loads aside: an engine of the same bodies and options
  // that is given it continues with the same bits.
  struct Snapshot {
    std::vector<Motion> motions;
    ManifoldSet::History contacts;
  };
  Snapshot snapshot() const { return {motions_, contacts_.history()}; }
  void restore(const Snapshot& snapshot);

 private:
  enum class Look { settled, again, stuck };
  struct Energy {  // at the end of the step
    double allowed_j = 0.0;
    double kinetic_j = 0.0;
  };
  struct Slot {  // where a manifold is solved
    int manifold = 0;
    int colour = 0;
    int batch = 0;  // index into batches_
    int lane = 0;
    bool pushed = false;     // during the trial
    float deepest_m = 0.0F;  // overlap of its points where the trial ends
  };

  struct SlotImpulses {  // of the whole step, on b
    std::array<double, k_soft_points> normal_ns{};
    Eigen::Vector3d friction_ns = Eigen::Vector3d::Zero();
    double twist_nms = 0.0;
  };
  enum class Law : char { none, plastic, bounce };  // that an island was held to

  void pose_bodies();
  void find_contacts();
  bool hand_on_reach();
  void advance(double step_s, int cuts);
  bool settle(bool may_cut);
  bool close();
  void accept();
  bool turns_far() const;
  void colour_manifolds();
  SoftManifold& solved_manifold(std::size_t index);
  const SoftManifold& solved_manifold(std::size_t index) const;
  bool is_near(const SoftManifold& manifold) const;
  void place_slots(std::span<const int> sizes);
  void fill_batches();
  void fill(SoftBatch& batch, std::size_t lane, const SoftManifold& manifold);
  Eigen::Vector3d velocity_at(std::size_t body, const Eigen::Vector3d& arm_m) const;
  void warm_start();
  std::span<SoftBatch> colour(std::size_t index);
  void drop_blows();
  void sweep(const SoftStep& step, bool biased, bool forwards);
  SoftStep soft_step() const;
  void run_substeps();
  void try_step();
  void mark_touched();
  void keep_impulses();
  float load_n(const SoftManifold& manifold) const;
  void forget_ended_loads();
  void find_ends();
  Motion end_of(std::size_t body) const;
  Eigen::Quaterniond turned_freely(std::size_t body, const Eigen::Vector3d& turn_rad) const;
  Eigen::Vector3d momentum_of(std::size_t body, const Eigen::Vector3d& spin_radps) const;
  bool find_far();
  Look look_ahead();
  bool is_quiet() const;
  void join_islands();
  int island_of(int body);
  SlotImpulses impulses_of(const Slot& slot) const;
  static Eigen::Vector3d middle_of(const SoftManifold& manifold);
  void sum_impulses();
  void rebound();
  void move_on();
  void move_back_what_meets(std::span<const SoftVector> trial);
  double fastest_approach_mps(const Slot& slot) const;
  std::size_t root_of(const Slot& slot) const;
  Settling settle_rows(std::span<const Slot* const> slots, double fastest_mps, bool bounce);
  ReboundRow rebound_row(const Slot& slot) const;
  Twist twist_of(std::size_t body) const;
  Twist twist_at_end(int body) const;
  bool throws(const Slot& slot) const;
  double passage_of_m(const SoftManifold& manifold) const;
  void set_twist(std::size_t body, const Twist& twist);
  void take_rebound(const Slot& slot, const ReboundRow& row);
  double kinetic_j(std::size_t body) const;
  std::vector<Energy> island_energies() const;
  bool limit_energies();
  static double share_within(double first_j, double middle_j, double last_j, double allowed_j);
  void bounce_less(std::span<const char> islands, std::span<Energy> energy);
  void blend_impulses(const Slot& slot, const SlotImpulses& given, double share);
  double limit_island(std::span<const int> bodies, double allowed_j);
  std::vector<SoftContact> contacts_of_part() const;
  static double opened_m(const SoftManifold& manifold, std::size_t point,
                         std::span<const SoftVector> moved);
  double look_tolerance_m(int body_a, int body_b) const;
  void look_around_far();
  void look_at(const BodyPair& pair, double seen_m);
  SoftManifold late_manifold(const BodyPair& pair, const Manifold& end) const;

  std::vector<BodyModel> bodies_;
  std::vector<Motion> motions_;
  SurfaceLaws laws_;
  FastOptions options_;
  WorkerPool pool_;
  std::vector<Load> loads_;
  ManifoldSet contacts_;
  std::vector<SoftManifold> late_;  // of this step alone, after those of the set
  std::vector<Motion> ends_;        // where the last trial brings the bodies
  std::vector<int> far_;            // bodies that went beyond the reach that the search assumed
  std::vector<Aabb> end_boxes_;
  int sweeps_ = 1;               // of either kind, per sub-step
  double step_s_ = 0.0;          // of the part that is under way
  float impulse_share_ = 1.0F;   // its sub-step over that of an uncut step
  double after_blow_s_ = 0.0;    // from the last blow of the trial to its end
  double overlap_left_m_ = 0.0;  // by its last trial
  double energy_taken_j_ = 0.0;
  double rebound_left_mps_ = 0.0;
  bool unsolved_ = false;
  double deepest_m_ = 0.0;
  std::vector<SoftContact> cut_contacts_;  // of all parts, where the step was cut
  std::vector<int> island_;                // parent of a body in the tree of its island
  std::vector<char> grounded_;             // (bodies) by root: something fixed is in the island
  std::vector<Law> laws_held_;             // (bodies) by root
  std::vector<BodyPose> poses_;
  std::vector<double> radius_m_;
  std::vector<Eigen::Vector3d> spin_radps_;
  std::vector<SoftInertia> inertia_;  // (bodies + 1)
  std::vector<Slot> slots_;
  std::vector<int> lane_slot_;             // slot of every lane of every batch, -1: empty
  std::vector<std::uint64_t> used_;        // colours that a body has already
  std::vector<std::size_t> colour_begin_;  // colours + 1, into batches_
  std::vector<SoftBatch> batches_;
  std::vector<SoftVector> velocity_;  // (bodies + 1)
  std::vector<SoftVector> moved_;
  std::vector<SoftVector> contact_change_;  // velocity that the carried impulses give
  std::vector<SoftVector> free_change_;     // velocity that gravity and loads give per sub-step
  std::vector<SoftVector> free_velocity_;   // of the sub-step, before its contacts act
  std::vector<char> touched_;
  FastReport report_;
};

}  // namespace ourengine
