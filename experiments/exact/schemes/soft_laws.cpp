// The laws of impact of the soft map: Newton's and Coulomb's for what the whole step gave, in
// double precision.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "experiments/exact/schemes/soft_map.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

}  // namespace

Vector3d SoftMap::spin_change(std::size_t i, const State& state, const Vector3d& moment_nms) const {
  const Body& body = run_.world.bodies[i];
  if (body.fixed) return Vector3d::Zero();
  const Eigen::Matrix3d r = state.orientation.toRotationMatrix();
  return r * (r.transpose() * moment_nms).cwiseQuotient(body.inertia_kgm2);
}

SoftMap::Firm SoftMap::firm(Row& row, std::span<const State> states) const {
  const State& a = states[row.a.body];
  const State& b = states[row.b.body];
  const auto inverse_mass = [&](const Side& s) {
    return s.fixed ? 0.0 : 1.0 / run_.world.bodies[s.body].mass_kg;
  };
  const auto arm = [&](const Vector3d& on_a, const Vector3d& on_b) -> FirmArm {
    return {on_a, on_b, spin_change(row.a.body, a, on_a), spin_change(row.b.body, b, on_b)};
  };
  Firm firm;
  firm.row = &row;
  firm.mass_a = inverse_mass(row.a);
  firm.mass_b = inverse_mass(row.b);
  firm.normal = row.points.front().view.normal;
  Vector3d middle = Vector3d::Zero();
  for (Point& point : row.points) {
    middle += point.view.position_m / static_cast<double>(row.points.size());
    if (!point.pushed()) continue;
    firm.points.push_back(&point);
    firm.arms.push_back(arm((point.view.position_m - a.position_m).cross(firm.normal),
                            (point.view.position_m - b.position_m).cross(firm.normal)));
    firm.target_mps.push_back(point.struck() ? double{point.bounce_mps} : 0.0);
    firm.given_ns.push_back(point.total_ns);
  }
  const auto response = [&](double cosine, const FirmArm& felt, const FirmArm& pushed) {
    return cosine * (firm.mass_a + firm.mass_b) + felt.on_a.dot(pushed.turn_a) +
           felt.on_b.dot(pushed.turn_b);
  };
  for (std::size_t k = 0; k < 2; ++k) {
    firm.tangent[k] = row.tangent[k].cast<double>();
    firm.slide[k] = arm((middle - a.position_m).cross(firm.tangent[k]),
                        (middle - b.position_m).cross(firm.tangent[k]));
    firm.friction_ns[static_cast<Eigen::Index>(k)] = row.friction_total_ns[k];
  }
  const double across = response(0.0, firm.slide[0], firm.slide[1]);
  firm.response << response(1.0, firm.slide[0], firm.slide[0]), across, across,
      response(1.0, firm.slide[1], firm.slide[1]);
  firm.mass = firm.response.inverse();
  firm.twist = arm(firm.normal, firm.normal);
  firm.twist_nms = row.twist_total_ns;
  firm.twist_lever_m = row.twist_lever_m;
  return firm;
}

// The velocities that all impulses of the step give, with gravity and loads.
std::vector<SoftMap::Motion> SoftMap::given(std::span<const Wrench> wrenches,
                                            std::span<const State> states) {
  std::vector<Motion> sums(states.size());
  for (Row& row : rows_) {
    const Firm f = firm(row, states);
    Vector3d force = f.friction_ns[0] * f.tangent[0] + f.friction_ns[1] * f.tangent[1];
    Vector3d on_a = f.friction_ns[0] * f.slide[0].on_a + f.friction_ns[1] * f.slide[1].on_a +
                    f.twist_nms * f.normal;
    Vector3d on_b = f.friction_ns[0] * f.slide[0].on_b + f.friction_ns[1] * f.slide[1].on_b +
                    f.twist_nms * f.normal;
    for (std::size_t p = 0; p < f.points.size(); ++p) {
      force += f.given_ns[p] * f.normal;
      on_a += f.given_ns[p] * f.arms[p].on_a;
      on_b += f.given_ns[p] * f.arms[p].on_b;
    }
    sums[row.a.body].linear -= force;
    sums[row.a.body].angular -= on_a;
    sums[row.b.body].linear += force;
    sums[row.b.body].angular += on_b;
  }
  for (std::size_t i = 0; i < states.size(); ++i) {
    const Body& body = run_.world.bodies[i];
    if (body.fixed) {
      sums[i] = {};
      continue;
    }
    const double h = run_.step_s;
    sums[i].linear = states[i].velocity_mps + h * run_.world.gravity_mps2 +
                     (h * wrenches[i].force_n + sums[i].linear) / body.mass_kg;
    sums[i].angular = states[i].angular_velocity_radps +
                      spin_change(i, states[i], h * wrenches[i].torque_nm + sums[i].angular);
  }
  return sums;
}

