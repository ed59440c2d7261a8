// The contact problem of a step: what Dynamics states, and when.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "ourengine/exact/dynamics.hpp"

namespace ourengine {
namespace {

// Two tangents, right-handed with the normal; depends on nothing but the normal.
void complete_frame(ProblemContact& contact) {
  Eigen::Index axis = 0;
  contact.normal.cwiseAbs().minCoeff(&axis);
  contact.tangent_1 = contact.normal.cross(Eigen::Vector3d::Unit(axis)).normalized();
  contact.tangent_2 = contact.normal.cross(contact.tangent_1);
}

std::size_t index(int i) { return static_cast<std::size_t>(i); }

// Of the step: contacts whose gaps close so soon after it close in it.
constexpr double k_together = 1e-9;
// Of an island's largest impulse: less is the residual of its solver.
constexpr double k_push_share = 1e-8;
// Of the overlap that a look sees: rounding.
constexpr double k_rounding_share = 1e-6;

}  // namespace

// An approach slower than this is no impact.
double Dynamics::resting_mps() const {
  return options_.resting_approach_steps * options_.step_s * options_.gravity_mps2.norm();
}

Eigen::Matrix3d Dynamics::world_inertia(std::size_t body) const {
  const Eigen::Matrix3d r = starts_[body].attitude.toRotationMatrix();
  return r * bodies_[body].inertia_kgm2.asDiagonal() * r.transpose();
}

// Everything that the solvers need to know of this step: M, J, gaps, free velocity, mu, e.
void Dynamics::state_problem() {
  problem_.step_s = span_s_;
  problem_.least_speed_mps = span_s_ * options_.gravity_mps2.norm();
  problem_.recovery_mps = options_.recovery_limit_mps;
  state_bodies();
  state_contacts();
  islands_ = find_islands(problem_);
  std::ranges::fill(falls_, char{0});
  for (const Island& island : islands_) {
    if (!falls(island)) continue;
    for (const int i : island.bodies) {
      if (bodies_[index(i)].fixed) continue;
      falls_[index(i)] = 1;
      body_steps_[index(i)].lag_m =
          -0.5 * left_s(index(i)) * left_s(index(i)) * options_.gravity_mps2;
    }
  }
  bounces_.assign(problem_.contacts.size(), 0);
  find_first_touches();
  for (std::size_t k = 0; k < problem_.contacts.size(); ++k) state_gap(k);
}

// When each contact's pair first touches in free motion: its other points then do not get where
// that would bring them.
void Dynamics::find_first_touches() {
  first_touch_s_.assign(problem_.contacts.size(), std::numeric_limits<double>::infinity());
  if (!may_bounce_) return;
  std::map<std::pair<int, int>, double> first_s;
  const auto of_pair = [&](std::size_t k) -> double& {
    const ProblemContact& contact = problem_.contacts[k];
    return first_s.try_emplace({contact.body_a, contact.body_b}, first_touch_s_[k]).first->second;
  };
  for (std::size_t k = 0; k < problem_.contacts.size(); ++k) {
    of_pair(k) = std::min(of_pair(k), touch_of(k).time_s);
  }
  for (std::size_t k = 0; k < problem_.contacts.size(); ++k) first_touch_s_[k] = of_pair(k);
}

void Dynamics::state_bodies() {
  problem_.bodies.resize(bodies_.size());
  problem_.free_velocity.resize(bodies_.size());
  body_steps_.assign(bodies_.size(), BodyStep{});
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    ProblemBody& body = problem_.bodies[i];
    body.fixed = bodies_[i].fixed;
    problem_.free_velocity[i].setZero();
    if (body.fixed) continue;
    body.mass_kg = bodies_[i].mass_kg;
    body.inertia_kgm2 = world_inertia(i);
    const auto spin = [&](const Eigen::Vector3d& momentum) {
      return angular_velocity_radps(starts_[i].attitude, bodies_[i].inertia_kgm2, momentum);
    };
    const Eigen::Vector3d& momentum = starts_[i].angular_momentum_kgm2ps;
    BodyStep& step = body_steps_[i];
    step.span_s = left_s(i);
    step.before << starts_[i].velocity_mps, spin(momentum);
    step.acceleration_mps2 = options_.gravity_mps2 + loads_[i].force_n / bodies_[i].mass_kg;
    step.torque_nm = loads_[i].torque_nm;
    problem_.free_velocity[i] << starts_[i].velocity_mps + step.span_s * step.acceleration_mps2,
        spin(momentum + step.span_s * loads_[i].torque_nm);
  }
}

