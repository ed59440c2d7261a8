#include "ourengine/exact/dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "ourengine/collision/passage.hpp"

namespace ourengine {
namespace {

// A body set moving by an impact may reach others that were too far away when the step began: the
// contacts are then looked up again, at most so many times.
constexpr int k_pass_limit = 4;
// Contacts of the step's end are added at most so many times.
constexpr int k_look_limit = 4;
// A step that does not settle is halved at most so often: parts of 1/64.
constexpr int k_cut_limit = 6;
// Of the margin, and of the thinner body: new overlaps below both are left to the next step.
constexpr double k_look_tolerance = 0.1;
constexpr double k_look_share = 0.01;
// Room for the solution of the next pass to be a little faster still.
constexpr double k_reach_growth = 1.25;

Eigen::Vector3d to_frame(const ProblemContact& contact, const Eigen::Vector3d& world) {
  return {contact.normal.dot(world), contact.tangent_1.dot(world), contact.tangent_2.dot(world)};
}

bool any_restitution(std::span<const BodyModel> bodies, const SurfaceLaws& laws) {
  std::set<int> surfaces;
  for (const BodyModel& body : bodies) surfaces.insert(body.surface);
  return std::ranges::any_of(surfaces, [&](int a) {
    return std::ranges::any_of(surfaces, [&](int b) { return laws(a, b).restitution > 0.0; });
  });
}

bool is_finite(const Motion& motion) {
  return motion.position_m.allFinite() && motion.velocity_mps.allFinite() &&
         motion.attitude.coeffs().allFinite() && motion.angular_momentum_kgm2ps.allFinite();
}

}  // namespace

Dynamics::Dynamics(std::vector<BodyModel> bodies, std::vector<Motion> motions, SurfaceLaws laws,
                   DynamicsOptions options)
    : bodies_(std::move(bodies)),
      motions_(std::move(motions)),
      laws_(std::move(laws)),
      options_(options),
      loads_(bodies_.size()),
      contacts_(bodies_, options.margin_m),
      flight_s_(bodies_.size(), 0.0),
      falls_(bodies_.size(), 0),
      held_(bodies_.size(), 0),
      reach_m_(bodies_.size(), 0.0),
      moved_m_(bodies_.size(), 0.0),
      may_bounce_(any_restitution(bodies_, laws_)),
      workers_(std::make_shared<WorkerPool>(options.threads)),
      memory_(std::make_unique<SolverMemory>(workers_)) {}

void Dynamics::apply(std::span<const Load> loads) { std::ranges::copy(loads, loads_.begin()); }

void Dynamics::set_motions(std::span<const Motion> motions) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (!bodies_[i].fixed) motions_[i] = motions[i];
  }
  contacts_.clear();
  memory_ = std::make_unique<SolverMemory>(workers_);
}

void Dynamics::restore(const Snapshot& snapshot) {
  motions_ = snapshot.motions;
  contacts_.restore(snapshot.contacts);
}

const StepReport& Dynamics::step() {
  report_ = {};
  report_.passes = 0;
  report_.parts = 0;
  told_.clear();
  advance(options_.step_s, 0);
  std::ranges::fill(loads_, Load{});
  return report_;
}

// One part of the step, or its halves where it does not settle.
void Dynamics::advance(double span_s, int level) {
  const ContactSet::History history = contacts_.history();
  Attempt attempted = attempt(span_s, true);
  if (attempted == Attempt::out_of_time) {
    contacts_.restore(history);
    attempted = attempt(span_s, false);
  }
  const bool settled = attempted == Attempt::settled && !passed();
  if (settled || level >= k_cut_limit || !std::ranges::all_of(ends_, is_finite)) {
    accept(settled);
    return;
  }
  contacts_.restore(history);
  advance(0.5 * span_s, level + 1);
  advance(0.5 * span_s, level + 1);
}

