#include "experiments/exact/soft_map.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "experiments/exact/scheme_map.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double k_infinity = std::numeric_limits<double>::infinity();

double thickness_m(const Shape& shape) {
  if (const auto* box = std::get_if<BoxShape>(&shape)) return 2.0 * box->half_extents_m.minCoeff();
  if (const auto* sphere = std::get_if<SphereShape>(&shape)) return 2.0 * sphere->radius_m;
  return k_infinity;
}

double bounding_radius_m(const Shape& shape) {
  if (const auto* box = std::get_if<BoxShape>(&shape)) return box->half_extents_m.norm();
  if (const auto* sphere = std::get_if<SphereShape>(&shape)) return sphere->radius_m;
  return k_infinity;
}

Matrix3d inverse_inertia(const Body& body, const Quaterniond& attitude) {
  const Matrix3d r = attitude.toRotationMatrix();
  return r * body.inertia_kgm2.cwiseInverse().asDiagonal() * r.transpose();
}

// With one rounding per product and sum.
float dot(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return std::fma(a.z(), b.z(), std::fma(a.y(), b.y(), a.x() * b.x()));
}
void add(Eigen::Vector3f& sum, const Eigen::Vector3f& direction, float scale) {
  for (Eigen::Index k = 0; k < 3; ++k) sum[k] = std::fma(direction[k], scale, sum[k]);
}

}  // namespace

SoftMap::SoftMap(const Scheme& scheme, const ExactRun& run)
    : scheme_(scheme),
      soft_(*scheme.soft),
      run_(run),
      velocity_(run.world.bodies.size()),
      moved_(run.world.bodies.size()) {}

// How far any point of the body can move in this step.
double SoftMap::reach_m(std::size_t body, const State& state) const {
  const Body& fact = run_.world.bodies[body];
  if (fact.fixed) return 0.0;
  return run_.step_s * (state.velocity_mps.norm() +
                        state.angular_velocity_radps.norm() * bounding_radius_m(fact.shape));
}

bool SoftMap::still_holds(const Memory& memory, double margin_m,
                          std::span<const State> states) const {
  const Body& a = run_.world.bodies[memory.body_a];
  const Body& b = run_.world.bodies[memory.body_b];
  const double bound_m = soft_.keep_share * std::min(thickness_m(a.shape), thickness_m(b.shape));
  if (margin_m + 2.0 * bound_m > memory.found_within_m) return false;
  const State& at_a = states[memory.body_a];
  const State& at_b = states[memory.body_b];
  const Quaterniond to_a = at_a.orientation.conjugate();
  const Eigen::Vector4d now = (to_a * at_b.orientation).coeffs();
  const Eigen::Vector4d then = memory.b_in_a.coeffs();
  const Vector3d between_m = at_b.position_m - at_a.position_m;
  const double lever_m =
      std::min(bounding_radius_m(b.shape), between_m.norm() + bounding_radius_m(a.shape));
  const double turn_m = 2.0 * lever_m * std::min((now - then).norm(), (now + then).norm());
  return (to_a * between_m - memory.between_in_a_m).norm() + turn_m <= bound_m;
}

SoftMap::Memory SoftMap::found(const PointContact& contact, double reach_m,
                               std::span<const State> states) const {
  const State& a = states[contact.body_a];
  const State& b = states[contact.body_b];
  const Quaterniond to_a = a.orientation.conjugate();
  const double thin_m = std::min(thickness_m(run_.world.bodies[contact.body_a].shape),
                                 thickness_m(run_.world.bodies[contact.body_b].shape));
  const Vector3d on_a_m = contact.position_m - contact.gap_m * contact.normal;
  Memory memory;
  memory.body_a = contact.body_a;
  memory.body_b = contact.body_b;
  memory.on_a_m = to_a * (on_a_m - a.position_m);
  memory.on_b_m = b.orientation.conjugate() * (contact.position_m - b.position_m);
  memory.normal_in_a = to_a * contact.normal;
  memory.between_in_a_m = to_a * (b.position_m - a.position_m);
  memory.b_in_a = to_a * b.orientation;
  memory.found_within_m = 1.5 * soft_.margin_m + reach_m + 2.0 * soft_.keep_share * thin_m;
  return memory;
}

