#include "experiments/exact/schemes/compliant_map.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "experiments/exact/schemes/box_points.hpp"
#include "experiments/exact/schemes/scheme_map.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

double clamped(const CompliantContact& c, double impedance) {
  return std::clamp(impedance, c.least_impedance, c.most_impedance);
}

double impedance(const CompliantContact& c, double gap_m) {
  const double start = clamped(c, c.impedance_start), end = clamped(c, c.impedance_end);
  if (start == end || c.impedance_width_m <= 0.0) return 0.5 * (start + end);
  const double x = std::abs(gap_m) / c.impedance_width_m;
  if (x >= 1.0) return end;
  double y = x;
  const double p = c.impedance_power;
  if (p > 1.0) {
    y = x <= c.impedance_midpoint
            ? std::pow(x, p) / std::pow(c.impedance_midpoint, p - 1.0)
            : 1.0 - std::pow(1.0 - x, p) / std::pow(1.0 - c.impedance_midpoint, p - 1.0);
  }
  return start + y * (end - start);
}

// Velocities and accelerations of a body as the scheme counts them: of the centre in world axes, of
// the spin in body axes.
struct Motion {
  Vector3d linear = Vector3d::Zero();
  Vector3d spin = Vector3d::Zero();
};
using Motions = std::vector<Motion>;  // (bodies)

struct Row {
  MatrixXd jacobian;  // (3, 6 bodies): contact frame, relative acceleration of b against a
  Vector3d reference_mps2 = Vector3d::Zero();
  double weight_kg = 0.0;  // 1/R, times the number of points
  double friction = 0.0;
};

// mju_makeFrame: normal, then what is left of the y axis (of the z axis where the normal is within
// 60 degrees of y), then their cross product.
Matrix3d contact_frame(const Vector3d& normal) {
  const Vector3d guess = std::abs(normal.y()) < 0.5 ? Vector3d::UnitY() : Vector3d::UnitZ();
  const Vector3d first = (guess - normal.dot(guess) * normal).normalized();
  Matrix3d frame;
  frame << normal.transpose(), first.transpose(), normal.cross(first).transpose();
  return frame;
}

// The problem of one instant: minimise (a - a_0)' M (a - a_0)/2 + sum s(J a - a_ref) over a.
struct Problem {
  VectorXd mass;  // diagonal of M; 1 for the six of a fixed body, whose columns of J are zero
  VectorXd free;
  std::vector<Row> rows;
};

Vector3d y_of(const Row& row, const VectorXd& a) { return row.jacobian * a - row.reference_mps2; }

VectorXd gradient(FrictionSet set, const Problem& problem, const VectorXd& a) {
  VectorXd sum = problem.mass.cwiseProduct(a - problem.free);
  for (const Row& row : problem.rows) {
    const Vector3d force = compliant_answer(set, row.friction, y_of(row, a)).force;
    sum -= row.weight_kg * row.jacobian.transpose() * force;
  }
  return sum;
}

// Newton's method with a line search by bisection of the slope along the step, which is monotonic.
VectorXd solve(FrictionSet set, const Problem& problem) {
  constexpr int k_most_steps = 200;
  constexpr int k_halvings = 60;
  constexpr double k_decrement = 1e-28;
  VectorXd a = problem.free;
  for (int step = 0; step < k_most_steps; ++step) {
    const VectorXd g = gradient(set, problem, a);
    MatrixXd hessian = problem.mass.asDiagonal();
    for (const Row& row : problem.rows) {
      hessian += row.weight_kg * row.jacobian.transpose() *
                 compliant_answer(set, row.friction, y_of(row, a)).stiffness * row.jacobian;
    }
    const VectorXd move = -hessian.llt().solve(g);
    const auto slope = [&](double t) { return move.dot(gradient(set, problem, a + t * move)); };
    double low = 0.0, high = 1.0;
    while (slope(high) < 0.0 && high < 1e6) high *= 2.0;
    // Near the solution the problem is all but quadratic, and the full step the best one.
    const bool full = std::abs(slope(1.0)) <= 0.1 * std::abs(g.dot(move));
    for (int i = 0; !full && i < k_halvings; ++i) {
      const double middle = 0.5 * (low + high);
      (slope(middle) < 0.0 ? low : high) = middle;
    }
    a += (full ? 1.0 : 0.5 * (low + high)) * move;
    // The decrement is the squared distance left, which this step squares once more.
    if (-g.dot(move) <= k_decrement * problem.mass.dot(a.cwiseAbs2() + problem.free.cwiseAbs2())) {
      break;
    }
  }
  return a;
}

