#include "ourengine/contact/system.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <compare>
#include <cstdint>
#include <numeric>
#include <utility>

namespace ourengine {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

void multiply_blocks(const AlignedDoubles& blocks, int bodies, const AlignedDoubles& x,
                     AlignedDoubles& y) {
  y.resize(x.size());
  for (int i = 0; i < bodies; ++i) {
    const double* block = blocks.data() + at(kBlockSize) * at(i);
    const double* in = x.data() + at(kBodyStride) * at(i);
    double* out = y.data() + at(kBodyStride) * at(i);
    double sum[6];
    for (int r = 0; r < 3; ++r) {  // linear part diagonal, angular part 3x3
      sum[r] = block[9 * r] * in[r];
      sum[3 + r] =
          block[24 + 3 + r] * in[3] + block[32 + 3 + r] * in[4] + block[40 + 3 + r] * in[5];
    }
    std::copy_n(sum, 6, out);
    out[6] = out[7] = 0.0;
  }
  std::fill(y.begin() + kBodyStride * bodies, y.end(), 0.0);
}

void store_block(double linear, const Eigen::Matrix3d& angular, double* block) {
  for (int r = 0; r < 3; ++r) {
    block[9 * r] = linear;
    for (int c = 0; c < 3; ++c) block[8 * (3 + c) + 3 + r] = angular(r, c);
  }
}

// One side of a row of J and of M^-1 J^T; returns their product. inverse: a block of M^-1.
double fill_row(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular,
                const double* inverse, double* row, double* inverse_row) {
  double product = 0.0;
  for (int r = 0; r < 3; ++r) {
    row[r] = linear[r];
    inverse_row[r] = inverse[0] * linear[r];
    product += inverse_row[r] * linear[r];
  }
  for (int r = 0; r < 3; ++r) {
    row[3 + r] = angular[r];
    inverse_row[3 + r] = inverse[24 + 3 + r] * angular[0] + inverse[32 + 3 + r] * angular[1] +
                         inverse[40 + 3 + r] * angular[2];
    product += inverse_row[3 + r] * angular[r];
  }
  return product;
}

// |v| + |omega| |arm|: no less than the speed of the body's point at the arm, and free of the
// cancellation in v + omega x arm.
double point_speed_mps(const Velocity6& velocity, const Eigen::Vector3d& arm_m) {
  return velocity.head<3>().norm() + velocity.tail<3>().norm() * arm_m.norm();
}

// The scale of residuals; see ContactSystem::scale_mps.
double largest_speed_mps(const ContactProblem& problem) {
  double largest = problem.least_speed_mps;
  for (const ProblemContact& contact : problem.contacts) {
    const Velocity6& a = problem.free_velocity[at(contact.body_a)];
    const Velocity6& b = problem.free_velocity[at(contact.body_b)];
    const double demanded =
        std::max(0.0, -normal_bias_mps(contact, problem.step_s, problem.recovery_mps));
    largest = std::max(largest, point_speed_mps(a, contact.arm_a_m) +
                                    point_speed_mps(b, contact.arm_b_m) + demanded);
  }
  return largest > 0.0 ? largest : 1.0;
}

}  // namespace

ContactSystem::ContactSystem(const ContactProblem& problem, int components, SymbolicCache& cache) {
  view_.components = components;
  number_bodies(problem, cache);
  fill_bodies(problem);
  order_contacts(problem);
  set_view();
  fill_contacts(problem);
  fill_targets();
  fill_front_pairs();
  fill_sides();
  set_view();
  scale_mps_ = largest_speed_mps(problem);
}