// Projected Gauss-Seidel on the pushed points of one manifold. Returns by how much the velocity of
// one of them changed.
double SoftMap::settle_normals(Firm& row, double enough_mps, std::vector<Motion>& motions) const {
  Motion& a = motions[row.row->a.body];
  Motion& b = motions[row.row->b.body];
  const std::size_t n = row.points.size();
  std::vector<double> before(n), change(n, 0.0);
  const double apart = row.normal.dot(b.linear - a.linear);
  for (std::size_t p = 0; p < n; ++p) {
    before[p] = apart + row.arms[p].on_b.dot(b.angular) - row.arms[p].on_a.dot(a.angular) -
                row.target_mps[p];
  }
  std::vector<double> now = before;
  const auto response = [&](std::size_t p, std::size_t q) {
    return row.mass_a + row.mass_b + row.arms[p].on_a.dot(row.arms[q].turn_a) +
           row.arms[p].on_b.dot(row.arms[q].turn_b);
  };
  double stop_mps = soft_.row_share * enough_mps;
  for (int round = 0; round < soft_.row_rounds; ++round) {
    double largest_mps = 0.0;
    for (std::size_t p = 0; p < n; ++p) {
      const double old_ns = row.given_ns[p];
      row.given_ns[p] = std::max(0.0, old_ns - now[p] / response(p, p));
      const double step_ns = row.given_ns[p] - old_ns;
      change[p] += step_ns;
      for (std::size_t q = 0; q < n; ++q) now[q] += response(q, p) * step_ns;
      largest_mps = std::max(largest_mps, std::abs(step_ns) * response(p, p));
    }
    if (round == 0) stop_mps = std::max(stop_mps, soft_.round_share * largest_mps);
    if (largest_mps <= stop_mps) break;
  }
  double sum_ns = 0.0, changed_mps = 0.0;
  for (std::size_t p = 0; p < n; ++p) {
    sum_ns += change[p];
    a.angular -= change[p] * row.arms[p].turn_a;
    b.angular += change[p] * row.arms[p].turn_b;
    changed_mps = std::max(changed_mps, std::abs(now[p] - before[p]));
  }
  a.linear -= sum_ns * row.mass_a * row.normal;
  b.linear += sum_ns * row.mass_b * row.normal;
  return changed_mps;
}

// Coulomb's law in the middle of the points, as in the sweeps of the sub-steps.
double SoftMap::settle_friction(Firm& row, std::vector<Motion>& motions) {
  Motion& a = motions[row.row->a.body];
  Motion& b = motions[row.row->b.body];
  double load_ns = 0.0;
  for (const double ns : row.given_ns) load_ns += ns;
  const double limit_ns = double{row.row->friction} * load_ns;
  Vector2d slip_mps;
  for (std::size_t k = 0; k < 2; ++k) {
    slip_mps[static_cast<Eigen::Index>(k)] = row.tangent[k].dot(b.linear - a.linear) +
                                             row.slide[k].on_b.dot(b.angular) -
                                             row.slide[k].on_a.dot(a.angular);
  }
  Vector2d next_ns = row.friction_ns - row.mass * slip_mps;
  if (next_ns.norm() > limit_ns) {
    const double least_mass = 0.5 * row.mass.trace() -
                              std::hypot(0.5 * (row.mass(0, 0) - row.mass(1, 1)), row.mass(0, 1));
    next_ns = row.friction_ns - least_mass * slip_mps;
    if (next_ns.norm() > limit_ns) next_ns *= limit_ns / next_ns.norm();
  }
  const Vector2d change_ns = next_ns - row.friction_ns;
  row.friction_ns = next_ns;
  for (std::size_t k = 0; k < 2; ++k) {
    const double ns = change_ns[static_cast<Eigen::Index>(k)];
    a.linear -= ns * row.mass_a * row.tangent[k];
    b.linear += ns * row.mass_b * row.tangent[k];
    a.angular -= ns * row.slide[k].turn_a;
    b.angular += ns * row.slide[k].turn_b;
  }
  const double give = row.normal.dot(row.twist.turn_a + row.twist.turn_b);
  const double most_nms = limit_ns * row.twist_lever_m;
  const double free_nms =
      give > 0.0 ? row.twist_nms - row.normal.dot(b.angular - a.angular) / give : 0.0;
  const double twist_nms = std::clamp(free_nms, -most_nms, most_nms) - row.twist_nms;
  row.twist_nms += twist_nms;
  a.angular -= twist_nms * row.twist.turn_a;
  b.angular += twist_nms * row.twist.turn_b;
  return std::max((row.response * change_ns).norm(),
                  std::abs(twist_nms) * give * row.twist_lever_m);
}

