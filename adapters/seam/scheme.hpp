// Scheme: how an engine says it advances one step, as data. An adapter publishes what its engine's
// documentation and source state; experiments/exact/ derives from it what the engine must yield to
// the last digits. Nothing in here is measured.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <variant>

namespace brickbench {

// How the position follows the velocity over one step h under an acceleration a held constant.
enum class PositionRule {
  old_velocity,        // explicit Euler: x += h v, v += h a; attitudes turn with the old spin too
  new_velocity,        // semi-implicit (symplectic) Euler: v += h a, x += h v
  mean_velocity,       // exact for constant a: x += h v + h^2/2 a
  middle_momentum,     // mean_velocity; attitudes turn with the mean of old and new momentum too
  mean_unless_pushed,  // mean_velocity in steps without contact impulse, else new_velocity
  runge_kutta_4,       // classical: four stages of velocity and acceleration, also in contact
};

// How the gyroscopic torque -w x I w enters the angular velocity.
enum class GyroscopicRule {
  neglected,
  explicit_body,    // I w+ = I w - h w x I w
  newton_body,      // one Newton step on I (w+ - w) + h w+ x I w+ = 0 in the body frame
  frozen_momentum,  // I w+ = I w - h w+ x I w, with I of the step's start
  runge_kutta_4,    // classical Runge-Kutta on Euler's equations in the body frame
  // L+ = L + h torque in the world frame, w+ = I(q+)^-1 L+; contacts act on I(q)^-1 L+.
  spatial_momentum,
};

// How the orientation follows the angular velocity.
enum class AttitudeRule {
  exponential,       // q+ = exp(h w+) q
  normalised_euler,  // q+ = q + h/2 (0, w+) q, scaled to length 1
  // Discrete Moser-Veselov with the moments of Hairer and Vilmart (J. Phys. A 39, 2006, order
  // four), turned by the spatial momentum L+; larger steps than Scheme::cut_turn_rad are cut into
  // equal parts.
  moser_veselov,
};

// How separating axes and clipped faces find where two boxes touch.
struct BoxPlaces {
  double axis_bias = 0.0;     // of the thinnest edge: by so much a later axis must exceed the first
  double parallel = 0.0;      // |a x b|^2 of edges whose cross product is no axis
  double border_share = 0.0;  // of the thinnest edge: what is less far outside a face is inside
};

// Contact as an impulse on the velocity: for a normal gap g_n and normal velocity v (positive when
// separating), the impulse, never negative, makes the velocity after the step at least the target.
struct ImpulseContact {
  double margin_m = 0.0;  // a contact exists where gap <= margin at the start of the step
  // Where collision detection looks less far than that: between a plane and a body up to this share
  // of half the diagonal of the body's bounding box, one corner at a time; else at touch alone.
  double plane_reach_share = std::numeric_limits<double>::infinity();
  // Of a box, of which a plane keeps so many in mind.
  std::size_t most_corners = std::numeric_limits<std::size_t>::max();
  bool approach_allowed = false;  // an open gap lowers the target by gap / h
  // A gap that closes within the step bounces already, at the larger of rebound and approach.
  // Bodies that no fixed one holds fly freely to their first bounce: contacts act from there on.
  bool bounces_before_touch = false;
  double restitution_threshold_mps = 0.0;    // no restitution for slower approach
  double restitution_threshold_steps = 0.0;  // nor for slower than this many steps of gravity
  bool sum_of_targets = false;   // restitution and correction are added; else the larger counts
  double error_reduction = 0.0;  // correction velocity: this fraction of the depth per step
  double max_correction_mps = std::numeric_limits<double>::infinity();
  // Where gap <= this, the correction moves the position alone (split impulse).
  double split_at_gap_m = -std::numeric_limits<double>::infinity();
  double split_turn_share = 0.0;  // of the turn that belongs to that correction
  double softness_per_kgs =
      0.0;  // "constraint force mixing": adds softness / h to 1/mass per point
  // Dantzig's algorithm row by row that gives up at a pivot of length zero; else all contacts of a
  // step meet their targets at once, whatever their order.
  bool gives_up_at_zero_pivot = false;
};

// Contact as a regularised constraint on the acceleration (Todorov 2014): along the normal,
// a = (1 - d) a_free + d (-b v - k d r), where d(r) is the impedance and r the gap.
struct CompliantContact {
  double time_constant_s = 0.02;
  double damping_ratio = 1.0;
  bool time_constant_at_least_two_steps = true;
  double impedance_start = 0.9;
  double impedance_end = 0.95;
  double impedance_width_m = 0.001;
  double impedance_midpoint = 0.5;
  double impedance_power = 2.0;
  double least_impedance = 0.0;  // start and end are clamped to these
  double most_impedance = 1.0;
  double box_gap_share = 1.0;  // the gap between two boxes counts this much
};

// Contact as a damped spring within sub-steps, in single precision (Catto 2024): the step is cut
// into equal parts; in each, impulses carried over act first, then each contact is served once with
// a push against its overlap before the bodies move, and once without it after. Impulses last from
// sub-step to sub-step and from step to step. In a step in which something approaches faster than
// resting_approach_mps, they do so up to twice what the sub-step began with and the weight of both
// bodies with what pulls on them, friction in proportion; a sub-step in which the first sweep finds
// more makes most_sweeps of either kind. The sums of all impulses then give the velocities at the
// step's end, in double precision. On islands of bodies that pushed each other, where something was
// struck, Newton's and Coulomb's laws hold for all contacts that pushed at once (Moreau 1988):
// struck points leave with at least their share of the approach at the step's start, the others do
// not approach, what leaves faster has no impulse, and friction on a manifold's middle stops what
// slides or is as large as it may be. A manifold that bounced keeps no impulses. From the last blow
// on such bodies go on with the velocities at the end, unless that brings one of the island deeper
// into another (gaps count as linear in the motion: not where a point strays further from its
// tangent than too_deep_share says), or lifts an island that something fixed is in though nothing
// bounces. A body that
// was pushed turns as in free flight from its mean spin. An island with more kinetic energy than it
// had and gravity and loads added gives up bounce: its contacts are solved without any as well, and
// as much of the first answer is taken as the energy allows; if that is not enough and nothing is
// fixed in the island, its motion against itself shrinks by one factor. Neither laws nor limit are
// looked at where no pushed body is, or was, faster than gravity makes it in a sub-step. A body
// that no contact pushed during the step flies freely instead.
struct SoftContact {
  int substeps = 1;
  double frequency_hz = 0.0;  // of the spring; at most one radian per sub-step
  double damping_ratio = 0.0;
  double push_limit_mps = std::numeric_limits<double>::infinity();
  double margin_m = 0.0;              // a contact is stated where gap <= margin + reach in the step
  double resting_approach_mps = 0.0;  // slower approaches do not bounce
  // A contact's points stay fixed to both bodies until these have moved against each other by this
  // share of the thinner one; then it is found anew, with its old impulse if the point is the same.
  double keep_share = 0.0;
  double same_point_share = 0.0;  // of the thinner body
  double same_normal = -1.0;      // cosine between the normals of a manifold that goes on
  BoxPlaces boxes;
  // A step is done again with twice the sweeps per sub-step where known contacts end deeper than
  // they were by more than this share of the margin, or of same_point_share of the thinner body if
  // that is less; so often at most, with so many at most.
  double too_deep_share = 0.0;
  int most_trials = 1;
  int most_sweeps = 1;
  // The laws of impact are solved by sweeps over the manifolds, until none changes a velocity by
  // more than rebound_share of the fastest approach, of what gravity gives in a step, or of the
  // first sweep's largest change; after so many sweeps by more than rebound_tolerated; so often at
  // most. From plain_sweeps on, every second one is extrapolated (Nesterov), anew where its change
  // is more than restart_growth of the one before. The normals of one manifold by themselves: until
  // none changes by more than row_share of that or round_share of the first round's change.
  double rebound_share = 0.0;
  int plain_sweeps = 0;
  double restart_growth = 0.0;
  int rebound_sweeps = 0;
  double rebound_tolerated = 0.0;
  int most_rebound_sweeps = 0;
  int row_rounds = 0;
  double row_share = 0.0;
  double round_share = 0.0;
  double small_turn_rad = 0.0;  // in a step: taken to second order
  // A step is cut in halves where a pushed body turns further than this, where sweeps do not
  // settle, or where more than this share of the energy cannot be taken.
  double turn_limit_rad = std::numeric_limits<double>::infinity();
  double energy_share = 0.0;
};

// Contact in two stages, at the pose of the step's start: points that approach fast are hit one
// after the other, in the order of the list, sweep after sweep until none does, with Newton's
// restitution, or in groups that are hit at once; those that do not separate then get the forces
// that keep all gaps from closing, at the level of accelerations. Frictionless. D. Baraff, Rigid
// Body Simulation II, sections 7 to 9.
struct SequentialContact {
  // A pair touches where its least gap <= margin, in all points open by at most a margin more.
  double margin_m = 0.0;
  double border_share = 0.0;            // of the thinnest half extent: closer to a border is on it
  double collision_velocity_mps = 0.0;  // a slower approach is resting contact
  int most_sweeps = 0;
  // All contacts of restitution 0 are one group, those of each other pair of bodies one more. In a
  // group every contact leaves with at least its share of the approach (Moreau 1988).
  bool hits_at_once = false;
  double velocity_share = 0.0;  // of a resting contact's normal velocity, undone within the step
  // Where gap + h v leaves an overlap beyond the slop at the step's end, v the velocity after the
  // hits that moves the bodies (PositionRule), this share of it is undone last, before the step's
  // motion: by the smallest moves, momenta held.
  double overlap_share = 0.0;
  double overlap_slop_m = 0.0;
  // Not where a contact separates faster than the collision velocity, unless it was hit in this
  // step at less than this many steps of gravity.
  double slow_hit_steps = 0.0;
  // A step is cut where a pair could get deeper than this share of its thinner body; 0: never.
  double depth_share = 0.0;
};

// The set of friction forces that a contact of normal force N admits.
enum class FrictionSet {
  circle,     // |f| <= mu N, opposite to the slip
  square,     // |f_1| <= mu N and |f_2| <= mu N along two fixed tangents
  inscribed,  // |f_1| + |f_2| <= mu N along two fixed tangents
};

// None: the engine's contact has no map that is predicted here.
using ContactScheme =
    std::variant<std::monostate, ImpulseContact, CompliantContact, SoftContact, SequentialContact>;

struct Scheme {
  std::string source;  // author, title, function or equation: where this is documented
  PositionRule position = PositionRule::new_velocity;
  GyroscopicRule gyroscopic = GyroscopicRule::neglected;
  AttitudeRule attitude = AttitudeRule::exponential;
  double cut_turn_rad = std::numeric_limits<double>::infinity();  // for AttitudeRule::moser_veselov
  // A turn t beyond this limit comes out as 2 atan(t / limit tan(limit / 2)).
  double turn_limit_rad = std::numeric_limits<double>::infinity();
  double order = 1.0;  // promised order of convergence of smooth motion
  ContactScheme contact;
  FrictionSet friction = FrictionSet::circle;

  // The contact, where it is of that kind, else nullptr.
  const ImpulseContact* impulse() const { return std::get_if<ImpulseContact>(&contact); }
  const CompliantContact* compliant() const { return std::get_if<CompliantContact>(&contact); }
  const SoftContact* soft() const { return std::get_if<SoftContact>(&contact); }
  const SequentialContact* sequential() const { return std::get_if<SequentialContact>(&contact); }
};

}  // namespace brickbench
