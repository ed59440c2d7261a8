// The discrete maps of free bodies; those with a contact are in scheme_map.cpp.
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "experiments/exact/schemes/scheme_map.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

Vector3d euler_rate(const Vector3d& inertia, const Vector3d& spin, const Vector3d& torque) {
  return (torque - spin.cross(inertia.cwiseProduct(spin))).cwiseQuotient(inertia);
}

// Classical Runge-Kutta for the spin; the attitude advances by the exponential of the weighted mean
// of the stages' spins in body axes.
void runge_kutta_rotation(const Vector3d& inertia, const Vector3d& torque_world, double h,
                          State& state) {
  const Quaterniond q0 = state.orientation;
  const Vector3d w0 = q0.conjugate() * state.angular_velocity_radps;
  std::array<Vector3d, 4> spin;
  std::array<Vector3d, 4> rate;
  const std::array<double, 4> share = {0.0, 0.5, 0.5, 1.0};
  for (std::size_t i = 0; i < 4; ++i) {
    spin[i] = i == 0 ? w0 : Vector3d(w0 + share[i] * h * rate[i - 1]);
    const Quaterniond q = i == 0 ? q0 : (q0 * rotation_of(share[i] * h * spin[i - 1])).normalized();
    rate[i] = euler_rate(inertia, spin[i], q.conjugate() * torque_world);
  }
  const Vector3d mean_spin = (spin[0] + 2.0 * spin[1] + 2.0 * spin[2] + spin[3]) / 6.0;
  const Vector3d mean_rate = (rate[0] + 2.0 * rate[1] + 2.0 * rate[2] + rate[3]) / 6.0;
  state.orientation = (q0 * rotation_of(h * mean_spin)).normalized();
  state.angular_velocity_radps = state.orientation * Vector3d(w0 + h * mean_rate);
}

Vector3d spin_of(const Quaterniond& q, const Vector3d& inertia, const Vector3d& momentum) {
  return q * (q.conjugate() * momentum).cwiseQuotient(inertia);
}

// The turn (e0, e) in body axes with e0 J e + e x J e = h/2 m, by fixed-point iteration: each round
// gains a factor of about the angle. J: the moments of Hairer and Vilmart with
// their constants s and d of order four, from energy H = m . I^-1 m / 2 and Casimir C = |m|^2 / 2.
Quaterniond moser_veselov(const Quaterniond& q, const Vector3d& inertia, const Vector3d& momentum,
                          double h) {
  constexpr int k_rounds = 40;
  const Vector3d m = q.conjugate() * momentum;
  const double energy = 0.5 * m.dot(m.cwiseQuotient(inertia));
  const double casimir = 0.5 * m.dot(m);
  const double i1 = inertia.x(), i2 = inertia.y(), i3 = inertia.z();
  const double thrice_product = 3.0 * i1 * i2 * i3;
  const double mean = 0.5 * (i1 + i2 + i3);
  const double s = (mean * casimir - (i1 * i2 + i2 * i3 + i3 * i1) * energy) / thrice_product;
  const double d = (mean * energy - casimir) / thrice_product;
  Vector3d moments;
  for (int k = 0; k < 3; ++k) {
    moments[k] = 1.0 / ((1.0 + h * h * s) / inertia[k] + h * h * d);
  }
  Vector3d e = Vector3d::Zero();
  for (int round = 0; round < k_rounds; ++round) {
    const Vector3d along = 0.5 * h * m - e.cross(moments.cwiseProduct(e));
    e = along.cwiseQuotient(moments) / std::sqrt(1.0 - e.squaredNorm());
  }
  return (q * Quaterniond(std::sqrt(1.0 - e.squaredNorm()), e.x(), e.y(), e.z())).normalized();
}

// The momentum in the world frame changes by the torque alone; the spin follows from it.
void turn_freely(const Scheme& scheme, const Vector3d& inertia, const Vector3d& torque_world,
                 double h, State& state) {
  const Vector3d before = state.angular_velocity_radps;
  const bool middle = scheme.position == PositionRule::middle_momentum;
  push_momentum(inertia, (middle ? 0.5 : 1.0) * h * torque_world, state);
  turn_with_momentum(scheme, inertia, before, h, state);
  if (middle) push_momentum(inertia, 0.5 * h * torque_world, state);
}

}  // namespace

void push_momentum(const Vector3d& inertia, const Vector3d& change_nms, State& state) {
  const Quaterniond& q = state.orientation;
  const Vector3d momentum =
      q * inertia.cwiseProduct(q.conjugate() * state.angular_velocity_radps) + change_nms;
  state.angular_velocity_radps = spin_of(q, inertia, momentum);
}