// Goes on from `now` along what changed since `last`, which becomes it.
double SoftMap::beyond(double share, double now, double& last) {
  return now + share * (now - std::exchange(last, now));
}

// Every impulse and every velocity goes on along its last change, which is kept in `before`.
void SoftMap::extrapolate(double share, std::vector<Firm>& rows, std::vector<Motion>& motions,
                          Iterate& before) const {
  if (before.rows.empty()) before = {rows, motions};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    Firm& now = rows[k];
    Firm& last = before.rows[k];
    for (std::size_t p = 0; p < now.given_ns.size(); ++p) {
      now.given_ns[p] = beyond(share, now.given_ns[p], last.given_ns[p]);
    }
    for (Eigen::Index t = 0; t < 2; ++t) {
      now.friction_ns[t] = beyond(share, now.friction_ns[t], last.friction_ns[t]);
    }
    now.twist_nms = beyond(share, now.twist_nms, last.twist_nms);
  }
  for (std::size_t i = 0; i < motions.size(); ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      Motion& now = motions[i];
      Motion& last = before.motions[i];
      now.linear[j] = beyond(share, now.linear[j], last.linear[j]);
      now.angular[j] = beyond(share, now.angular[j], last.angular[j]);
    }
  }
}

// By sweeps to and fro over the manifolds; those whose bodies no longer move are left out.
void SoftMap::settle(std::vector<Firm>& rows, double fastest_mps,
                     std::vector<Motion>& motions) const {
  std::vector<int> moved_in(motions.size(), 0);
  const double least_mps = std::max(fastest_mps, run_.world.gravity_mps2.norm() * run_.step_s);
  double scale_mps = least_mps, last_mps = 0.0, pace = 1.0;
  Iterate before;
  for (int sweep = 1; sweep <= soft_.most_rebound_sweeps; ++sweep) {
    const double changed_mps =
        sweep_once(sweep, soft_.rebound_share * scale_mps, rows, motions, moved_in);
    if (changed_mps == 0.0) break;
    if (sweep == 1) scale_mps = std::max(least_mps, changed_mps);
    if (sweep >= soft_.rebound_sweeps && changed_mps <= soft_.rebound_tolerated * scale_mps) break;
    if (sweep < soft_.plain_sweeps || sweep % 2 == 1 || sweep == soft_.most_rebound_sweeps) {
      continue;
    }
    if (changed_mps > soft_.restart_growth * last_mps) pace = 1.0;
    last_mps = changed_mps;
    const double next = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * pace * pace));
    extrapolate((pace - 1.0) / next, rows, motions, before);
    for (std::size_t i = 0; pace > 1.0 && i < motions.size(); ++i) {
      if (!run_.world.bodies[i].fixed) moved_in[i] = sweep;
    }
    pace = next;
  }
}

// The largest change of a velocity of those that are more than enough.
double SoftMap::sweep_once(int sweep, double enough_mps, std::vector<Firm>& rows,
                           std::vector<Motion>& motions, std::vector<int>& moved_in) const {
  double changed_mps = 0.0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    Firm& row = rows[sweep % 2 == 1 ? k : rows.size() - 1 - k];
    const Side& a = row.row->a;
    const Side& b = row.row->b;
    if (std::max(moved_in[a.body], moved_in[b.body]) < sweep - 1) continue;
    double change_mps = settle_normals(row, enough_mps, motions);
    if (row.row->friction > 0.0F) {
      change_mps = std::max(change_mps, settle_friction(row, motions));
    }
    if (change_mps <= enough_mps) continue;
    changed_mps = std::max(changed_mps, change_mps);
    for (const Side* side : {&a, &b}) {
      if (!side->fixed) moved_in[side->body] = sweep;
    }
  }
  return changed_mps;
}

void SoftMap::take(const Firm& row) {
  for (std::size_t p = 0; p < row.points.size(); ++p) {
    row.points[p]->total_ns = static_cast<float>(row.given_ns[p]);
  }
  for (std::size_t k = 0; k < 2; ++k) {
    row.row->friction_total_ns[k] =
        static_cast<float>(row.friction_ns[static_cast<Eigen::Index>(k)]);
  }
  row.row->twist_total_ns = static_cast<float>(row.twist_nms);
}

}  // namespace brickbench::exact
