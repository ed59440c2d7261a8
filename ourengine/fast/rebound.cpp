#include "ourengine/fast/rebound.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

namespace ourengine {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

using Row4 = std::array<double, ReboundRow::k_points>;

using Arm = ReboundRow::Arm;

double turning(const Arm& arm, const Twist& a, const Twist& b) {
  return arm.on_b.dot(b.angular) - arm.on_a.dot(a.angular);
}

// Of the velocity along one direction to an impulse along another, their cosine given.
double response(const ReboundRow& row, double cosine, const Arm& felt, const Arm& pushed) {
  return cosine * (row.inverse_mass_a + row.inverse_mass_b) + felt.on_a.dot(pushed.turn_a) +
         felt.on_b.dot(pushed.turn_b);
}

void prepare(ReboundRow& row) {
  for (std::size_t p = 0; p < row.count; ++p) {
    for (std::size_t q = 0; q < row.count; ++q) {
      row.response[p][q] = response(row, 1.0, row.point[p], row.point[q]);
    }
  }
  if (row.friction == 0.0) return;
  const double across = response(row, 0.0, row.slide[0], row.slide[1]);
  row.slide_response << response(row, 1.0, row.slide[0], row.slide[0]), across, across,
      response(row, 1.0, row.slide[1], row.slide[1]);
  row.slide_mass = row.slide_response.inverse();
  const Eigen::Matrix2d& m = row.slide_mass;
  row.least_slide_mass =
      0.5 * m.trace() - Eigen::Vector2d(0.5 * (m(0, 0) - m(1, 1)), m(0, 1)).norm();
}

// How fast each point separates beyond its target.
Row4 surplus_mps(const ReboundRow& row, const Twist& a, const Twist& b) {
  Row4 surplus{};
  const double apart = row.normal.dot(b.linear - a.linear);
  for (std::size_t p = 0; p < row.count; ++p) {
    surplus[p] = apart + turning(row.point[p], a, b) - row.target_mps[p];
  }
  return surplus;
}

void turn(const Arm& arm, double impulse, Twist& a, Twist& b) {
  a.angular -= impulse * arm.turn_a;
  b.angular += impulse * arm.turn_b;
}

void shift(const ReboundRow& row, const Eigen::Vector3d& impulse_ns, Twist& a, Twist& b) {
  a.linear -= row.inverse_mass_a * impulse_ns;
  b.linear += row.inverse_mass_b * impulse_ns;
}

// Newton's law for the row with everything else held. Returns by how much a point's velocity
// changed.
double settle_normals(ReboundRow& row, double enough_mps, Twist& a, Twist& b) {
  const Row4 before = surplus_mps(row, a, b);
  Row4 now = before;
  Row4 change{};
  const auto& matrix = row.response;
  double stop_mps = k_row_share * enough_mps;
  for (int round = 0; round < k_row_rounds; ++round) {
    double largest_mps = 0.0;
    for (std::size_t p = 0; p < row.count; ++p) {
      const double old_ns = row.impulse_ns[p];
      row.impulse_ns[p] = std::max(0.0, old_ns - now[p] / matrix[p][p]);
      const double step_ns = row.impulse_ns[p] - old_ns;
      change[p] += step_ns;
      for (std::size_t q = 0; q < row.count; ++q) now[q] += matrix[q][p] * step_ns;
      largest_mps = std::max(largest_mps, std::abs(step_ns) * matrix[p][p]);
    }
    if (round == 0) stop_mps = std::max(stop_mps, k_round_share * largest_mps);
    if (largest_mps <= stop_mps) break;
  }
  double sum_ns = 0.0, changed_mps = 0.0;
  for (std::size_t p = 0; p < row.count; ++p) {
    sum_ns += change[p];
    turn(row.point[p], change[p], a, b);
    changed_mps = std::max(changed_mps, std::abs(now[p] - before[p]));
  }
  shift(row, sum_ns * row.normal, a, b);
  return changed_mps;
}

// Coulomb's law likewise, under the normal impulses that the row has. What slips is held against
// the slip, so the step has one mass: the least of any direction.
double settle_friction(ReboundRow& row, Twist& a, Twist& b) {
  double load_ns = 0.0;
  for (std::size_t p = 0; p < row.count; ++p) load_ns += row.impulse_ns[p];
  const double limit_ns = row.friction * load_ns;
  const Eigen::Vector3d relative = b.linear - a.linear;
  const Eigen::Vector2d slip(row.tangent[0].dot(relative) + turning(row.slide[0], a, b),
                             row.tangent[1].dot(relative) + turning(row.slide[1], a, b));
  const Eigen::Vector2d old_ns(row.friction_ns[0], row.friction_ns[1]);
  Eigen::Vector2d next_ns = old_ns - row.least_slide_mass * slip;
  if (next_ns.norm() > limit_ns) {
    next_ns = old_ns - row.least_slide_mass * slip;
    const double length_ns = next_ns.norm();
    if (length_ns > limit_ns) next_ns *= limit_ns / length_ns;
  }
  const Eigen::Vector2d change_ns = next_ns - old_ns;
  for (std::size_t k = 0; k < 2; ++k) {
    row.friction_ns[k] = next_ns[static_cast<Eigen::Index>(k)];
    turn(row.slide[k], change_ns[static_cast<Eigen::Index>(k)], a, b);
  }
  shift(row, change_ns[0] * row.tangent[0] + change_ns[1] * row.tangent[1], a, b);
  const double give = row.normal.dot(row.twist.turn_a + row.twist.turn_b);
  const double spin = row.normal.dot(b.angular - a.angular);
  const double most_nms = limit_ns * row.twist_arm_m;
  const double twist_nms = give > 0.0 ? row.twist_nms - spin / give : 0.0;
  const double twist_change_nms = std::clamp(twist_nms, -most_nms, most_nms) - row.twist_nms;
  row.twist_nms += twist_change_nms;
  turn(row.twist, twist_change_nms, a, b);
  return std::max((row.slide_response * change_ns).norm(),
                  std::abs(twist_change_nms) * give * row.twist_arm_m);
}

// Carries impulses and velocities on along what two sweeps changed, the further the longer this
// goes well; begins anew where a sweep changed much more than the one before.
class Extrapolation {
 public:
  // Marks the bodies that it moved as changed in this sweep.
  void carry_on(double changed_mps, int sweep, std::span<ReboundRow> rows,
                std::span<Twist> velocity, std::span<int> changed_in) {
    const double share = next_share(changed_mps);
    given_.resize(rows.size());
    velocity_.resize(velocity.size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
      ReboundRow& row = rows[k];
      const Given now = {row.impulse_ns, row.friction_ns, row.twist_nms};
      if (share > 0.0 && now != given_[k]) {
        for (std::size_t p = 0; p < row.count; ++p) {
          row.impulse_ns[p] += share * (now.normal_ns[p] - given_[k].normal_ns[p]);
        }
        for (std::size_t t = 0; t < 2; ++t) {
          row.friction_ns[t] += share * (now.friction_ns[t] - given_[k].friction_ns[t]);
        }
        row.twist_nms += share * (now.twist_nms - given_[k].twist_nms);
        if (row.inverse_mass_a > 0.0) changed_in[at(row.body_a)] = sweep;
        if (row.inverse_mass_b > 0.0) changed_in[at(row.body_b)] = sweep;
      }
      given_[k] = now;
    }
    for (std::size_t i = 0; i < velocity.size(); ++i) {
      const Twist now = velocity[i];
      if (share > 0.0) {
        velocity[i].linear += share * (now.linear - velocity_[i].linear);
        velocity[i].angular += share * (now.angular - velocity_[i].angular);
      }
      velocity_[i] = now;
    }
  }