void ContactSystem::number_bodies(const ContactProblem& problem, SymbolicCache& cache) {
  std::vector<int> dynamic(problem.bodies.size(), -1);
  BodyGraph graph;
  for (std::size_t i = 0; i < problem.bodies.size(); ++i) {
    if (!problem.bodies[i].fixed) dynamic[i] = graph.bodies++;
  }
  for (const ProblemContact& contact : problem.contacts) {
    const int a = dynamic[at(contact.body_a)];
    const int b = dynamic[at(contact.body_b)];
    if (a >= 0 && b >= 0 &&
        (graph.edges.empty() || graph.edges.back() != std::pair(std::min(a, b), std::max(a, b))))
      graph.edges.emplace_back(std::min(a, b), std::max(a, b));
  }
  std::sort(graph.edges.begin(), graph.edges.end());
  graph.edges.erase(std::unique(graph.edges.begin(), graph.edges.end()), graph.edges.end());
  symbolic_ = cache.find_or_analyse(graph);
  view_.bodies = graph.bodies;
  slot_.resize(problem.bodies.size());
  for (std::size_t i = 0; i < dynamic.size(); ++i)
    slot_[i] = dynamic[i] >= 0 ? symbolic_->position[at(dynamic[i])] : graph.bodies;
}

void ContactSystem::fill_bodies(const ContactProblem& problem) {
  mass_.assign(at(kBlockSize) * at(view_.bodies), 0.0);
  inverse_mass_ = mass_;
  free_velocity_.assign(at(kBodyStride) * at(view_.bodies + 1), 0.0);
  for (std::size_t i = 0; i < problem.bodies.size(); ++i) {
    const ProblemBody& body = problem.bodies[i];
    if (body.fixed) continue;
    const std::size_t slot = at(slot_[i]);
    store_block(body.mass_kg, body.inertia_kgm2, mass_.data() + at(kBlockSize) * slot);
    store_block(1.0 / body.mass_kg, body.inertia_kgm2.inverse(),
                inverse_mass_.data() + at(kBlockSize) * slot);
    std::copy_n(problem.free_velocity[i].data(), 6, free_velocity_.data() + at(kBodyStride) * slot);
  }
}

// Contacts by pair of bodies, in the caller's order within a pair.
void ContactSystem::order_contacts(const ContactProblem& problem) {
  struct Key {
    std::uint64_t pair;
    int contact;
    auto operator<=>(const Key&) const = default;
  };
  const auto slots = [&](int i) {
    const ProblemContact& c = problem.contacts[at(i)];
    return std::pair(slot_[at(c.body_a)], slot_[at(c.body_b)]);
  };
  std::vector<Key> keys;
  keys.reserve(problem.contacts.size());
  for (int i = 0; i < static_cast<int>(problem.contacts.size()); ++i) {
    const auto [a, b] = slots(i);
    if (a == view_.bodies && b == view_.bodies) continue;
    keys.push_back({static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint64_t>(b), i});
  }
  std::sort(keys.begin(), keys.end());
  contact_order_.reserve(keys.size());
  std::vector<int> internal(problem.contacts.size(), -1);
  for (const Key& key : keys) {
    internal[at(key.contact)] = static_cast<int>(contact_order_.size());
    contact_order_.push_back(key.contact);
  }
  sweep_order_.reserve(keys.size());
  for (const int i : internal) {
    if (i >= 0) sweep_order_.push_back(i);
  }
  view_.contacts = static_cast<int>(contact_order_.size());
  view_.stride = (view_.contacts + 7) / 8 * 8;
  for (int i = 0; i < view_.contacts; ++i) {
    const auto [a, b] = slots(contact_order_[at(i)]);
    if (pairs_.empty() || pairs_.back().body_a != a || pairs_.back().body_b != b)
      pairs_.push_back({a, b, i, i});
    pairs_.back().end = i + 1;
  }
}

void ContactSystem::fill_contacts(const ContactProblem& problem) {
  const std::size_t n = stride();
  geometry_.assign(15 * n, 0.0);
  rows_.assign(16 * at(components()) * at(contacts()), 0.0);
  inverse_rows_.assign(rows_.size(), 0.0);
  bias_.assign(n, 0.0);
  tangent_bias_.assign(2 * n, 0.0);
  friction_.assign(n, 0.0);
  delassus_.assign(n, 1.0);
  const std::int64_t nowhere = kBodyStride * view_.bodies;
  offset_a_.assign(n, nowhere);
  offset_b_.assign(n, nowhere);
  for (int i = 0; i < contacts(); ++i) fill_contact(problem, i);
}