// Contacts as they are at the start, gaps unscaled.
void Dynamics::state_contacts() {
  problem_.contacts.clear();
  for (const ContactPoint& point : contacts_.points()) {
    const auto a = index(point.body_a);
    const auto b = index(point.body_b);
    ProblemContact contact;
    contact.body_a = point.body_a;
    contact.body_b = point.body_b;
    contact.arm_a_m = point.position_m - starts_[a].position_m;
    contact.arm_b_m = point.position_m - starts_[b].position_m;
    contact.normal = point.normal;
    complete_frame(contact);
    contact.gap_m = point.gap_m;
    const SurfaceLaw& law = laws_(bodies_[a].surface, bodies_[b].surface);
    contact.friction = options_.frictionless ? 0.0 : law.friction;
    contact.restitution = law.restitution;
    const Velocity6& before_a = body_steps_[a].before;
    const Velocity6& before_b = body_steps_[b].before;
    contact.approach_mps =
        point.normal.dot(before_b.head<3>() + before_b.tail<3>().cross(contact.arm_b_m) -
                         before_a.head<3>() - before_a.tail<3>().cross(contact.arm_a_m));
    contact.id = point.id;
    problem_.contacts.push_back(contact);
  }
}

// Relative acceleration (m/s2) along the normal that only the lag of one body makes up for: the
// other is fixed. Zero in islands that are held.
double Dynamics::lag_mps2(std::size_t k) const {
  const ProblemContact& contact = problem_.contacts[k];
  const auto a = index(contact.body_a);
  const auto b = index(contact.body_b);
  if (bodies_[a].fixed == bodies_[b].fixed || falls_[bodies_[a].fixed ? b : a] == 0) return 0.0;
  const double along_mps2 = contact.normal.dot(options_.gravity_mps2);
  return bodies_[a].fixed ? along_mps2 : -along_mps2;
}

// The free motion of a contact's gap until the end of the step. What touches a moment later belongs
// to it: rounding would part the corners of a face that comes down at the end.
Touch Dynamics::touch_of(std::size_t k) const {
  const ProblemContact& contact = problem_.contacts[k];
  const auto a = index(contact.body_a);
  const auto b = index(contact.body_b);
  const auto acceleration = [&](std::size_t i) {
    return bodies_[i].fixed ? Eigen::Vector3d(0.0, 0.0, 0.0) : body_steps_[i].acceleration_mps2;
  };
  return first_touch(contact.gap_m, contact.approach_mps,
                     contact.normal.dot(acceleration(b) - acceleration(a)),
                     left_s(bodies_[a].fixed ? b : a) + k_together * span_s_);
}

bool Dynamics::bounces(std::size_t k, const Touch& touch) const {
  const ProblemContact& contact = problem_.contacts[k];
  const SurfaceLaw& law =
      laws_(bodies_[index(contact.body_a)].surface, bodies_[index(contact.body_b)].surface);
  return law.restitution > 0.0 && touch.speed_mps > resting_mps();
}

// Whether no fixed body holds the island: where it meets one within the step, it bounces.
bool Dynamics::falls(const Island& island) const {
  if (std::ranges::any_of(island.bodies, [&](int i) { return held_[index(i)] != 0; })) return false;
  return std::ranges::none_of(island.contacts, [&](int c) {
    const ProblemContact& contact = problem_.contacts[index(c)];
    if (!bodies_[index(contact.body_a)].fixed && !bodies_[index(contact.body_b)].fixed) {
      return false;
    }
    const Touch touch = touch_of(index(c));
    return std::isfinite(touch.time_s) && !bounces(index(c), touch);
  });
}

// Whether the island, which was to fall, is pushed by a fixed body without a bounce. Impulses far
// below its largest are what a solver leaves of none.
bool Dynamics::is_held(const Island& island) const {
  double largest_ns = 0.0;
  for (const int c : island.contacts) {
    largest_ns = std::max(largest_ns, solution_.impulse_ns[index(c)].norm());
  }
  return std::ranges::any_of(island.contacts, [&](int c) {
    const ProblemContact& contact = problem_.contacts[index(c)];
    const auto a = index(contact.body_a);
    const auto b = index(contact.body_b);
    return bodies_[a].fixed != bodies_[b].fixed && falls_[bodies_[a].fixed ? b : a] != 0 &&
           bounces_[index(c)] == 0 &&
           solution_.impulse_ns[index(c)].norm() > k_push_share * largest_ns;
  });
}

