#include "ourengine/fast/rebound.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

namespace ourengine {
namespace {

constexpr int k_row_rounds = 64;
// Of what is enough between rows, and of what the first round changed: enough within one.
constexpr double k_row_share = 0.1;
constexpr double k_round_share = 0.01;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

using Row4 = std::array<double, ReboundRow::k_points>;

double response(const ReboundRow& row, std::size_t p, std::size_t q) {
  return row.inverse_mass_a + row.inverse_mass_b + row.arm_a[p].dot(row.turn_a[q]) +
         row.arm_b[p].dot(row.turn_b[q]);
}

// How fast each point separates beyond its target.
Row4 surplus_mps(const ReboundRow& row, const Twist& a, const Twist& b) {
  Row4 surplus{};
  const double apart = row.normal.dot(b.linear - a.linear);
  for (std::size_t p = 0; p < row.count; ++p) {
    surplus[p] =
        apart + row.arm_b[p].dot(b.angular) - row.arm_a[p].dot(a.angular) - row.target_mps[p];
  }
  return surplus;
}

void push(const ReboundRow& row, const Row4& change_ns, Twist& a, Twist& b) {
  double sum_ns = 0.0;
  for (std::size_t p = 0; p < row.count; ++p) {
    sum_ns += change_ns[p];
    a.angular -= change_ns[p] * row.turn_a[p];
    b.angular += change_ns[p] * row.turn_b[p];
  }
  a.linear -= sum_ns * row.inverse_mass_a * row.normal;
  b.linear += sum_ns * row.inverse_mass_b * row.normal;
}

// Solves the row with everything else held. Returns by how much a point's velocity changed.
double settle_row(ReboundRow& row, double enough_mps, Twist& a, Twist& b) {
  const Row4 before = surplus_mps(row, a, b);
  Row4 now = before;
  Row4 change{};
  const auto& matrix = row.response;
  double stop_mps = k_row_share * enough_mps;
  for (int round = 0; round < k_row_rounds; ++round) {
    double largest_mps = 0.0;
    for (std::size_t p = 0; p < row.count; ++p) {
      const double old_ns = row.impulse_ns[p];
      row.impulse_ns[p] = std::max(row.least_ns[p], old_ns - now[p] / matrix[p][p]);
      const double step_ns = row.impulse_ns[p] - old_ns;
      change[p] += step_ns;
      for (std::size_t q = 0; q < row.count; ++q) now[q] += matrix[q][p] * step_ns;
      largest_mps = std::max(largest_mps, std::abs(step_ns) * matrix[p][p]);
    }
    if (round == 0) stop_mps = std::max(stop_mps, k_round_share * largest_mps);
    if (largest_mps <= stop_mps) break;
  }
  push(row, change, a, b);
  double changed_mps = 0.0;
  for (std::size_t p = 0; p < row.count; ++p) {
    changed_mps = std::max(changed_mps, std::abs(now[p] - before[p]));
  }
  return changed_mps;
}

// The motion of one rigid body that has the momentum and the angular momentum of all members.
struct RigidMotion {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  Twist velocity;
};

RigidMotion rigid_motion(std::span<const GroupMember> members) {
  RigidMotion rigid;
  double mass_kg = 0.0;
  for (const GroupMember& m : members) {
    mass_kg += m.mass_kg;
    rigid.centre_m += m.mass_kg * m.position_m;
    rigid.velocity.linear += m.mass_kg * m.velocity.linear;
  }
  rigid.centre_m /= mass_kg;
  rigid.velocity.linear /= mass_kg;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
  for (const GroupMember& m : members) {
    const Eigen::Vector3d r = m.position_m - rigid.centre_m;
    inertia += m.inertia_kgm2 +
               m.mass_kg * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
    momentum += m.inertia_kgm2 * m.velocity.angular +
                m.mass_kg * r.cross(m.velocity.linear - rigid.velocity.linear);
  }
  rigid.velocity.angular = inertia.ldlt().solve(momentum);
  return rigid;
}

double kinetic_j(const GroupMember& m, const Twist& velocity) {
  return 0.5 * m.mass_kg * velocity.linear.squaredNorm() +
         0.5 * velocity.angular.dot(m.inertia_kgm2 * velocity.angular);
}

}  // namespace

double settle_rebound(std::span<ReboundRow> rows, double enough_mps, std::span<Twist> velocity) {
  for (ReboundRow& row : rows) {
    for (std::size_t p = 0; p < row.count; ++p) {
      for (std::size_t q = 0; q < row.count; ++q) row.response[p][q] = response(row, p, q);
    }
  }
  std::vector<int> changed_in(velocity.size(), 0);  // the last sweep that moved the body
  double changed_mps = 0.0;
  for (int sweep = 1; sweep <= k_rebound_sweeps; ++sweep) {
    changed_mps = 0.0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      ReboundRow& row = rows[sweep % 2 == 1 ? k : rows.size() - 1 - k];
      if (changed_in[at(row.body_a)] < sweep - 1 && changed_in[at(row.body_b)] < sweep - 1) {
        continue;
      }
      const double change_mps =
          settle_row(row, enough_mps, velocity[at(row.body_a)], velocity[at(row.body_b)]);
      if (change_mps <= enough_mps) continue;
      changed_mps = std::max(changed_mps, change_mps);
      if (row.inverse_mass_a > 0.0) changed_in[at(row.body_a)] = sweep;
      if (row.inverse_mass_b > 0.0) changed_in[at(row.body_b)] = sweep;
    }
    if (changed_mps == 0.0) break;
  }
  return changed_mps;
}

double limit_energy(std::span<GroupMember> members, bool grounded, double allowed_j) {
  const RigidMotion rigid = grounded ? RigidMotion{} : rigid_motion(members);
  const auto shared = [&](const GroupMember& m) -> Twist {
    const Eigen::Vector3d r = m.position_m - rigid.centre_m;
    return {rigid.velocity.linear + rigid.velocity.angular.cross(r), rigid.velocity.angular};
  };
  double common_j = 0.0;
  double relative_j = 0.0;
  for (const GroupMember& m : members) {
    const Twist with = shared(m);
    common_j += kinetic_j(m, with);
    relative_j +=
        kinetic_j(m, {m.velocity.linear - with.linear, m.velocity.angular - with.angular});
  }
  if (common_j + relative_j <= allowed_j) return 0.0;
  const double scale =
      relative_j > 0.0 ? std::sqrt(std::clamp((allowed_j - common_j) / relative_j, 0.0, 1.0)) : 0.0;
  for (GroupMember& m : members) {
    const Twist with = shared(m);
    m.velocity.linear = with.linear + scale * (m.velocity.linear - with.linear);
    m.velocity.angular = with.angular + scale * (m.velocity.angular - with.angular);
  }
  return relative_j * (1.0 - scale * scale);
}

}  // namespace ourengine