// Contacts of this step with what they inherit from the last one.
void SoftMap::remember(const std::vector<PointContact>& contacts, std::span<const State> states) {
  std::vector<Memory> next;
  for (const PointContact& contact : contacts) {
    const double reach = reach_m(contact.body_a, states[contact.body_a]) +
                         reach_m(contact.body_b, states[contact.body_b]);
    const auto old = std::ranges::find_if(memories_, [&](const Memory& m) {
      return m.body_a == contact.body_a && m.body_b == contact.body_b;
    });
    const bool known = old != memories_.end();
    if (known && still_holds(*old, soft_.margin_m + reach, states)) {
      next.push_back(*old);
      continue;
    }
    Memory memory = found(contact, reach, states);
    if (contact.gap_m > memory.found_within_m) continue;
    const double thin_m = std::min(thickness_m(run_.world.bodies[contact.body_a].shape),
                                   thickness_m(run_.world.bodies[contact.body_b].shape));
    if (known && (old->on_b_m - memory.on_b_m).norm() < soft_.same_point_share * thin_m) {
      memory.impulse_ns = old->impulse_ns;
      memory.friction_ns = old->friction_ns;
    }
    next.push_back(memory);
  }
  std::ranges::sort(next, {}, [](const Memory& m) { return std::pair(m.body_a, m.body_b); });
  memories_ = std::move(next);
}

SoftMap::Side SoftMap::side(std::size_t body, const Vector3d& lever_m, const State& state) const {
  const Body& fact = run_.world.bodies[body];
  Side side;
  side.body = body;
  side.fixed = fact.fixed;
  side.lever = lever_m.cast<float>();
  if (fact.fixed) return side;
  side.inverse_mass = static_cast<float>(1.0 / fact.mass_kg);
  side.inverse_inertia = inverse_inertia(fact, state.orientation).cast<float>();
  return side;
}

// Effective masses: along the normal of the point, and the 2x2 inverse for its tangents.
void SoftMap::prepare(Row& row) const {
  const auto response = [&](const Vector& along, const Vector& other) {
    float sum = 0.0F;
    for (const Side* s : {&row.a, &row.b}) {
      sum += s->lever.cross(along).dot(s->inverse_inertia * s->lever.cross(other));
    }
    return sum;
  };
  const float inverse_mass = row.a.inverse_mass + row.b.inverse_mass;
  row.mass = 1.0F / (inverse_mass + response(row.normal, row.normal));
  Eigen::Index least = 0;
  row.normal.cwiseAbs().minCoeff(&least);
  row.tangent_1 = row.normal.cross(Vector::Unit(least)).normalized();
  row.tangent_2 = row.normal.cross(row.tangent_1);
  Eigen::Matrix2f k;
  k(0, 0) = inverse_mass + response(row.tangent_1, row.tangent_1);
  k(1, 1) = inverse_mass + response(row.tangent_2, row.tangent_2);
  k(0, 1) = k(1, 0) = response(row.tangent_1, row.tangent_2);
  row.friction_mass = k.inverse();
  row.friction_ns = {row.tangent_1.dot(row.memory->friction_ns),
                     row.tangent_2.dot(row.memory->friction_ns)};
}

// One row per contact that may close within the step, coloured greedily in the order of the pairs.
void SoftMap::make_rows(std::span<const State> states) {
  rows_.clear();
  std::vector<std::vector<int>> taken(states.size());
  for (Memory& memory : memories_) {
    const State& a = states[memory.body_a];
    const State& b = states[memory.body_b];
    const Vector3d on_a = a.orientation * memory.on_a_m;
    const Vector3d on_b = b.orientation * memory.on_b_m + b.position_m - a.position_m;
    const Vector3d normal = a.orientation * memory.normal_in_a;
    const Vector3d arm_a = 0.5 * (on_a + on_b);
    const Vector3d arm_b = arm_a - (b.position_m - a.position_m);
    const double gap_m = normal.dot(on_b - on_a);
    if (gap_m > soft_.margin_m + reach_m(memory.body_a, a) + reach_m(memory.body_b, b)) {
      memory.impulse_ns = 0.0F;
      memory.friction_ns.setZero();
      continue;
    }
    const ContactLaw law = contact_law(run_.world, memory.body_a, memory.body_b);
    Row row;
    row.memory = &memory;
    row.a = side(memory.body_a, arm_a, a);
    row.b = side(memory.body_b, arm_b, b);
    row.normal = normal.cast<float>();
    row.gap_m = row.gap_now_m = static_cast<float>(gap_m);
    row.impulse_ns = memory.impulse_ns;
    row.friction = static_cast<float>(law.friction);
    const double speed = normal.dot(b.velocity_mps + b.angular_velocity_radps.cross(arm_b) -
                                    a.velocity_mps - a.angular_velocity_radps.cross(arm_a));
    if (speed < -soft_.resting_approach_mps) {
      row.bounce_mps = static_cast<float>(-law.restitution * speed);
    }
    const auto used = [&](const Side& s) {
      return !s.fixed && std::ranges::count(taken[s.body], row.colour) > 0;
    };
    while (used(row.a) || used(row.b)) ++row.colour;
    for (const Side* s : {&row.a, &row.b}) taken[s->body].push_back(row.colour);
    prepare(row);
    rows_.push_back(row);
  }
  std::ranges::stable_sort(rows_, {}, &Row::colour);
}