// Least normal velocity (m/s) at the end of the step of a contact that bounces: restitution times
// the approach at touch, and what gravity and loads change until then; 0 if it does not bounce, if
// its pair touches elsewhere before, or if that is used up by then.
double Dynamics::rebound_mps(std::size_t k) const {
  const Touch touch = touch_of(k);
  if (!std::isfinite(touch.time_s) || !bounces(k, touch)) return 0.0;
  if (touch.time_s > first_touch_s_[k] + k_together * span_s_) return 0.0;
  const ProblemContact& contact = problem_.contacts[k];
  const auto a = index(contact.body_a);
  const auto b = index(contact.body_b);
  const Eigen::Vector3d relative_mps2 =
      body_steps_[b].acceleration_mps2 - body_steps_[a].acceleration_mps2;
  const double after_s = left_s(bodies_[a].fixed ? b : a) - touch.time_s;
  return std::max(
      0.0, contact.restitution * touch.speed_mps + after_s * contact.normal.dot(relative_mps2));
}

// Turns the gap of a contact into what the law is to see: all of it over the whole step, overlaps
// by the share that is undone. The rebound of falling bodies is stated as if they came at its speed
// with restitution 1.
void Dynamics::state_gap(std::size_t k) {
  ProblemContact& contact = problem_.contacts[k];
  const bool fixed_a = bodies_[index(contact.body_a)].fixed;
  const std::size_t mover = index(fixed_a ? contact.body_b : contact.body_a);
  const double time_s = left_s(mover);
  const double rebound = falls_[mover] != 0 ? rebound_mps(k) : 0.0;
  bounces_[k] = rebound > 0.0 ? 1 : 0;
  if (contact.gap_m < 0.0) contact.gap_m *= undone_share();
  const double lag = lag_mps2(k);
  if (lag != 0.0) contact.gap_m -= 0.5 * time_s * time_s * lag;
  if (time_s != span_s_) contact.gap_m *= span_s_ / time_s;
  if (falls_[mover] == 0) {
    if (!(contact.approach_mps < -resting_mps())) contact.restitution = 0.0;
  } else if (bounces_[k] != 0) {
    contact.restitution = 1.0;
    contact.approach_mps = -rebound;
    contact.gap_m = std::min(contact.gap_m, rebound * span_s_);
  } else {
    contact.restitution = 0.0;
  }
}

// When the island, which falls, first bounces; 0 if it does not, or if something in it meets
// earlier and does not bounce. Bodies that fall together touch, and approach as rounding has it.
double Dynamics::bounce_time_s(const Island& island) const {
  double first_s = span_s_;
  bool any = false;
  for (const int c : island.contacts) {
    const Touch touch = touch_of(index(c));
    if (!bounces(index(c), touch) || touch.time_s > first_s) continue;
    first_s = touch.time_s;
    any = true;
  }
  if (!any) return 0.0;
  for (const int c : island.contacts) {
    const Touch touch = touch_of(index(c));
    if (!(touch.time_s < first_s)) continue;
    const ProblemContact& contact = problem_.contacts[index(c)];
    const double seen_m =
        k_rounding_share * look_tolerance_m(index(contact.body_a), index(contact.body_b));
    if (touch.speed_mps * (first_s - touch.time_s) > seen_m) return 0.0;
  }
  return first_s;
}

// Lets islands that only fall fly to their first bounce. True if one does.
bool Dynamics::fly_to_bounces() {
  if (!may_bounce_) return false;
  state_problem();
  // The gaps as they are.
  state_contacts();
  bool any = false;
  for (const Island& island : islands_) {
    const auto mover =
        std::ranges::find_if(island.bodies, [&](int i) { return !bodies_[index(i)].fixed; });
    if (mover == island.bodies.end() || falls_[index(*mover)] == 0) continue;
    const double time_s = bounce_time_s(island);
    if (!(time_s > 0.0 && time_s < span_s_)) continue;
    for (const int i : island.bodies) {
      if (bodies_[index(i)].fixed) continue;
      flight_s_[index(i)] = time_s;
      starts_[index(i)] = flown(bodies_[index(i)], motions_[index(i)], loads_[index(i)],
                                options_.gravity_mps2, options_.rotation, time_s);
    }
    any = true;
  }
  return any;
}

// Whether bodies that may meet begin at the same time.
bool Dynamics::times_agree() const {
  return std::ranges::all_of(contacts_.points(), [&](const ContactPoint& point) {
    const auto a = index(point.body_a);
    const auto b = index(point.body_b);
    return bodies_[a].fixed || bodies_[b].fixed || flight_s_[a] == flight_s_[b];
  });
}

}  // namespace ourengine
