// The velocity-level engine: each step finds the contacts, states one contact problem, has it
// solved and moves the bodies.
//
//   v_free = v + T M^-1 (forces)
//   v+     = solution of the contact problem with gaps (contact/problem.hpp)
//   x+     = x + T v+                      for a body that feels a contact impulse,
//   x+     = x + T v+ - T^2 g / 2          if no fixed body holds its island: all of it falls,
//   x+     = x + T (v + v+) / 2            for a body in free flight: the exact parabola
//   q+     by the rotation scheme, with the spatial angular momentum L+ of the solution
//
// T is the step, but for an island that flies freely to a bounce: it flies there first
// (flight.hpp), and T is what is left of the step. With restitution e the contact then leaves with
// e times its approach, gravity acts on for the time T, and the energy is that of the bounce to
// rounding. No rebound makes energy (rebound.hpp).
//
// Where bodies turn or slide far within the step, the features that meet at its end are not those
// that faced each other at its start. Pairs that would then overlap get the contacts of the end as
// well, linearised about it, and the problem is solved again: sequential linearisation of the gap
// (M. Anitescu, G. D. Hart, A constraint-stabilized time-stepping approach for rigid multibody
// dynamics with joints, contact and friction, Int. J. Numer. Methods Eng. 60 (2004)).
//
// A step that this does not settle, or in which one body passed another (passage.hpp), is done
// again as two halves, these as quarters, down to 1/64 of the step; loads are held. What even those
// leave is told in the report.
//
// Source of the scheme: J. J. Moreau, Numerical aspects of the sweeping process, Comput. Methods
// Appl. Mech. Eng. 177 (1999); D. E. Stewart, J. C. Trinkle, An implicit time-stepping scheme for
// rigid body dynamics, Int. J. Numer. Methods Eng. 39 (1996). Departures: contacts are found before
// they close, gaps enter the law, free bodies fly exactly.
//
// Frames and units as in dynamics/model.hpp. Deterministic: same bodies, options and calls give the
// same bits.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "ourengine/contact/problem.hpp"
#include "ourengine/contact/solvers.hpp"
#include "ourengine/exact/contact_set.hpp"
#include "ourengine/exact/flight.hpp"
#include "ourengine/exact/rebound.hpp"
#include "ourengine/integration/rotation.hpp"
#include "ourengine/model/body_model.hpp"

namespace ourengine {

struct DynamicsOptions {
  double step_s = 1.0 / 240.0;
  Eigen::Vector3d gravity_mps2 = {0.0, 0.0, -9.81};
  RotationScheme rotation = RotationScheme::k_moser_veselov;
  Solver solver = nullptr;  // of contact/solvers.hpp
  SolveOptions solve;
  double margin_m = 1e-3;         // contacts further apart than this plus the approach are left out
  double overlap_recovery = 0.2;  // share of an overlap that is undone per step
  double recovery_limit_mps = 1.0;  // an overlap is never undone faster than this
  // An approach slower than this many dt |g| is no impact: restitution counts as 0.
  double resting_approach_steps = 2.0;
  bool frictionless = false;  // the paper's law: friction counts as 0
  int threads = 1;            // the caller's included; the result does not depend on them
};

// What the last step had to do.
struct StepReport {
  double residual = 0.0;  // of the contact law, relative (contact/residual.hpp)
  int contacts = 0;
  int iterations = 0;
  int factorisations = 0;
  int passes = 1;  // contact problems solved: more than 1 where impacts set bodies moving
  int parts = 1;   // into which the step was cut
  // Of what Newton's law asks for, the smallest share that made no energy (rebound.hpp).
  double rebound_share = 1.0;
  // Deepest new overlap (m) that the smallest parts still left; 0 if below tolerance.
  double overlap_left_m = 0.0;
  // The smallest parts did not settle: contacts may be missing from the step.
  bool ran_out = false;
  SolveStatus status = SolveStatus::kSolved;
  std::string method;
};

class Dynamics {
 public:
  // (bodies) both. A fixed body has zero velocity and momentum.
  Dynamics(std::vector<BodyModel> bodies, std::vector<Motion> motions, SurfaceLaws laws,
           DynamicsOptions options);
  Dynamics(const Dynamics&) = delete;
  Dynamics& operator=(const Dynamics&) = delete;

