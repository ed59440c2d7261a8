// The velocity-level engine: each step finds the contacts, states one contact problem, has it
// solved and moves the bodies.
//
//   v_free = v + dt M^-1 (forces)
//   v+     = solution of the contact problem with gaps (contact/problem.hpp)
//   x+     = x + dt v+                      for a body that feels a contact impulse,
//   x+     = x + dt (v + v+) / 2            for a body in free flight: the exact parabola
//   q+     by the rotation scheme, with the spatial angular momentum L+ of the solution
//
// Where bodies turn or slide far within the step, the features that meet at its end are not those
// that faced each other at its start. Pairs that would then overlap get the contacts of the end as
// well, linearised about it, and the problem is solved again: sequential linearisation of the gap
// (M. Anitescu, G. D. Hart, A constraint-stabilized time-stepping approach for rigid multibody
// dynamics with joints, contact and friction, Int. J. Numer. Methods Eng. 60 (2004)).
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
#include "ourengine/dynamics/contact_set.hpp"
#include "ourengine/dynamics/model.hpp"
#include "ourengine/integration/rotation.hpp"

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
  // Deepest new overlap (m) at the step's end that the last pass still left; 0 if below tolerance.
  double overlap_left_m = 0.0;
  // The limit of passes stopped the search for contacts: some may be missing from the step.
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
  // Contacts of the last step; impulses on body b in the world frame.
  std::span<const ContactPoint> contacts() const { return contacts_.points(); }
  // The last step's contact problem, as a value that can be solved again by any solver.
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
  void expect_reach();
  void state_problem();
  WarmStart warm_start() const;
  void solve();
  bool widen_reach();
  bool look_ahead();
  std::vector<Motion> ends() const;
  Eigen::Matrix3d world_inertia(std::size_t body) const;

  std::vector<BodyModel> bodies_;
  std::vector<Motion> motions_;
  SurfaceLaws laws_;
  DynamicsOptions options_;
  std::vector<Load> loads_;
  ContactSet contacts_;
  std::vector<double> reach_m_;
  ContactProblem problem_;
  ContactSolution solution_;
  std::vector<Motion> ends_;  // where the last solution brings the bodies
  std::vector<ContactPoint> late_;
  std::shared_ptr<WorkerPool> workers_;
  std::unique_ptr<SolverMemory> memory_;
  StepReport report_;
};

}  // namespace ourengine
