#include "ourengine/integration/rotation.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace ourengine {
namespace {

// A step that turns further than so many of these is beyond any use of its phase: first order then.
constexpr double k_most_parts = 1e5;
// Newton stops when the last correction is below this; the next would be below rounding.
constexpr double k_newton_tolerance = 1e-9;
constexpr int k_newton_limit = 20;

// Hairer and Vilmart 2006: 1/I'_j = 1/I_j (1 + h^2 s) + h^2 d.
Eigen::Vector3d preprocessed_inertia(const Eigen::Vector3d& inertia, const Eigen::Vector3d& m,
                                     double step_s) {
  const Eigen::Vector3d inverse = inertia.cwiseInverse();
  const double energy = 0.5 * m.cwiseAbs2().dot(inverse);
  const double casimir = 0.5 * m.squaredNorm();
  const double sum = inertia.sum();
  const double product = inertia.prod();
  const double s = -inverse.sum() / 3.0 * energy + sum / (6.0 * product) * casimir;
  const double d = sum / (6.0 * product) * energy - casimir / (3.0 * product);
  const double h2 = step_s * step_s;
  return ((1.0 + h2 * s) * inverse + Eigen::Vector3d::Constant(h2 * d)).cwiseInverse();
}

Eigen::Quaterniond moser_veselov_step(const Eigen::Quaterniond& q, const Eigen::Vector3d& inertia,
                                      const Eigen::Vector3d& momentum, double step_s) {
  const Eigen::Vector3d m = q.conjugate() * momentum;
  const Eigen::Vector3d modified = preprocessed_inertia(inertia, m, step_s);
  const Eigen::Vector3d target = 0.5 * step_s * m;
  Eigen::Vector3d e = target.cwiseQuotient(modified);
  for (int i = 0; i < k_newton_limit; ++i) {
    const double e0 = std::sqrt(std::max(0.0, 1.0 - e.squaredNorm()));
    const Eigen::Vector3d ie = modified.cwiseProduct(e);
    const Eigen::Vector3d residual = e0 * ie + e.cross(ie) - target;
    // d/de (e0 I e + e x I e) = e0 I - I e e^T / e0 + [e] I - [I e]
    Eigen::Matrix3d jacobian = -ie * e.transpose() / e0;
    jacobian.diagonal() += e0 * modified;
    jacobian(0, 1) += -e.z() * modified.y() + ie.z();
    jacobian(0, 2) += e.y() * modified.z() - ie.y();
    jacobian(1, 0) += e.z() * modified.x() - ie.z();
    jacobian(1, 2) += -e.x() * modified.z() + ie.x();
    jacobian(2, 0) += -e.y() * modified.x() + ie.y();
    jacobian(2, 1) += e.x() * modified.y() - ie.x();
    const Eigen::Vector3d correction = jacobian.inverse() * residual;
    e -= correction;
    if (!(correction.squaredNorm() > k_newton_tolerance * k_newton_tolerance)) break;
  }
  Eigen::Quaterniond turn;
  turn.vec() = e;
  turn.w() = std::sqrt(std::max(0.0, 1.0 - e.squaredNorm()));
  return (q * turn).normalized();
}

}  // namespace

const char* rotation_name(RotationScheme scheme) {
  switch (scheme) {
    case RotationScheme::k_semi_implicit:
      return "semi_implicit";
    case RotationScheme::k_moser_veselov:
      return "moser_veselov";
  }
  return "unknown";
}

Eigen::Vector3d angular_velocity_radps(const Eigen::Quaterniond& q,
                                       const Eigen::Vector3d& inertia_kgm2,
                                       const Eigen::Vector3d& momentum_kgm2ps) {
  const Eigen::Matrix3d r = q.toRotationMatrix();
  return r * (r.transpose() * momentum_kgm2ps).cwiseQuotient(inertia_kgm2);
}

Eigen::Quaterniond turned(const Eigen::Quaterniond& q, const Eigen::Vector3d& rotation_rad) {
  const double angle = rotation_rad.norm();
  // sin(x/2)/x by its series near zero: the quotient would lose digits.
  const double scale = angle < 1e-4 ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  Eigen::Quaterniond turn;
  turn.w() = std::cos(0.5 * angle);
  turn.vec() = scale * rotation_rad;
  return (turn * q).normalized();
}

Eigen::Quaterniond rotate_semi_implicit(const Eigen::Quaterniond& q,
                                        const Eigen::Vector3d& inertia_kgm2,
                                        const Eigen::Vector3d& momentum_kgm2ps, double step_s) {
  return turned(q, step_s * angular_velocity_radps(q, inertia_kgm2, momentum_kgm2ps));
}

Eigen::Quaterniond rotate_moser_veselov(const Eigen::Quaterniond& q,
                                        const Eigen::Vector3d& inertia_kgm2,
                                        const Eigen::Vector3d& momentum_kgm2ps, double step_s) {
  const double turn_rad = step_s * angular_velocity_radps(q, inertia_kgm2, momentum_kgm2ps).norm();
  const double wanted = std::ceil(turn_rad / k_largest_turn_rad);
  if (!(wanted <= k_most_parts)) {
    return rotate_semi_implicit(q, inertia_kgm2, momentum_kgm2ps, step_s);
  }
  const int parts = std::max(1, static_cast<int>(wanted));
  Eigen::Quaterniond at = q;
  for (int i = 0; i < parts; ++i) {
    at = moser_veselov_step(at, inertia_kgm2, momentum_kgm2ps, step_s / parts);
  }
  return at;
}

Eigen::Quaterniond rotate(RotationScheme scheme, const Eigen::Quaterniond& q,
                          const Eigen::Vector3d& inertia_kgm2,
                          const Eigen::Vector3d& momentum_kgm2ps, double step_s) {
  switch (scheme) {
    case RotationScheme::k_semi_implicit:
      return rotate_semi_implicit(q, inertia_kgm2, momentum_kgm2ps, step_s);
    case RotationScheme::k_moser_veselov:
      break;
  }
  return rotate_moser_veselov(q, inertia_kgm2, momentum_kgm2ps, step_s);
}

}  // namespace ourengine