void Dynamics::accept(bool settled) {
  ++report_.parts;
  report_.ran_out = report_.ran_out || !settled;
  report_.overlap_left_m = std::max(report_.overlap_left_m, deepest_late_m_);
  report_.residual = std::max(report_.residual, solution_.residual);
  if (report_.parts == 1 || solution_.status > report_.status) {
    report_.status = solution_.status;
    report_.method = solution_.method;
  }
  report_.contacts += static_cast<int>(problem_.contacts.size());
  for (const ContactPoint& point : contacts_.points()) {
    const auto body = static_cast<std::size_t>(
        bodies_[static_cast<std::size_t>(point.body_b)].fixed ? point.body_a : point.body_b);
    told_.push_back(point);
    told_.back().position_m -= starts_[body].position_m - motions_[body].position_m;
  }
  std::swap(motions_, ends_);
}

// Finds ends_ for span_s from motions_. timed: islands may fly to their bounces first.
Dynamics::Attempt Dynamics::attempt(double span_s, bool timed) {
  span_s_ = span_s;
  starts_ = motions_;
  std::ranges::fill(flight_s_, 0.0);
  std::ranges::fill(held_, char{0});
  expect_reach();
  int passes = 0;
  bool widened = true;
  while (widened && passes < k_pass_limit) {
    find_contacts();
    if (passes == 0 && timed && fly_to_bounces()) {
      find_contacts();
      if (flew_too_far()) return Attempt::out_of_time;
    }
    if (!times_agree() || !state_and_solve()) return Attempt::out_of_time;
    widened = widen_reach();
    ++passes;
  }
  bool late = look_ahead();
  for (int looks = 0; late && looks < k_look_limit; ++looks) {
    contacts_.add(late_);
    if (!times_agree() || !state_and_solve()) return Attempt::out_of_time;
    if (widen_reach()) contacts_.find_pairs(starts_, reach_m_);
    late = look_ahead();
  }
  return widened || late ? Attempt::unsettled : Attempt::settled;
}

// How far each body gets in this step if nothing touches it; gravity alone is left to the margin.
void Dynamics::expect_reach() {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    reach_m_[i] = 0.0;
    if (bodies_[i].fixed) continue;
    const auto spin_radps = [&](const Eigen::Vector3d& momentum) {
      return angular_velocity_radps(motions_[i].attitude, bodies_[i].inertia_kgm2, momentum).norm();
    };
    const Eigen::Vector3d& momentum = motions_[i].angular_momentum_kgm2ps;
    const double speed_mps = std::max(
        motions_[i].velocity_mps.norm(),
        (motions_[i].velocity_mps + span_s_ / bodies_[i].mass_kg * loads_[i].force_n).norm());
    reach_m_[i] =
        span_s_ * (speed_mps + std::max(spin_radps(momentum),
                                        spin_radps(momentum + span_s_ * loads_[i].torque_nm)) *
                                   bounding_radius_m(bodies_[i].geometry));
  }
}

void Dynamics::find_contacts() { contacts_.update(starts_, reach_m_, span_s_, *workers_); }

WarmStart Dynamics::warm_start() const {
  WarmStart warm;
  const auto points = contacts_.points();
  for (std::size_t k = 0; k < points.size(); ++k) {
    warm.impulses_ns.push_back(to_frame(problem_.contacts[k], points[k].impulse_ns));
  }
  return warm;
}

// False if an island that flew to a bounce turns out to be held.
bool Dynamics::state_and_solve() {
  state_problem();
  solve();
  bool again = false;
  for (const Island& island : islands_) {
    if (!is_held(island)) continue;
    for (const int i : island.bodies) {
      const auto body = static_cast<std::size_t>(i);
      if (bodies_[body].fixed) continue;
      if (flight_s_[body] > 0.0) return false;
      held_[body] = 1;
    }
    again = true;
  }
  if (again) {
    state_problem();
    solve();
  }
  return true;
}