void ContactSystem::fill_contact(const ContactProblem& problem, int internal) {
  const std::size_t n = stride();
  const std::size_t i = at(internal);
  const ProblemContact& contact = problem.contacts[at(contact_order_[i])];
  const Eigen::Vector3d* frame[3] = {&contact.normal, &contact.tangent_1, &contact.tangent_2};
  const int slots[2] = {slot_[at(contact.body_a)], slot_[at(contact.body_b)]};
  offset_a_[i] = kBodyStride * slots[0];
  offset_b_[i] = kBodyStride * slots[1];
  friction_[i] = contact.friction;
  for (int c = 0; c < 3; ++c) {
    for (int k = 0; k < 3; ++k) geometry_[at(3 * k + c) * n + i] = (*frame[k])[c];
    geometry_[at(9 + c) * n + i] = contact.arm_a_m[c];
    geometry_[at(12 + c) * n + i] = contact.arm_b_m[c];
  }
  bias_[i] = normal_bias_mps(contact, problem.step_s, problem.recovery_mps);
  for (int k = 0; k < components(); ++k) {
    const Eigen::Vector3d& direction = *frame[k];
    const Eigen::Vector3d moments[2] = {contact.arm_a_m.cross(direction),
                                        contact.arm_b_m.cross(direction)};
    double diagonal = 0.0;
    for (int side = 0; side < 2; ++side) {
      const double sign = side == 0 ? -1.0 : 1.0;
      if (slots[side] == view_.bodies) {  // fixed: a prescribed velocity is part of the bias
        const int body = side == 0 ? contact.body_a : contact.body_b;
        Velocity6 part;
        part << sign * direction, sign * moments[side];
        const double moved = part.dot(problem.free_velocity[at(body)]);
        (k == 0 ? bias_[i] : tangent_bias_[at(k - 1) * n + i]) += moved;
        continue;
      }
      const std::size_t offset = 16 * (i * at(components()) + at(k)) + at(8 * side);
      diagonal += fill_row(sign * direction, sign * moments[side],
                           inverse_mass_.data() + at(kBlockSize) * at(slots[side]),
                           rows_.data() + offset, inverse_rows_.data() + offset);
    }
    if (k == 0) delassus_[i] = diagonal;
  }
}

void ContactSystem::fill_targets() {
  const BlockPattern& pattern = symbolic_->pattern;
  for (const ContactPair& pair : pairs_) {
    PairTarget target;
    if (pair.body_a < bodies()) target.diagonal_a = pattern.column_begin[at(pair.body_a)];
    if (pair.body_b < bodies()) target.diagonal_b = pattern.column_begin[at(pair.body_b)];
    if (pair.body_a < bodies() && pair.body_b < bodies()) {
      const auto [column, row] = std::minmax(pair.body_a, pair.body_b);
      const auto begin = pattern.row.begin() + pattern.column_begin[at(column)];
      const auto end = pattern.row.begin() + pattern.column_begin[at(column + 1)];
      target.off_diagonal =
          static_cast<int>(std::lower_bound(begin, end, row) - pattern.row.begin());
      target.a_below = pair.body_a > pair.body_b;
    }
    targets_.push_back(target);
  }
}