// Single precision adds thousands of small changes, so how each is rounded is part of the scheme:
// products and sums are contracted, impulse times inverse mass first.
void SoftMap::push(const Row& row, const Vector& direction, float impulse_ns,
                   std::vector<Twist>& twists) {
  for (const auto& [s, signed_ns] :
       {std::pair(&row.a, -impulse_ns), std::pair(&row.b, impulse_ns)}) {
    if (s->fixed) continue;
    Twist& twist = twists[s->body];
    add(twist.linear, direction, signed_ns * s->inverse_mass);
    const Vector arm = s->lever.cross(direction);
    const Eigen::Matrix3f& i = s->inverse_inertia;
    add(twist.angular, {dot(i.row(0), arm), dot(i.row(1), arm), dot(i.row(2), arm)}, signed_ns);
  }
}

float SoftMap::slip(const Row& row, const Vector& direction, const std::vector<Twist>& twists) {
  const auto linear = [&](const Side& s) -> Vector {
    return s.fixed ? Vector(Vector::Zero()) : twists[s.body].linear;
  };
  const auto turning = [&](const Side& s) {
    return s.fixed ? 0.0F : dot(s.lever.cross(direction), twists[s.body].angular);
  };
  return dot(direction, linear(row.b) - linear(row.a)) + (turning(row.b) - turning(row.a));
}

// E. Catto, Solver2D, 2024: an overlap is a damped spring in the biased sweep and rigid in the
// relaxing one; an open gap may close within the sub-step in both. Then friction in its cone.
void SoftMap::serve(Row& row, bool biased) {
  const double h = run_.step_s / soft_.substeps;
  const double omega = std::min(2.0 * std::numbers::pi * soft_.frequency_hz, 1.0 / h);
  const double damping = 2.0 * soft_.damping_ratio + h * omega;
  const double forget = 1.0 / (1.0 + h * omega * damping);
  if (!biased) row.gap_now_m = row.gap_m + slip(row, row.normal, moved_);
  float bias_mps = row.gap_now_m / static_cast<float>(h);
  float mass_share = 1.0F, impulse_share = 0.0F;
  if (!(row.gap_now_m > 0.0F)) {
    bias_mps = biased ? std::max(static_cast<float>(omega / damping) * row.gap_now_m,
                                 -static_cast<float>(soft_.push_limit_mps))
                      : 0.0F;
    mass_share = biased ? static_cast<float>(1.0 - forget) : 1.0F;
    impulse_share = biased ? static_cast<float>(forget) : 0.0F;
  }
  const float wanted = std::fma(row.mass * mass_share, slip(row, row.normal, velocity_) + bias_mps,
                                impulse_share * row.impulse_ns);
  const float next = std::max(row.impulse_ns - wanted, 0.0F);
  push(row, row.normal, next - row.impulse_ns, velocity_);
  row.impulse_ns = next;
  row.largest_ns = std::max(row.largest_ns, next);
  const float slip_1 = slip(row, row.tangent_1, velocity_);
  const float slip_2 = slip(row, row.tangent_2, velocity_);
  const auto& k = row.friction_mass;
  Eigen::Vector2f friction = {row.friction_ns.x() - std::fma(k(0, 0), slip_1, k(0, 1) * slip_2),
                              row.friction_ns.y() - std::fma(k(1, 1), slip_2, k(0, 1) * slip_1)};
  const float limit = row.friction * next;
  if (friction.norm() > limit) friction *= limit / friction.norm();
  const Eigen::Vector2f change = friction - row.friction_ns;
  row.friction_ns = friction;
  push(row, row.tangent_1, change.x(), velocity_);
  push(row, row.tangent_2, change.y(), velocity_);
}

void SoftMap::sweep(bool biased, bool forwards) {
  if (forwards) {
    for (Row& row : rows_) serve(row, biased);
  } else {
    for (std::size_t i = rows_.size(); i-- > 0;) serve(rows_[i], biased);
  }
}

