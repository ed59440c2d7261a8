#include "ourengine/baraff/simulator.hpp"

#include <algorithm>
#include <cmath>

#include "ourengine/baraff/constant_force.hpp"
#include "ourengine/baraff/forward_euler.hpp"
#include "ourengine/baraff/joint_collision.hpp"
#include "ourengine/baraff/safe_step.hpp"

namespace ourengine::baraff {
namespace {

constexpr int k_bisection_halvings = 60;

}  // namespace

Options paper_options() {
  Options options;
  options.motion = Motion::forward_euler;
  options.velocity_share = 0.0;
  options.overlap_share = 0.0;
  options.hits_at_once = false;
  options.depth_share = 0.0;
  return options;
}

Simulator::Simulator(std::vector<RigidBody> bodies, RestitutionTable restitution, Options options)
    : bodies_(std::move(bodies)),
      restitution_(std::move(restitution)),
      options_(options),
      loads_(bodies_.size()) {
  for (RigidBody& body : bodies_) compute_derived(body);
}

void Simulator::apply(std::span<const Load> loads) { std::ranges::copy(loads, loads_.begin()); }

void Simulator::set_bodies(std::span<const RigidBody> bodies) {
  std::ranges::copy(bodies, bodies_.begin());
  for (RigidBody& body : bodies_) compute_derived(body);
  std::ranges::fill(loads_, Load{});
  contacts_.clear();
  report_ = {};
}

const StepReport& Simulator::step() {
  report_ = {};
  contacts_.clear();
  double left_s = options_.step_s;
  while (left_s > 0.0) {
    accumulate_forces();
    find_collisions(bodies_, options_.contact_tolerance_m, collisions_);
    for (Collision& contact : collisions_) {
      contact.met_mps = relative_normal_velocity(bodies_, contact);
    }
    const double start_j = energy();
    const int sweeps = collide();
    report_.colliding_iterations += sweeps;
    report_.collisions_unfinished |= sweeps > options_.max_collision_sweeps;
    const double collided_j = energy();
    const double piece_s = rest(left_s);
    separate_overlaps(piece_s);
    const double separated_j = energy();
    left_s -= move(piece_s);
    ++report_.pieces;
    report_.collision_energy_j += collided_j - start_j;
    report_.overlap_energy_j += separated_j - collided_j;
    report_.motion_energy_j += energy() - separated_j;
  }
  report_.unsolved =
      report_.collisions_unfinished || report_.overlaps_left > 0 || report_.hasty || report_.failed;
  std::ranges::fill(loads_, Load{});
  return report_;
}

int Simulator::collide() {
  const auto hit = options_.hits_at_once ? &collide_in_groups : &colliding_contact;
  return hit(bodies_, collisions_, restitution_, options_.collision_velocity_mps,
             options_.max_collision_sweeps);
}

// The forces of resting contacts over what is left of the step, or over the part of it after which
// contacts have to be looked for anew; returns its time.
double Simulator::rest(double step_s) {
  const std::vector<Collision> hit = collisions_;
  resting_contact(step_s);
  const double shortest_s = options_.step_s / k_most_pieces;
  const double safe_s = safe_step_s(bodies_, step_s, options_.depth_share);
  const double piece_s = std::min(step_s, std::max(safe_s, shortest_s));
  report_.hasty |= safe_s < piece_s;
  if (piece_s < step_s) {
    collisions_ = hit;
    accumulate_forces();
    resting_contact(piece_s);
  }
  return piece_s;
}

void Simulator::accumulate_forces() {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    bodies_[i].force_n = bodies_[i].mass_kg * options_.gravity_mps2 + loads_[i].force_n;
    bodies_[i].torque_nm = loads_[i].torque_nm;
  }
}

bool Simulator::parts_by_itself(const Collision& contact) const {
  const double threshold_mps = options_.collision_velocity_mps;
  if (collision_type(bodies_, contact, threshold_mps) != ContactType::separating) return false;
  const double slow_mps = options_.slow_hit_steps * options_.step_s * options_.gravity_mps2.norm();
  return contact.met_mps >= -threshold_mps || contact.met_mps < -slow_mps;
}

// (collisions): gap plus the normal way of the step at the velocities that move the bodies; no
// overlap where a contact parts by itself.
Eigen::VectorXd Simulator::gaps_after(double step_s) const {
  std::vector<RigidBody> moving = bodies_;
  if (options_.motion == Motion::constant_force) {
    for (RigidBody& body : moving) push(body, 0.5 * step_s);
  }
  Eigen::VectorXd gap_m(static_cast<Eigen::Index>(collisions_.size()));
  for (Eigen::Index i = 0; i < gap_m.size(); ++i) {
    const Collision& contact = collisions_[static_cast<std::size_t>(i)];
    gap_m[i] = contact.gap_m + step_s * relative_normal_velocity(moving, contact);
    if (parts_by_itself(contact)) gap_m[i] = std::max(gap_m[i], 0.0);
  }
  return gap_m;
}

