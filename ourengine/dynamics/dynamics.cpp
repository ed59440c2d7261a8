#include "ourengine/dynamics/dynamics.hpp"

#include <algorithm>
#include <cmath>

namespace ourengine {
namespace {

// A body set moving by an impact may reach others that were too far away when the step began: the
// contacts are then looked up again, at most so many times.
constexpr int k_pass_limit = 4;
// Contacts of the step's end are added at most so many times.
constexpr int k_look_limit = 4;
// Of the margin: new overlaps below this are left to the next step.
constexpr double k_look_tolerance = 0.1;
// Room for the solution of the next pass to be a little faster still.
constexpr double k_reach_growth = 1.25;

// Two tangents, right-handed with the normal; depends on nothing but the normal.
void complete_frame(ProblemContact& contact) {
  Eigen::Index axis = 0;
  contact.normal.cwiseAbs().minCoeff(&axis);
  contact.tangent_1 = contact.normal.cross(Eigen::Vector3d::Unit(axis)).normalized();
  contact.tangent_2 = contact.normal.cross(contact.tangent_1);
}

Eigen::Vector3d to_frame(const ProblemContact& contact, const Eigen::Vector3d& world) {
  return {contact.normal.dot(world), contact.tangent_1.dot(world), contact.tangent_2.dot(world)};
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
      reach_m_(bodies_.size(), 0.0),
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
  expect_reach();
  bool widened = true;
  while (widened && report_.passes < k_pass_limit) {
    contacts_.update(motions_, reach_m_, options_.step_s, *workers_);
    state_problem();
    solve();
    widened = widen_reach();
  }
  bool late = look_ahead();
  for (int looks = 0; late && looks < k_look_limit; ++looks) {
    contacts_.add(late_);
    state_problem();
    solve();
    late = look_ahead();
  }
  report_.ran_out = widened || late;
  std::swap(motions_, ends_);
  std::ranges::fill(loads_, Load{});
  return report_;
}

// How far each body gets in this step if it keeps its velocity, gravity included.
void Dynamics::expect_reach() {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    reach_m_[i] = 0.0;
    if (bodies_[i].fixed) continue;
    const double spin_radps = angular_velocity_radps(motions_[i].attitude, bodies_[i].inertia_kgm2,
                                                     motions_[i].angular_momentum_kgm2ps)
                                  .norm();
    reach_m_[i] = options_.step_s * (motions_[i].velocity_mps.norm() +
                                     spin_radps * bounding_radius_m(bodies_[i].geometry));
  }
}

Eigen::Matrix3d Dynamics::world_inertia(std::size_t body) const {
  const Eigen::Matrix3d r = motions_[body].attitude.toRotationMatrix();
  return r * bodies_[body].inertia_kgm2.asDiagonal() * r.transpose();
}

// Everything that the solvers need to know of this step: M, J, gaps, free velocity, mu, e.
void Dynamics::state_problem() {
  problem_.step_s = options_.step_s;
  problem_.recovery_mps = options_.recovery_limit_mps;
  problem_.least_speed_mps = options_.step_s * options_.gravity_mps2.norm();
  problem_.bodies.resize(bodies_.size());
  problem_.free_velocity.resize(bodies_.size());
  std::vector<Velocity6> before(bodies_.size(), Velocity6::Zero());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    ProblemBody& body = problem_.bodies[i];
    body.fixed = bodies_[i].fixed;
    problem_.free_velocity[i].setZero();
    if (body.fixed) continue;
    body.mass_kg = bodies_[i].mass_kg;
    body.inertia_kgm2 = world_inertia(i);
    const auto spin = [&](const Eigen::Vector3d& momentum) {
      return angular_velocity_radps(motions_[i].attitude, bodies_[i].inertia_kgm2, momentum);
    };
    const Eigen::Vector3d& momentum = motions_[i].angular_momentum_kgm2ps;
    before[i] << motions_[i].velocity_mps, spin(momentum);
    problem_.free_velocity[i] << motions_[i].velocity_mps +
                                     options_.step_s * (options_.gravity_mps2 +
                                                        loads_[i].force_n / bodies_[i].mass_kg),
        spin(momentum + options_.step_s * loads_[i].torque_nm);
  }

  const double resting_mps =
      options_.resting_approach_steps * options_.step_s * options_.gravity_mps2.norm();
  problem_.contacts.clear();
  for (const ContactPoint& point : contacts_.points()) {
    const auto a = static_cast<std::size_t>(point.body_a);
    const auto b = static_cast<std::size_t>(point.body_b);
    ProblemContact contact;
    contact.body_a = point.body_a;
    contact.body_b = point.body_b;
    contact.arm_a_m = point.position_m - motions_[a].position_m;
    contact.arm_b_m = point.position_m - motions_[b].position_m;
    contact.normal = point.normal;
    complete_frame(contact);
    contact.gap_m = point.gap_m < 0.0 ? options_.overlap_recovery * point.gap_m : point.gap_m;
    const SurfaceLaw& law = laws_(bodies_[a].surface, bodies_[b].surface);
    contact.friction = options_.frictionless ? 0.0 : law.friction;
    contact.approach_mps =
        point.normal.dot(before[b].head<3>() + before[b].tail<3>().cross(contact.arm_b_m) -
                         before[a].head<3>() - before[a].tail<3>().cross(contact.arm_a_m));
    contact.restitution = contact.approach_mps < -resting_mps ? law.restitution : 0.0;
    contact.id = point.id;
    problem_.contacts.push_back(contact);
  }
}