// Relative acceleration at the contact per acceleration of the body, in the contact's frame.
void fill_columns(const Matrix3d& frame, const State& state, const Vector3d& point, double sign,
                  Eigen::Ref<MatrixXd> columns) {
  const Matrix3d turn = state.orientation.toRotationMatrix();
  const Vector3d lever = point - state.position_m;
  columns.leftCols<3>() = sign * frame;
  for (int k = 0; k < 3; ++k) {
    columns.col(3 + k) = sign * frame * turn.col(k).cross(lever);
  }
}

VectorXd stacked(const Motions& motions) {
  VectorXd all(6 * static_cast<Eigen::Index>(motions.size()));
  for (std::size_t i = 0; i < motions.size(); ++i) {
    all.segment<6>(6 * static_cast<Eigen::Index>(i)) << motions[i].linear, motions[i].spin;
  }
  return all;
}

// R = (1 - d)/d times the inverse masses (mj_makeImpedance, mj_diagApprox); a row of the pyramid
// has 2 mu^2 (1 + mu^2) R.
Row make_row(const Scheme& scheme, const ExactRun& run, const PointContact& contact,
             std::span<const State> states, const VectorXd& velocity) {
  const CompliantContact& soft = *scheme.compliant();
  const double gap = (contact.boxes ? soft.box_gap_share : 1.0) * contact.gap_m;
  const CompliantLaw law = compliant_law(soft, gap, run.step_s);
  const Matrix3d frame = contact_frame(contact.normal);
  const Vector3d middle = contact.position_m - 0.5 * contact.gap_m * contact.normal;
  Row row;
  row.friction = contact_law(run.world, contact.body_a, contact.body_b).friction;
  row.jacobian = MatrixXd::Zero(3, velocity.size());
  double inverse_mass = 0.0;
  for (const auto& [i, sign] : {std::pair(contact.body_a, -1.0), std::pair(contact.body_b, 1.0)}) {
    if (run.world.bodies[i].fixed) continue;
    inverse_mass += 1.0 / run.world.bodies[i].mass_kg;
    fill_columns(frame, states[i], middle, sign,
                 row.jacobian.middleCols<6>(6 * static_cast<Eigen::Index>(i)));
  }
  row.reference_mps2 = -law.damping_per_s * row.jacobian * velocity -
                       law.stiffness_per_s2 * law.impedance * gap * Vector3d::UnitX();
  double regularisation = (1.0 - law.impedance) / law.impedance * inverse_mass;
  if (row.friction > 0.0 && scheme.friction == FrictionSet::inscribed) {
    const double mu2 = row.friction * row.friction;
    regularisation *= 2.0 * mu2 * (1.0 + mu2);
  }
  row.weight_kg = contact.points / regularisation;
  return row;
}

// The face of a box that lies on a larger one.
bool is_face(const ExactRun& run, const PointContact& contact) {
  return contact.boxes && contact.central && contact.points == 4 &&
         box_of(run.world.bodies[contact.body_b].shape) != nullptr;
}