// Smallest moves, measured by kinetic energy, after which the motion of the step leaves no contact
// deeper than the slop: the system of the resting contacts with displacements in place of
// accelerations.
void Simulator::separate_overlaps(double step_s) {
  if (options_.overlap_share == 0.0 || collisions_.empty()) return;
  const Eigen::VectorXd gap_m = gaps_after(step_s);
  if (gap_m.minCoeff() >= -options_.overlap_slop_m) return;
  const Eigen::VectorXd wanted_m =
      gap_m.cwiseMax(0.0) + options_.overlap_share * gap_m.cwiseMin(0.0);
  const QpResult solved = qp_solve(compute_a_matrix(bodies_, collisions_), wanted_m);
  report_.overlap_residual = std::max(report_.overlap_residual, solved.residual);
  count(solved);
  if (solved.failed) {
    ++report_.overlaps_left;
    return;
  }
  std::vector<RigidBody> moves = bodies_;
  for (RigidBody& body : moves) {
    body.linear_momentum_ns.setZero();
    body.angular_momentum_nms.setZero();
    body.force_n.setZero();
    body.torque_nm.setZero();
    compute_derived(body);
  }
  for (Eigen::Index i = 0; i < gap_m.size(); ++i) {
    Collision pushed = collisions_[static_cast<std::size_t>(i)];
    apply_collision(moves, pushed, solved.force[i]);
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    forward_euler(moves[i], 1.0);  // its velocities are displacements
    bodies_[i].position_m = moves[i].position_m;
    bodies_[i].orientation = moves[i].orientation;
    compute_derived(bodies_[i]);
  }
}

void Simulator::count(const QpResult& solved) {
  report_.pivots += solved.pivots;
  report_.zero_steps += solved.zero_steps;
  report_.retried += solved.retried ? 1 : 0;
}

void Simulator::resting_contact(double step_s) {
  report_.contacts = std::max(report_.contacts, static_cast<int>(collisions_.size()));
  std::vector<Collision> resting;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < collisions_.size(); ++i) {
    const ContactType type =
        collision_type(bodies_, collisions_[i], options_.collision_velocity_mps);
    if (type == ContactType::separating) continue;
    resting.push_back(collisions_[i]);
    index.push_back(i);
  }
  report_.resting_contacts = std::max(report_.resting_contacts, static_cast<int>(resting.size()));
  if (!resting.empty()) {
    const double per_s = options_.velocity_share / step_s;
    Eigen::VectorXd b = compute_b_vector(bodies_, resting);
    for (Eigen::Index i = 0; i < b.size(); ++i) {
      b[i] += per_s * relative_normal_velocity(bodies_, resting[static_cast<std::size_t>(i)]);
    }
    const QpResult solved =
        qp_solve(compute_a_matrix(bodies_, resting), b, term_size(bodies_, resting, per_s));
    report_.complementarity_residual = std::max(report_.complementarity_residual, solved.residual);
    count(solved);
    report_.failed |= solved.failed;
    for (std::size_t i = 0; !solved.failed && i < resting.size(); ++i) {
      const Collision& contact = resting[i];
      const double force = solved.force[static_cast<Eigen::Index>(i)];
      RigidBody& one = bodies_[contact.obj1];
      RigidBody& two = bodies_[contact.obj2];
      one.force_n += force * contact.normal;
      two.force_n -= force * contact.normal;
      one.torque_nm += (contact.location - one.position_m).cross(force * contact.normal);
      two.torque_nm -= (contact.location - two.position_m).cross(force * contact.normal);
      collisions_[index[i]].impulse_ns += force * step_s;
    }
  }
}

void Simulator::integrate(double step_s) {
  const auto move = options_.motion == Motion::forward_euler ? &forward_euler : &constant_force;
  for (RigidBody& body : bodies_) move(body, step_s);
}

double Simulator::energy() const {
  double sum_j = 0.0;
  for (const RigidBody& body : bodies_) {
    if (body.is_fixed()) continue;
    sum_j += 0.5 * body.linear_momentum_ns.dot(body.velocity_mps) +
             0.5 * body.angular_momentum_nms.dot(body.angular_velocity_radps) -
             body.mass_kg * options_.gravity_mps2.dot(body.position_m);
  }
  return sum_j;
}

double Simulator::deepest_gap() {
  double deepest = HUGE_VAL;
  for (const Collision& contact : collisions_) deepest = std::min(deepest, contact.gap_m);
  return deepest;
}

// Moves by step_s, or to the time of contact if bisection is asked for; returns the time moved.
double Simulator::move(double step_s) {
  const std::vector<Collision> used = collisions_;
  const double before_m = std::min(deepest_gap(), 0.0);
  const std::vector<RigidBody> start = bodies_;
  double moved_s = step_s;
  integrate(step_s);
  if (report_.bisections < options_.max_bisections) {
    const auto overlaps = [&] {
      find_collisions(bodies_, options_.contact_tolerance_m, collisions_);
      return deepest_gap() < before_m - options_.contact_tolerance_m;
    };
    double low_s = 0.0;
    double high_s = step_s;
    const bool cut = overlaps();
    for (int k = 0; cut && k < k_bisection_halvings; ++k) {
      moved_s = 0.5 * (low_s + high_s);
      bodies_ = start;
      integrate(moved_s);
      if (overlaps()) {
        high_s = moved_s;
      } else if (deepest_gap() <= options_.contact_tolerance_m) {
        break;
      } else {
        low_s = moved_s;
      }
    }
    if (cut) ++report_.bisections;
  }
  contacts_.insert(contacts_.end(), used.begin(), used.end());
  return moved_s;
}

}  // namespace ourengine::baraff