void Dynamics::solve() {
  ++report_.passes;
  if (problem_.contacts.empty()) {
    solution_ = {};
    solution_.velocity = problem_.free_velocity;
  } else {
    solution_ = options_.solver(problem_, options_.solve, warm_start(), *memory_);
    const double share = keep_energy(problem_, islands_, body_steps_, resting_mps(),
                                     options_.solver, options_.solve, *memory_, solution_);
    report_.rebound_share = std::min(report_.rebound_share, share);
  }
  report_.iterations += solution_.iterations;
  report_.factorisations += solution_.factorisations;
  const auto points = contacts_.points();
  for (std::size_t k = 0; k < points.size(); ++k) {
    const ProblemContact& contact = problem_.contacts[k];
    const Eigen::Vector3d& impulse = solution_.impulse_ns[k];
    points[k].impulse_ns = impulse[0] * contact.normal + impulse[1] * contact.tangent_1 +
                           impulse[2] * contact.tangent_2;
  }
}

// Whether some body moves further in this step than the search for contacts assumed.
bool Dynamics::widen_reach() {
  bool missed = false;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    moved_m_[i] = 0.0;
    if (bodies_[i].fixed) continue;
    const Velocity6& velocity = solution_.velocity[i];
    moved_m_[i] = left_s(i) * (velocity.head<3>().norm() +
                               velocity.tail<3>().norm() * bounding_radius_m(bodies_[i].geometry));
    if (moved_m_[i] <= reach_m_[i] + 0.5 * options_.margin_m) continue;
    reach_m_[i] = k_reach_growth * moved_m_[i];
    missed = true;
  }
  return missed;
}

std::vector<Motion> Dynamics::ends() const {
  std::vector<bool> in_contact(bodies_.size(), false);
  for (std::size_t k = 0; k < problem_.contacts.size(); ++k) {
    if (solution_.impulse_ns[k].isZero(0.0)) continue;
    in_contact[static_cast<std::size_t>(problem_.contacts[k].body_a)] = true;
    in_contact[static_cast<std::size_t>(problem_.contacts[k].body_b)] = true;
  }
  std::vector<Motion> ends = starts_;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (bodies_[i].fixed) continue;
    Motion& motion = ends[i];
    const double time_s = left_s(i);
    const Eigen::Vector3d velocity = solution_.velocity[i].head<3>();
    if (in_contact[i]) {
      motion.position_m += time_s * velocity + body_steps_[i].lag_m;
      motion.angular_momentum_kgm2ps =
          problem_.bodies[i].inertia_kgm2 * solution_.velocity[i].tail<3>();
    } else {
      motion.position_m += time_s * (0.5 * (motion.velocity_mps + velocity));
      motion.angular_momentum_kgm2ps += time_s * loads_[i].torque_nm;
    }
    motion.velocity_mps = velocity;
    motion.attitude = rotate(options_.rotation, motion.attitude, bodies_[i].inertia_kgm2,
                             motion.angular_momentum_kgm2ps, time_s);
  }
  return ends;
}

// In proportion to the part of the step: as overlaps are undone.
double Dynamics::look_tolerance_m(std::size_t a, std::size_t b) const {
  return span_s_ / options_.step_s *
         std::min(k_look_tolerance * options_.margin_m,
                  k_look_share *
                      std::min(thickness_m(bodies_[a].geometry), thickness_m(bodies_[b].geometry)));
}

// Finds where the solution brings the bodies, and which pairs overlap there though no contact
// forbids it: late_ gets those contacts. True if there are any.
bool Dynamics::look_ahead() {
  ends_ = ends();
  deepest_late_m_ = 0.0;
  late_.clear();
  for (const BodyPair& pair : contacts_.pairs()) look_at(pair);
  return !late_.empty();
}

