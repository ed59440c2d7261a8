// Jacobi's elliptic functions and the torque-free rigid body that they solve.
#pragma once

#include "adapters/seam/world.hpp"

namespace brickbench::exact {

struct JacobiValues {
  double sn = 0.0;
  double cn = 1.0;
  double dn = 1.0;
};

// sn, cn, dn of real u for the parameter m = k^2 in 0 <= m < 1, to rounding, by the
// arithmetic-geometric mean (Abramowitz & Stegun 16.4).
JacobiValues jacobi(double u, double m);
// The complete integral K(m), A&S 17.6.
double complete_elliptic_k(double m);

// A body free of torques: Landau & Lifshitz, Mechanics, paragraph 37. Principal moments must
// increase, I1 < I2 < I3, and the start has w2 = 0, w1 > 0, w3 > 0 in body axes aligned with the
// world; 2 E I2 = M^2 (the separatrix) is excluded.
class TorqueFree {
 public:
  TorqueFree(const Eigen::Vector3d& inertia_kgm2, double w1_radps, double w3_radps);

  Eigen::Vector3d spin_radps(double time_s) const;  // body axes
  Eigen::Quaterniond orientation(double time_s) const;
  // w2 changes sign at every whole multiple of this time.
  double flip_s() const;

 private:
  double precession_rate_radps(double time_s) const;  // of the line of nodes about the momentum
  double precession_rad(double time_s) const;
  Eigen::Quaterniond relative_to_momentum(double time_s) const;

  Eigen::Vector3d inertia_;
  Eigen::Vector3d amplitude_;
  double momentum_ = 0.0;
  double rate_ = 0.0;  // u = rate_ t
  double m_ = 0.0;
  bool about_third_ = true;  // M^2 > 2 E I2
};

}  // namespace brickbench::exact