 private:
  struct Given {
    Row4 normal_ns{};
    std::array<double, 2> friction_ns{};
    double twist_nms = 0.0;
    bool operator==(const Given&) const = default;
  };

  // 0 the first time, and where it begins anew.
  double next_share(double changed_mps) {
    const bool anew = given_.empty() || changed_mps > k_restart_growth * changed_mps_;
    changed_mps_ = changed_mps;
    const double pace = anew ? 1.0 : pace_;
    pace_ = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * pace * pace));
    return (pace - 1.0) / pace_;
  }

  double pace_ = 1.0;
  double changed_mps_ = 0.0;
  std::vector<Given> given_;
  std::vector<Twist> velocity_;
};

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

Settling settle_rebound(std::span<ReboundRow> rows, double fastest_mps, std::span<Twist> velocity) {
  for (ReboundRow& row : rows) prepare(row);
  std::vector<int> changed_in(velocity.size(), 0);  // the last sweep that moved the body
  Extrapolation extrapolation;
  Settling settling;
  double scale_mps = fastest_mps;
  for (int sweep = 1; sweep <= k_most_rebound_sweeps; ++sweep) {
    const double enough_mps = k_rebound_share * scale_mps;
    double changed_mps = 0.0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      ReboundRow& row = rows[sweep % 2 == 1 ? k : rows.size() - 1 - k];
      if (changed_in[at(row.body_a)] < sweep - 1 && changed_in[at(row.body_b)] < sweep - 1) {
        continue;
      }
      Twist& a = velocity[at(row.body_a)];
      Twist& b = velocity[at(row.body_b)];
      double change_mps = settle_normals(row, enough_mps, a, b);
      if (row.friction > 0.0) change_mps = std::max(change_mps, settle_friction(row, a, b));
      if (change_mps <= enough_mps) continue;
      changed_mps = std::max(changed_mps, change_mps);
      if (row.inverse_mass_a > 0.0) changed_in[at(row.body_a)] = sweep;
      if (row.inverse_mass_b > 0.0) changed_in[at(row.body_b)] = sweep;
    }
    if (sweep == 1) scale_mps = std::max(fastest_mps, changed_mps);
    const bool tolerable = changed_mps <= k_rebound_tolerated * scale_mps;
    settling = {.left_mps = changed_mps, .unsolved = !tolerable};
    if (changed_mps == 0.0 || (sweep >= k_rebound_sweeps && tolerable)) break;
    if (sweep >= k_plain_sweeps && sweep % 2 == 0 && sweep < k_most_rebound_sweeps) {
      extrapolation.carry_on(changed_mps, sweep, rows, velocity, changed_in);
    }
  }
  return settling;
}

double limit_energy(std::span<GroupMember> members, double allowed_j) {
  const RigidMotion rigid = rigid_motion(members);
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
