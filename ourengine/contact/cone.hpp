// Coulomb's cone K = { (n, t1, t2): |t| <= mu n }: projection and its derivative.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace ourengine {

// Euclidean projection of p = (normal, tangent_1, tangent_2) on the cone; mu >= 0.
inline Eigen::Vector3d project_on_cone(double mu, const Eigen::Vector3d& p) {
  const double t = std::sqrt(p[1] * p[1] + p[2] * p[2]);
  if (p[0] >= 0.0 && t <= mu * p[0]) return p;
  if (mu * t <= -p[0]) return Eigen::Vector3d::Zero();
  const double n = (p[0] + mu * t) / (1.0 + mu * mu);
  const double scale = mu * n / t;
  return {n, scale * p[1], scale * p[2]};
}

// The same, with one element of its generalised Jacobian (symmetric, eigenvalues in 0 .. 1).
inline Eigen::Vector3d project_on_cone(double mu, const Eigen::Vector3d& p,
                                       Eigen::Matrix3d& derivative) {
  const double t = std::sqrt(p[1] * p[1] + p[2] * p[2]);
  if (p[0] >= 0.0 && t <= mu * p[0]) {
    derivative.setIdentity();
    return p;
  }
  if (mu * t <= -p[0]) {
    derivative.setZero();
    return Eigen::Vector3d::Zero();
  }
  const double c = 1.0 / (1.0 + mu * mu);
  const double n = (p[0] + mu * t) * c;
  const double h1 = p[1] / t;
  const double h2 = p[2] / t;
  const double radial = c * mu * mu;
  const double round = mu * n / t;
  derivative(0, 0) = c;
  derivative(0, 1) = derivative(1, 0) = c * mu * h1;
  derivative(0, 2) = derivative(2, 0) = c * mu * h2;
  derivative(1, 1) = radial * h1 * h1 + round * h2 * h2;
  derivative(2, 2) = radial * h2 * h2 + round * h1 * h1;
  derivative(1, 2) = derivative(2, 1) = (radial - round) * h1 * h2;
  return {n, mu * n * h1, mu * n * h2};
}

}  // namespace ourengine