  // (bodies): in effect during the next step only.
  void apply(std::span<const Load> loads);
  const StepReport& step();

  std::span<const Motion> motions() const { return motions_; }
  std::span<const BodyModel> bodies() const { return bodies_; }
  const DynamicsOptions& options() const { return options_; }
  const SurfaceLaws& laws() const { return laws_; }
  // Contacts of the last step, of all its parts; impulses on body b in the world frame. Positions
  // are those at the start of the part.
  std::span<const ContactPoint> contacts() const { return told_; }
  // The last contact problem, as a value that can be solved again by any solver.
  const ContactProblem& problem() const { return problem_; }
  const StepReport& report() const { return report_; }

  // (bodies) replaces all motions and forgets contact history: the future depends on these alone.
  void set_motions(std::span<const Motion> motions);

  // The state between two steps: from a restored one the future is the same, bit for bit.
  struct Snapshot {
    std::vector<Motion> motions;
    ContactSet::History contacts;
  };
  Snapshot snapshot() const { return {motions_, contacts_.history()}; }
  // The snapshot must be of a Dynamics with the same bodies, laws and options.
  void restore(const Snapshot& snapshot);

 private:
  enum class Attempt { settled, unsettled, out_of_time };

  void advance(double span_s, int level);
  Attempt attempt(double span_s, bool timed);
  void accept(bool settled);
  void expect_reach();
  void find_contacts();
  bool fly_to_bounces();
  bool times_agree() const;
  void state_problem();
  void state_bodies();
  void state_contacts();
  void state_gap(std::size_t contact);
  bool falls(const Island& island) const;
  bool is_held(const Island& island) const;
  double bounce_time_s(const Island& island) const;
  Touch touch_of(std::size_t contact) const;
  bool bounces(std::size_t contact, const Touch& touch) const;
  double rebound_mps(std::size_t contact) const;
  void find_first_touches();
  double left_s(std::size_t body) const { return span_s_ - flight_s_[body]; }
  double lag_mps2(std::size_t contact) const;
  double undone_share() const { return options_.overlap_recovery * span_s_ / options_.step_s; }
  double resting_mps() const;
  WarmStart warm_start() const;
  bool state_and_solve();
  void solve();
  bool widen_reach();
  bool look_ahead();
  void look_at(const BodyPair& pair);
  bool passed() const;
  bool flew_too_far() const;
  double look_tolerance_m(std::size_t a, std::size_t b) const;
  std::vector<Motion> ends() const;
  Eigen::Matrix3d world_inertia(std::size_t body) const;

  std::vector<BodyModel> bodies_;
  std::vector<Motion> motions_;
  SurfaceLaws laws_;
  DynamicsOptions options_;
  std::vector<Load> loads_;
  ContactSet contacts_;
  std::vector<ContactPoint> told_;
  double span_s_ = 0.0;         // of the part of the step that is tried
  std::vector<Motion> starts_;  // where contacts begin to act: after flight_s_ of free flight
  std::vector<double> flight_s_;
  std::vector<char> falls_;  // its island is held by no fixed body
  std::vector<char> held_;   // it is, as an earlier solution of this part has shown
  std::vector<double> reach_m_;
  std::vector<double> moved_m_;  // how far any point of the body moves from starts_ to ends_
  ContactProblem problem_;
  std::vector<Island> islands_;
  std::vector<BodyStep> body_steps_;
  ContactSolution solution_;
  std::vector<Motion> ends_;  // where the last solution brings the bodies
  std::vector<ContactPoint> late_;
  double deepest_late_m_ = 0.0;
  std::vector<double> first_touch_s_;  // of the pair of each of problem_.contacts
  std::vector<char> bounces_;  // of problem_.contacts: a rebound of falling bodies is stated
  bool may_bounce_;
  std::shared_ptr<WorkerPool> workers_;
  std::unique_ptr<SolverMemory> memory_;
  StepReport report_;
};

}  // namespace ourengine