// Contacts of the states that act. Friction tilts a face, and each corner has a gap of its own: the
// four corners of b that are the lowest along the normal.
std::vector<PointContact> acting(const ExactRun& run, std::span<const State> states) {
  std::vector<PointContact> found, split;
  run.geometry(states, found);
  for (const PointContact& contact : found) {
    const bool rubs = contact_law(run.world, contact.body_a, contact.body_b).friction > 0.0;
    if (!rubs || !is_face(run, contact)) {
      split.push_back(contact);
      continue;
    }
    const State& b = states[contact.body_b];
    const auto& box = std::get<BoxShape>(run.world.bodies[contact.body_b].shape);
    const Vector3d down = b.orientation.conjugate() * -contact.normal;
    const Vector3d on_a = contact.position_m - contact.gap_m * contact.normal;
    Eigen::Index axis = 0;
    down.cwiseAbs().maxCoeff(&axis);
    for (int corner = 0; corner < 4; ++corner) {
      Vector3d local = box.half_extents_m;
      local[axis] *= down[axis] < 0.0 ? -1.0 : 1.0;
      local[(axis + 1) % 3] *= corner % 2 == 0 ? 1.0 : -1.0;
      local[(axis + 2) % 3] *= corner / 2 == 0 ? 1.0 : -1.0;
      PointContact point = contact;
      point.points = 1;
      point.central = false;
      point.position_m = b.position_m + b.orientation * local;
      point.gap_m = contact.normal.dot(point.position_m - on_a);
      split.push_back(point);
    }
  }
  std::erase_if(split, [](const PointContact& c) { return c.gap_m >= 0.0; });
  return split;
}

// Accelerations (bodies) of the given states under the wrenches, gravity and contacts.
Motions accelerations(const Scheme& scheme, const ExactRun& run, std::span<const Wrench> wrenches,
                      std::span<const State> states, const Motions& velocities) {
  Motions result(states.size());
  Problem problem;
  problem.mass = VectorXd::Ones(6 * static_cast<Eigen::Index>(states.size()));
  for (std::size_t i = 0; i < states.size(); ++i) {
    const Body& body = run.world.bodies[i];
    if (body.fixed) continue;
    const Vector3d& w = velocities[i].spin;
    const Vector3d torque = states[i].orientation.conjugate() * wrenches[i].torque_nm -
                            w.cross(body.inertia_kgm2.cwiseProduct(w));
    result[i] = {run.world.gravity_mps2 + wrenches[i].force_n / body.mass_kg,
                 torque.cwiseQuotient(body.inertia_kgm2)};
    problem.mass.segment<6>(6 * static_cast<Eigen::Index>(i)) << Vector3d::Constant(body.mass_kg),
        body.inertia_kgm2;
  }
  const VectorXd velocity = stacked(velocities);
  for (const PointContact& contact : acting(run, states)) {
    problem.rows.push_back(make_row(scheme, run, contact, states, velocity));
  }
  if (problem.rows.empty()) return result;
  problem.free = stacked(result);
  const VectorXd a = solve(scheme.friction, problem);
  for (std::size_t i = 0; i < states.size(); ++i) {
    const auto at = 6 * static_cast<Eigen::Index>(i);
    result[i] = {a.segment<3>(at), a.segment<3>(at + 3)};
  }
  return result;
}

Motions plus(Motions sum, double scale, const Motions& other) {
  for (std::size_t i = 0; i < sum.size(); ++i) {
    sum[i].linear += scale * other[i].linear;
    sum[i].spin += scale * other[i].spin;
  }
  return sum;
}

std::vector<State> moved(std::span<const State> states, double h, const Motions& velocities) {
  std::vector<State> next(states.begin(), states.end());
  for (std::size_t i = 0; i < next.size(); ++i) {
    next[i].position_m += h * velocities[i].linear;
    next[i].orientation = (next[i].orientation * rotation_of(h * velocities[i].spin)).normalized();
  }
  return next;
}

bool is_stated(const Scheme& scheme, const ExactRun& run, const std::vector<PointContact>& contacts,
               std::string& why) {
  if (scheme.gyroscopic != GyroscopicRule::explicit_body &&
      scheme.gyroscopic != GyroscopicRule::runge_kutta_4) {
    why = "compliant contacts of bodies that turn implicitly are not predicted";
    return false;
  }
  for (const PointContact& contact : contacts) {
    const ContactLaw law = contact_law(run.world, contact.body_a, contact.body_b);
    if (law.restitution > 0.0) {
      why = "a compliant contact has no coefficient of restitution";
      return false;
    }
    if (law.friction > 0.0 && contact.points > 1 && !is_face(run, contact)) {
      why = "friction at a compliant contact of several points is not predicted";
      return false;
    }
  }
  return true;
}