// Newton's law for the contacts that were struck during the step.
void SoftMap::bounce() {
  for (Row& row : rows_) {
    if (!(row.bounce_mps > 0.0F) || !(row.largest_ns > 0.0F)) continue;
    const float lacking = slip(row, row.normal, velocity_) - row.bounce_mps;
    const float next = std::max(row.impulse_ns - row.mass * lacking, 0.0F);
    push(row, row.normal, next - row.impulse_ns, velocity_);
    row.impulse_ns = next;
  }
}

// Bodies that a contact pushed take what the sub-steps gave; the others fly freely.
void SoftMap::finish(std::span<const Wrench> wrenches, std::span<State> states) {
  std::vector<bool> touched(states.size(), false);
  for (const Row& row : rows_) {
    row.memory->impulse_ns = row.impulse_ns;
    row.memory->friction_ns =
        row.friction_ns.x() * row.tangent_1 + row.friction_ns.y() * row.tangent_2;
    if (row.largest_ns > 0.0F) touched[row.a.body] = touched[row.b.body] = true;
  }
  for (std::size_t i = 0; i < states.size(); ++i) {
    const Body& body = run_.world.bodies[i];
    if (body.fixed) continue;
    State& s = states[i];
    if (!touched[i]) {
      s = next_free_state(scheme_, body, s, wrenches[i], run_.world.gravity_mps2, run_.step_s);
      continue;
    }
    const Vector3d spin = velocity_[i].angular.cast<double>();
    const Vector3d momentum =
        s.orientation * body.inertia_kgm2.cwiseProduct(s.orientation.conjugate() * spin);
    s.position_m += moved_[i].linear.cast<double>();
    s.velocity_mps = velocity_[i].linear.cast<double>();
    s.orientation = (rotation_of(moved_[i].angular.cast<double>()) * s.orientation).normalized();
    s.angular_velocity_radps = inverse_inertia(body, s.orientation) * momentum;
  }
}

bool SoftMap::advance(std::span<const Wrench> wrenches, const std::vector<PointContact>& contacts,
                      std::span<State> states, std::string& why) {
  if (std::ranges::any_of(contacts, [](const PointContact& c) { return c.points > 1; })) {
    why = "one sweep serves the points of a face one after the other; their order is not stated";
    return false;
  }
  remember(contacts, states);
  make_rows(states);
  const double h = run_.step_s / soft_.substeps;
  std::vector<Twist> carried(states.size()), free(states.size());
  for (const Row& row : rows_) {
    push(row, row.normal, row.impulse_ns, carried);
    push(row, row.tangent_1, row.friction_ns.x(), carried);
    push(row, row.tangent_2, row.friction_ns.y(), carried);
  }
  for (std::size_t i = 0; i < states.size(); ++i) {
    moved_[i] = {};
    const Body& body = run_.world.bodies[i];
    if (body.fixed) continue;
    velocity_[i] = {states[i].velocity_mps.cast<float>(),
                    states[i].angular_velocity_radps.cast<float>()};
    const Vector3d pull = run_.world.gravity_mps2 + wrenches[i].force_n / body.mass_kg;
    const Vector3d turn = inverse_inertia(body, states[i].orientation) * wrenches[i].torque_nm;
    free[i] = {(h * pull).cast<float>(), (h * turn).cast<float>()};
  }
  const auto for_twists = [&](auto change) {
    for (std::size_t i = 0; i < states.size(); ++i) {
      if (!run_.world.bodies[i].fixed) change(i);
    }
  };
  for (int s = 0; s < soft_.substeps; ++s) {
    for_twists([&](std::size_t i) {
      const Twist flown = {velocity_[i].linear + free[i].linear,
                           velocity_[i].angular + free[i].angular};
      velocity_[i] = {flown.linear + carried[i].linear, flown.angular + carried[i].angular};
      carried[i] = flown;
    });
    sweep(true, s % 2 == 0);
    for_twists([&](std::size_t i) {
      moved_[i].linear += static_cast<float>(h) * velocity_[i].linear;
      moved_[i].angular += static_cast<float>(h) * velocity_[i].angular;
    });
    sweep(false, s % 2 != 0);
    for_twists([&](std::size_t i) {
      carried[i] = {velocity_[i].linear - carried[i].linear,
                    velocity_[i].angular - carried[i].angular};
    });
  }
  bounce();
  finish(wrenches, states);
  return true;
}

}  // namespace brickbench::exact