void turn_with_momentum(const Scheme& scheme, const Vector3d& inertia, const Vector3d& old_spin,
                        double h, State& state) {
  const Quaterniond q = state.orientation;
  const Vector3d spin = state.angular_velocity_radps;
  const Vector3d momentum = q * inertia.cwiseProduct(q.conjugate() * spin);
  if (scheme.attitude == AttitudeRule::moser_veselov) {
    const double parts = std::max(1.0, std::ceil(h * spin.norm() / scheme.cut_turn_rad));
    for (int part = 0; part < static_cast<int>(parts); ++part) {
      state.orientation = moser_veselov(state.orientation, inertia, momentum, h / parts);
    }
  } else {
    const bool old = scheme.position == PositionRule::old_velocity;
    state.orientation = next_attitude(scheme, q, old ? old_spin : spin, h);
  }
  state.angular_velocity_radps = spin_of(state.orientation, inertia, momentum);
}

Quaterniond rotation_of(const Vector3d& angle_rad) {
  const double angle = angle_rad.norm();
  if (angle == 0.0) return Quaterniond::Identity();
  const Vector3d v = angle_rad * (std::sin(0.5 * angle) / angle);
  return {std::cos(0.5 * angle), v.x(), v.y(), v.z()};
}

void advance_position(PositionRule rule, const Vector3d& old_velocity, double h, State& state) {
  switch (rule) {
    case PositionRule::old_velocity:
      state.position_m += h * old_velocity;
      break;
    case PositionRule::new_velocity:
      state.position_m += h * state.velocity_mps;
      break;
    case PositionRule::mean_velocity:
    case PositionRule::middle_momentum:
    case PositionRule::mean_unless_pushed:
    case PositionRule::runge_kutta_4:
      state.position_m += 0.5 * h * (old_velocity + state.velocity_mps);
      break;
  }
}

Vector3d next_spin_radps(GyroscopicRule rule, const Vector3d& inertia_kgm2,
                         const Vector3d& spin_radps, const Vector3d& torque_nm, double step_s) {
  const double h = step_s;
  const Vector3d& w = spin_radps;
  const Vector3d momentum = inertia_kgm2.cwiseProduct(w);
  const Vector3d pushed = h * torque_nm.cwiseQuotient(inertia_kgm2);
  const Matrix3d inertia = inertia_kgm2.asDiagonal();
  switch (rule) {
    case GyroscopicRule::neglected:
    case GyroscopicRule::spatial_momentum:  // of the attitude, not of the spin alone
      return w + pushed;
    case GyroscopicRule::explicit_body:
    case GyroscopicRule::runge_kutta_4:
      return w + h * euler_rate(inertia_kgm2, w, Vector3d::Zero()) + pushed;
    case GyroscopicRule::newton_body: {
      const Matrix3d jacobian = inertia + h * (cross_matrix(w) * inertia - cross_matrix(momentum));
      return w - jacobian.partialPivLu().solve(h * w.cross(momentum)) + pushed;
    }
    case GyroscopicRule::frozen_momentum:
      return (inertia - h * cross_matrix(momentum)).partialPivLu().solve(momentum) + pushed;
  }
  return w;
}

Quaterniond turned_to_first_order(const Quaterniond& orientation, const Vector3d& turn_rad) {
  const Vector3d half = 0.5 * turn_rad;
  const Quaterniond turn = Quaterniond(0.0, half.x(), half.y(), half.z()) * orientation;
  return Quaterniond(orientation.coeffs() + turn.coeffs()).normalized();
}

Quaterniond next_attitude(const Scheme& scheme, const Quaterniond& orientation,
                          const Vector3d& angular_velocity_radps, double step_s) {
  Vector3d turn_rad = step_s * angular_velocity_radps;
  const double share = turn_rad.norm() / scheme.turn_limit_rad;
  if (share > 1.0) {
    turn_rad *= 2.0 * std::atan(share * std::tan(0.5 * scheme.turn_limit_rad)) / turn_rad.norm();
  }
  if (scheme.attitude == AttitudeRule::exponential) {
    return (rotation_of(turn_rad) * orientation).normalized();
  }
  return turned_to_first_order(orientation, turn_rad);
}

State next_free_state(const Scheme& scheme, const Body& body, const State& state,
                      const Wrench& wrench, const Vector3d& gravity_mps2, double step_s) {
  State next = state;
  next.velocity_mps += step_s * (gravity_mps2 + wrench.force_n / body.mass_kg);
  advance_position(scheme.position, state.velocity_mps, step_s, next);
  if (scheme.gyroscopic == GyroscopicRule::runge_kutta_4) {
    runge_kutta_rotation(body.inertia_kgm2, wrench.torque_nm, step_s, next);
    return next;
  }
  if (scheme.gyroscopic == GyroscopicRule::spatial_momentum) {
    turn_freely(scheme, body.inertia_kgm2, wrench.torque_nm, step_s, next);
    return next;
  }
  const Quaterniond to_body = state.orientation.conjugate();
  const Vector3d spin =
      next_spin_radps(scheme.gyroscopic, body.inertia_kgm2, to_body * state.angular_velocity_radps,
                      to_body * wrench.torque_nm, step_s);
  next.angular_velocity_radps = state.orientation * spin;
  const bool old = scheme.position == PositionRule::old_velocity;
  next.orientation =
      next_attitude(scheme, state.orientation,
                    old ? state.angular_velocity_radps : next.angular_velocity_radps, step_s);
  return next;
}

}  // namespace brickbench::exact