// The cone's interior answers with -y itself, its polar cone with nothing, the rest with the
// nearest point of the mantle f_n (1, mu t/|t|).
CompliantAnswer cone_answer(double mu, const Vector3d& y) {
  CompliantAnswer answer;
  const Vector3d z = -y;
  const double slip = z.tail<2>().norm();
  if (slip <= mu * z.x()) return {z, Matrix3d::Identity()};
  if (mu * slip <= -z.x()) return answer;
  const Eigen::Vector2d along = z.tail<2>() / slip;
  const Eigen::Vector2d across(-along.y(), along.x());
  const Vector3d ray = Vector3d(1.0, mu * along.x(), mu * along.y()) / std::sqrt(1.0 + mu * mu);
  answer.force = ray.dot(z) * ray;
  answer.stiffness = ray * ray.transpose();
  answer.stiffness.bottomRightCorner<2, 2>() +=
      answer.force.tail<2>().norm() / slip * across * across.transpose();
  return answer;
}

}  // namespace

CompliantLaw compliant_law(const CompliantContact& contact, double gap_m, double step_s) {
  const double time = contact.time_constant_at_least_two_steps
                          ? std::max(contact.time_constant_s, 2.0 * step_s)
                          : contact.time_constant_s;
  const double end = clamped(contact, contact.impedance_end);
  const double rate = end * time * contact.damping_ratio;
  return {.impedance = impedance(contact, gap_m),
          .stiffness_per_s2 = 1.0 / (rate * rate),
          .damping_per_s = 2.0 / (end * time)};
}

CompliantAnswer compliant_answer(FrictionSet set, double friction, const Vector3d& y) {
  if (set == FrictionSet::circle && friction > 0.0) return cone_answer(friction, y);
  CompliantAnswer answer;
  const auto add = [&](const Vector3d& row) {
    const double push = -row.dot(y);
    if (push <= 0.0) return;
    answer.force += push * row;
    answer.stiffness += row * row.transpose();
  };
  if (friction == 0.0) {
    add(Vector3d::UnitX());
    return answer;
  }
  for (const double mu : {friction, -friction}) {
    add({1.0, mu, 0.0});
    add({1.0, 0.0, mu});
  }
  return answer;
}

bool advance_compliant_bodies(const Scheme& scheme, const ExactRun& run,
                              std::span<const Wrench> wrenches, std::span<State> states,
                              std::string& why) {
  std::vector<PointContact> contacts;
  run.geometry(states, contacts);
  if (!is_stated(scheme, run, contacts, why)) return false;
  const double h = run.step_s;
  const auto rate = [&](std::span<const State> at, const Motions& velocity) {
    return accelerations(scheme, run, wrenches, at, velocity);
  };
  Motions v1;
  for (const State& s : states) {
    v1.push_back({s.velocity_mps, s.orientation.conjugate() * s.angular_velocity_radps});
  }
  const Motions a1 = rate(states, v1);
  Motions mean, end;
  if (scheme.position == PositionRule::runge_kutta_4) {
    const Motions v2 = plus(v1, 0.5 * h, a1), a2 = rate(moved(states, 0.5 * h, v1), v2);
    const Motions v3 = plus(v1, 0.5 * h, a2), a3 = rate(moved(states, 0.5 * h, v2), v3);
    const Motions v4 = plus(v1, h, a3), a4 = rate(moved(states, h, v3), v4);
    const auto weighted = [](const Motions& start, double unit, const Motions& k1,
                             const Motions& k2, const Motions& k3, const Motions& k4) {
      return plus(plus(plus(plus(start, unit, k1), 2.0 * unit, k2), 2.0 * unit, k3), unit, k4);
    };
    mean = weighted(Motions(states.size()), 1.0 / 6.0, v1, v2, v3, v4);
    end = weighted(v1, h / 6.0, a1, a2, a3, a4);
  } else {
    mean = end = plus(v1, h, a1);
  }
  const std::vector<State> next = moved(states, h, mean);
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (run.world.bodies[i].fixed) continue;
    states[i] = next[i];
    states[i].velocity_mps = end[i].linear;
    states[i].angular_velocity_radps = next[i].orientation * end[i].spin;
  }
  return true;
}

}  // namespace brickbench::exact
