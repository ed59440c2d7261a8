// The simulator of the paper: rigid bodies, separating axes, colliding and resting contact.
//
// Source: H. Darji, P. Alur, Explosion Simulator; D. Baraff, Rigid Body Simulation I and II; D.
// Baraff, Fast contact force computation for nonpenetrating rigid bodies, SIGGRAPH 1994.
// Frictionless. What the paper leaves open are the Options; paper_options() has its plain choices.
// World frame, SI. Deterministic: same bodies, options and calls give the same bits.
#pragma once

#include <span>
#include <vector>

#include "ourengine/baraff/colliding_contact.hpp"
#include "ourengine/baraff/collision.hpp"
#include "ourengine/baraff/resting_contact.hpp"

namespace ourengine::baraff {

// How bodies move through a step under its forces, which are held:
//  * forward_euler: the paper; positions and attitudes advance with the velocities of the start.
//  * constant_force: with those of the middle, see integration/constant_force.hpp.
enum class Motion { forward_euler, constant_force };

struct Options {
  double step_s = 0.001;
  Eigen::Vector3d gravity_mps2 = {0.0, 0.0, -9.81};
  double contact_tolerance_m = 1e-6;     // a larger gap is no contact
  double collision_velocity_mps = 1e-3;  // slower approach is resting contact
  int max_collision_sweeps = 20000;
  // Hits of all points of a pair, and of all contacts without restitution, at once, see
  // joint_collision.hpp. False: one after the other (the paper).
  bool hits_at_once = true;
  // Share of a resting contact's normal velocity v that its force must undo in one step: b gains
  // share v / h. 0: accelerations alone (the paper); 1: no resting contact is left approaching.
  double velocity_share = 1.0;
  Motion motion = Motion::constant_force;
  // Share of each overlap beyond overlap_slop_m that is undone per step by moving the bodies apart,
  // momenta untouched: of the overlap that the step's motion would leave. Contacts are looked for
  // once per step, impulses and forces act where the bodies touch, the moves come last: none is
  // lost in between. 0: overlaps stay (the paper).
  double overlap_share = 1.0;
  // A contact that separates parts by its own velocity and is not moved apart, which would lift it
  // for nothing; unless it was met slower than this many steps of gravity: such hits follow each
  // other in every step.
  double slow_hit_steps = 2.0;
  double overlap_slop_m = 1e-7;
  // A step is cut where a pair could get deeper than this share of its thinner body, see
  // safe_step.hpp; into k_most_pieces at most. 0: never (the paper).
  double depth_share = 0.25;
  // Baraff, Rigid Body Simulation II, section 7: a step that would overlap is cut at the time of
  // contact, found by bisection to contact_tolerance_m; at most this many cuts per step. 0: none.
  int max_bisections = 0;
};

// Pieces of a step are not shorter than this share of it.
inline constexpr int k_most_pieces = 1000;

Options paper_options();

// Force at and torque about the centre of mass.
struct Load {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_nm = Eigen::Vector3d::Zero();
};

// What the last step had to do; worst over its pieces where it was cut.
struct StepReport {
  int contacts = 0;
  int resting_contacts = 0;
  int colliding_iterations = 0;           // sweeps
  bool collisions_unfinished = false;     // max_collision_sweeps did not suffice
  double complementarity_residual = 0.0;  // of the resting contacts, relative
  double overlap_residual = 0.0;          // the same, of the moves apart
  int pivots = 0;
  int zero_steps = 0;
  int retried = 0;  // solves that needed the regularised matrix, see qp_solve.hpp
  int bisections = 0;
  int pieces = 0;         // that the step was cut into
  bool hasty = false;     // some piece should have been shorter than k_most_pieces allows
  int overlaps_left = 0;  // overlap solves that failed: nothing was moved apart
  bool failed = false;    // a resting solve failed; its forces were not applied
  bool unsolved = false;  // any of collisions_unfinished, overlaps_left, hasty and failed
  // Change of kinetic plus potential energy (J, gravity alone) in the three parts of the step.
  double collision_energy_j = 0.0;  // impulses; not above 0 for restitutions up to 1
  double overlap_energy_j = 0.0;    // moving overlaps apart, momenta held
  double motion_energy_j = 0.0;     // motion under gravity, resting forces and loads
};

class Simulator {
 public:
  // restitution: (surfaces, surfaces), see RestitutionTable.
  Simulator(std::vector<RigidBody> bodies, RestitutionTable restitution, Options options);

  // (bodies): held during the next step, then forgotten.
  void apply(std::span<const Load> loads);
  const StepReport& step();

  std::span<const RigidBody> bodies() const { return bodies_; }
  std::span<const Collision> contacts() const { return contacts_; }  // of the last step
  const StepReport& report() const { return report_; }
  const Options& options() const { return options_; }
  const RestitutionTable& restitution() const { return restitution_; }
  // (bodies): replaces all states; nothing else is remembered between steps.
  void set_bodies(std::span<const RigidBody> bodies);

 private:
  int collide();
  void accumulate_forces();
  double rest(double step_s);
  void separate_overlaps(double step_s);
  void count(const QpResult& solved);
  void resting_contact(double step_s);
  double move(double step_s);
  void integrate(double step_s);
  Eigen::VectorXd gaps_after(double step_s) const;
  bool parts_by_itself(const Collision& contact) const;
  double deepest_gap();
  double energy() const;

  std::vector<RigidBody> bodies_;
  RestitutionTable restitution_;
  Options options_;
  std::vector<Load> loads_;
  std::vector<Collision> collisions_;  // of the current piece
  std::vector<Collision> contacts_;    // of all pieces of the step
  StepReport report_;
};

}  // namespace ourengine::baraff