WarmStart Dynamics::warm_start() const {
  WarmStart warm;
  const auto points = contacts_.points();
  for (std::size_t k = 0; k < points.size(); ++k) {
    warm.impulses_ns.push_back(to_frame(problem_.contacts[k], points[k].impulse_ns));
  }
  return warm;
}

void Dynamics::solve() {
  ++report_.passes;
  report_.contacts = static_cast<int>(problem_.contacts.size());
  if (problem_.contacts.empty()) {
    solution_ = {};
    solution_.velocity = problem_.free_velocity;
  } else {
    solution_ = options_.solver(problem_, options_.solve, warm_start(), *memory_);
  }
  report_.residual = solution_.residual;
  report_.status = solution_.status;
  report_.method = solution_.method;
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
    if (bodies_[i].fixed) continue;
    const Velocity6& velocity = solution_.velocity[i];
    const double needed_m =
        options_.step_s * (velocity.head<3>().norm() +
                           velocity.tail<3>().norm() * bounding_radius_m(bodies_[i].geometry));
    if (needed_m <= reach_m_[i] + 0.5 * options_.margin_m) continue;
    reach_m_[i] = k_reach_growth * needed_m;
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
  std::vector<Motion> ends = motions_;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (bodies_[i].fixed) continue;
    Motion& motion = ends[i];
    const Eigen::Vector3d velocity = solution_.velocity[i].head<3>();
    motion.position_m +=
        options_.step_s * (in_contact[i] ? velocity : 0.5 * (motion.velocity_mps + velocity));
    motion.velocity_mps = velocity;
    motion.angular_momentum_kgm2ps =
        in_contact[i]
            ? Eigen::Vector3d(problem_.bodies[i].inertia_kgm2 * solution_.velocity[i].tail<3>())
            : Eigen::Vector3d(motion.angular_momentum_kgm2ps +
                              options_.step_s * loads_[i].torque_nm);
    motion.attitude = rotate(options_.rotation, motion.attitude, bodies_[i].inertia_kgm2,
                             motion.angular_momentum_kgm2ps, options_.step_s);
  }
  return ends;
}

// Finds where the solution brings the bodies, and which of the pairs that move noticeably overlap
// there though no contact forbids it: late_ gets those contacts. True if there are any. Each is
// stated so that its gap is exact at the solution found: gap + dt J (v - v+), with the point
// midway between where it is on the one body and on the other at the start, so that the impulses
// on both act along one line and the angular momentum is kept.
bool Dynamics::look_ahead() {
  ends_ = ends();
  report_.overlap_left_m = 0.0;
  const double dt = options_.step_s;
  late_.clear();
  for (const BodyPair& pair : contacts_.pairs()) {
    const auto a = static_cast<std::size_t>(pair.first);
    const auto b = static_cast<std::size_t>(pair.second);
    if (reach_m_[a] + reach_m_[b] <= options_.margin_m) continue;
    const Manifold manifold = collide(bodies_[a], ends_[a], bodies_[b], ends_[b], 0.0);
    for (int p = 0; p < manifold.count; ++p) {
      const ManifoldPoint& end = manifold.points[static_cast<std::size_t>(p)];
      const auto moved = [&](std::size_t body) {
        const Velocity6& v = solution_.velocity[body];
        return Eigen::Vector3d(
            dt * (v.head<3>() + v.tail<3>().cross(end.position_m - ends_[body].position_m)));
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
      const auto speed = [&](std::size_t body) {
        const Velocity6& v = solution_.velocity[body];
        return Eigen::Vector3d(v.head<3>() +
                               v.tail<3>().cross(point.position_m - motions_[body].position_m));
      };
      const double opened_m = dt * point.normal.dot(speed(b) - speed(a));
      point.gap_m = end.gap_m - opened_m;
      // An overlap from before is undone over several steps; only what is beyond that counts.
      const double undone_m =
          std::min(-options_.overlap_recovery * point.gap_m, options_.recovery_limit_mps * dt);
      const double allowed_m = std::min(0.0, point.gap_m + undone_m);
      const double deeper_m = allowed_m - end.gap_m;
      if (deeper_m <= k_look_tolerance * options_.margin_m) continue;
      report_.overlap_left_m = std::max(report_.overlap_left_m, deeper_m);
      late_.push_back(point);
    }
  }
  return !late_.empty();
}

}  // namespace ourengine