// Each contact is stated so that its gap is exact at the solution found: gap + T J (v - v+), with
// the point midway between where it is on the one body and on the other at the start, so that the
// impulses on both act along one line and the angular momentum is kept.
void Dynamics::look_at(const BodyPair& pair) {
  const auto a = static_cast<std::size_t>(pair.first);
  const auto b = static_cast<std::size_t>(pair.second);
  const double tolerance_m = look_tolerance_m(a, b);
  if (moved_m_[a] + moved_m_[b] <= tolerance_m) return;
  const Manifold manifold = collide(bodies_[a], ends_[a], bodies_[b], ends_[b], 0.0);
  for (int p = 0; p < manifold.count; ++p) {
    const ManifoldPoint& end = manifold.points[static_cast<std::size_t>(p)];
    const auto moved = [&](std::size_t body) {
      const Velocity6& v = solution_.velocity[body];
      return Eigen::Vector3d(
          left_s(body) *
          (v.head<3>() + v.tail<3>().cross(end.position_m - ends_[body].position_m)));
    };
    // What is fixed does not care where the point is on it.
    const Eigen::Vector3d moved_a = moved(bodies_[a].fixed ? b : a);
    const Eigen::Vector3d moved_b = moved(bodies_[b].fixed ? a : b);
    ContactPoint point;
    point.body_a = pair.first;
    point.body_b = pair.second;
    point.normal = manifold.normal;
    point.position_m = end.position_m - 0.5 * (moved_a + moved_b);
    point.anchor_m = ends_[b].attitude.conjugate() * (end.position_m - ends_[b].position_m);
    const auto way_m = [&](std::size_t body) {
      if (bodies_[body].fixed) return Eigen::Vector3d(0.0, 0.0, 0.0);
      const Velocity6& v = solution_.velocity[body];
      const Eigen::Vector3d arm_m = point.position_m - starts_[body].position_m;
      return Eigen::Vector3d(left_s(body) * (v.head<3>() + v.tail<3>().cross(arm_m)) +
                             body_steps_[body].lag_m);
    };
    point.gap_m = end.gap_m - point.normal.dot(way_m(b) - way_m(a));
    if (end.gap_m >= -tolerance_m) continue;
    // Where bodies turn far, the linearised gap may see an overlap from before that never was.
    if (point.gap_m < 0.0) {
      point.gap_m =
          std::max(point.gap_m, -deepest_overlap_m(bodies_[a], starts_[a], bodies_[b], starts_[b]));
    }
    // An overlap from before is undone over several steps; only what is beyond that counts.
    const double undone_m =
        std::min(-undone_share() * point.gap_m, options_.recovery_limit_mps * span_s_);
    const double deeper_m = std::min(0.0, point.gap_m + undone_m) - end.gap_m;
    if (deeper_m <= tolerance_m) continue;
    deepest_late_m_ = std::max(deepest_late_m_, deeper_m);
    late_.push_back(point);
  }
}

// Whether some body went through another between starts_ and ends_.
bool Dynamics::passed() const {
  const auto way = [&](std::size_t i) {
    return Way{starts_[i], ends_[i], left_s(i) * solution_.velocity[i].tail<3>()};
  };
  return std::ranges::any_of(contacts_.pairs(), [&](const BodyPair& pair) {
    const auto a = static_cast<std::size_t>(pair.first);
    const auto b = static_cast<std::size_t>(pair.second);
    return passes(bodies_[a], way(a), bodies_[b], way(b));
  });
}

// Whether free flight to a bounce brought bodies into or through each other: they turned so far
// that their points met earlier than their velocities said.
bool Dynamics::flew_too_far() const {
  const auto way = [&](std::size_t i) {
    return Way{motions_[i], starts_[i], flight_s_[i] * body_steps_[i].before.tail<3>()};
  };
  return std::ranges::any_of(contacts_.pairs(), [&](const BodyPair& pair) {
    const auto a = static_cast<std::size_t>(pair.first);
    const auto b = static_cast<std::size_t>(pair.second);
    if (flight_s_[a] == 0.0 && flight_s_[b] == 0.0) return false;
    const double depth_m = deepest_overlap_m(bodies_[a], starts_[a], bodies_[b], starts_[b]);
    return (depth_m > look_tolerance_m(a, b) &&
            depth_m > look_tolerance_m(a, b) +
                          deepest_overlap_m(bodies_[a], motions_[a], bodies_[b], motions_[b])) ||
           passes(bodies_[a], way(a), bodies_[b], way(b));
  });
}

}  // namespace ourengine