// Pairs of moving bodies by the front that eliminates the first of them, in their order.
void ContactSystem::fill_front_pairs() {
  const FrontPattern& fronts = symbolic_->fronts;
  const auto both_move = [&](const ContactPair& pair) {
    return std::max(pair.body_a, pair.body_b) < bodies();
  };
  const auto front_of = [&](const ContactPair& pair) {
    return at(fronts.front_of_column[at(std::min(pair.body_a, pair.body_b))]);
  };
  front_pair_begin_.assign(fronts.front.size() + 1, 0);
  for (const ContactPair& pair : pairs_) {
    if (both_move(pair)) ++front_pair_begin_[front_of(pair) + 1];
  }
  std::partial_sum(front_pair_begin_.begin(), front_pair_begin_.end(), front_pair_begin_.begin());
  std::vector<int> next = front_pair_begin_;
  front_pairs_.resize(at(front_pair_begin_.back()));
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    if (!both_move(pairs_[p])) continue;
    const auto [earlier, later] = std::minmax(pairs_[p].body_a, pairs_[p].body_b);
    const std::size_t index = front_of(pairs_[p]);
    const Front& front = fronts.front[index];
    const auto begin = fronts.row.begin() + front.row_begin;
    const auto row = std::lower_bound(begin, begin + front.rows, later) - begin;
    front_pairs_[at(next[index]++)] = {static_cast<int>(p), static_cast<int>(row),
                                       earlier - front.first, pairs_[p].body_a == later};
  }
}

// The pairs of each body, in their order.
void ContactSystem::fill_sides() {
  side_begin_.assign(at(bodies()) + 2, 0);  // the last: everything fixed
  for (const ContactPair& pair : pairs_) {
    ++side_begin_[at(pair.body_a) + 1];
    ++side_begin_[at(pair.body_b) + 1];
  }
  std::partial_sum(side_begin_.begin(), side_begin_.end(), side_begin_.begin());
  std::vector<int> next = side_begin_;
  sides_.resize(2 * pairs_.size());
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    sides_[at(next[at(pairs_[p].body_a)]++)] = {static_cast<int>(p), false};
    sides_[at(next[at(pairs_[p].body_b)]++)] = {static_cast<int>(p), true};
  }
}

void ContactSystem::set_view() {
  view_.geometry = geometry_.data();
  view_.offset_a = offset_a_.data();
  view_.offset_b = offset_b_.data();
  view_.rows = rows_.data();
  view_.bias = bias_.data();
  view_.tangent_bias = tangent_bias_.data();
  view_.pairs = pairs_.data();
  view_.pair_count = static_cast<int>(pairs_.size());
  view_.mass = mass_.data();
}

void ContactSystem::multiply_mass(const AlignedDoubles& x, AlignedDoubles& y) const {
  multiply_blocks(mass_, bodies(), x, y);
}

void ContactSystem::multiply_inverse_mass(const AlignedDoubles& x, AlignedDoubles& y) const {
  multiply_blocks(inverse_mass_, bodies(), x, y);
}

void ContactSystem::velocity_of(const AlignedDoubles& f, AlignedDoubles& v) const {
  AlignedDoubles momentum(body_doubles(), 0.0);
  simd_kernels().multiply_jt(view_, f.data(), momentum.data());
  multiply_inverse_mass(momentum, v);
  for (std::size_t i = 0; i < v.size(); ++i) v[i] += free_velocity_[i];
}

void ContactSystem::load_impulses(std::span<const Eigen::Vector3d> impulses_ns,
                                  AlignedDoubles& f) const {
  f.assign(rows(), 0.0);
  if (impulses_ns.empty()) return;
  for (std::size_t i = 0; i < contact_order_.size(); ++i) {
    for (int k = 0; k < components(); ++k)
      f[at(k) * stride() + i] = impulses_ns[at(contact_order_[i])][k];
  }
}

void ContactSystem::store(const AlignedDoubles& f, const AlignedDoubles& v,
                          const ContactProblem& problem, ContactSolution& solution) const {
  solution.impulse_ns.assign(problem.contacts.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < contact_order_.size(); ++i) {
    for (int k = 0; k < components(); ++k)
      solution.impulse_ns[at(contact_order_[i])][k] = f[at(k) * stride() + i];
  }
  solution.velocity = problem.free_velocity;
  for (std::size_t i = 0; i < problem.bodies.size(); ++i) {
    if (problem.bodies[i].fixed) continue;
    std::copy_n(v.data() + at(kBodyStride) * at(slot_[i]), 6, solution.velocity[i].data());
  }
}

}  // namespace ourengine
