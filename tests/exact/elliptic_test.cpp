// Jacobi's functions against identities and limits; the torque-free body against an independent
// integration of Euler's equations of sixth order.
#include "experiments/exact/cases/elliptic.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "experiments/exact/cases/builders.hpp"
#include "tests/support/tolerance.hpp"

namespace brickbench::exact {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr Tolerance k_identity = {"identities of sn, cn, dn", 4e-15, 2.3e-16, "rounding"};
constexpr Tolerance k_limit = {"limits m = 0 and m near 1", 4e-14, 2.5e-15,
                               "distance of m from 1, times the length of the argument"};
constexpr Tolerance k_period = {"quarter periods", 2e-14, 1.1e-15, "rounding of K"};
constexpr Tolerance k_motion = {"elliptic solution against Gauss-Legendre order 6", 6e-13, 3.2e-14,
                                "rounding over 2000 steps of the integration"};

TEST(Jacobi, MeetsItsIdentities) {
  Worst worst;
  std::mt19937_64 generator(5);
  std::uniform_real_distribution<double> u(-20.0, 20.0), m(0.0, 0.999);
  for (int i = 0; i < 1000; ++i) {
    const double mm = m(generator);
    const JacobiValues j = jacobi(u(generator), mm);
    worst.see(j.sn * j.sn + j.cn * j.cn - 1.0, "sn^2 + cn^2");
    worst.see(mm * j.sn * j.sn + j.dn * j.dn - 1.0, "m sn^2 + dn^2");
  }
  EXPECT_TRUE(worst.within(k_identity));
}

TEST(Jacobi, HasTheLimitsSineAndTangens) {
  Worst worst;
  for (double u = -3.0; u <= 3.0; u += 0.173) {
    worst.see(jacobi(u, 0.0).sn - std::sin(u), "m = 0");
    worst.see(jacobi(u, 1.0 - 1e-14).sn - std::tanh(u), "m = 1");
  }
  worst.see(complete_elliptic_k(0.0) - std::numbers::pi / 2.0, "K(0)");
  // Abramowitz & Stegun, table 17.1: K(0.5) = 1.85407 46773 01372.
  worst.see(complete_elliptic_k(0.5) - 1.854074677301372, "K(0.5)");
  EXPECT_TRUE(worst.within(k_limit));
}

TEST(Jacobi, VanishesAtItsPeriods) {
  Worst worst;
  for (double m = 0.01; m < 0.99; m += 0.07) {
    const double k = complete_elliptic_k(m);
    worst.see(jacobi(k, m).cn, "cn(K)");
    worst.see(jacobi(2.0 * k, m).sn, "sn(2K)");
    worst.see(jacobi(k, m).dn - std::sqrt(1.0 - m), "dn(K)");
  }
  EXPECT_TRUE(worst.within(k_period));
}

// Attitude and body spin together; the attitude by its quaternion.
struct Motion {
  Quaterniond q;
  Vector3d w;
};
Motion operator+(const Motion& a, const Motion& b) {
  return {Quaterniond(a.q.coeffs() + b.q.coeffs()), a.w + b.w};
}
Motion operator*(double s, const Motion& a) { return {Quaterniond(s * a.q.coeffs()), s * a.w}; }

Motion rate(const Vector3d& inertia, const Motion& m) {
  const Quaterniond turn = m.q * Quaterniond(0.0, m.w.x(), m.w.y(), m.w.z());
  return {Quaterniond(0.5 * turn.coeffs()),
          -m.w.cross(inertia.cwiseProduct(m.w)).cwiseQuotient(inertia)};
}

// Gauss's collocation with three stages (Hairer & Wanner, Solving ODEs II, table 5.2), order 6.
Motion gauss_step(const Vector3d& inertia, const Motion& start, double h) {
  const double r = std::sqrt(15.0);
  const std::array<std::array<double, 3>, 3> a = {
      {{5.0 / 36, 2.0 / 9 - r / 15, 5.0 / 36 - r / 30},
       {5.0 / 36 + r / 24, 2.0 / 9, 5.0 / 36 - r / 24},
       {5.0 / 36 + r / 30, 2.0 / 9 + r / 15, 5.0 / 36}}};
  std::array<Motion, 3> k = {rate(inertia, start), rate(inertia, start), rate(inertia, start)};
  for (int sweep = 0; sweep < 12; ++sweep) {
    std::array<Motion, 3> next = k;
    for (std::size_t i = 0; i < 3; ++i) {
      const Motion at = start + h * (a[i][0] * k[0] + a[i][1] * k[1] + a[i][2] * k[2]);
      next[i] = rate(inertia, at);
    }
    k = next;
  }
  return start + h * ((5.0 / 18) * k[0] + (4.0 / 9) * k[1] + (5.0 / 18) * k[2]);
}

TEST(TorqueFree, AgreesWithHighOrderIntegration) {
  Worst worst;
  std::mt19937_64 generator(6);
  std::uniform_real_distribution<double> w(0.5, 6.0);
  for (int i = 0; i < 12; ++i) {
    const Vector3d inertia(1.0, 1.0 + 0.5 * w(generator) / 6.0, 1.7);
    const double w1 = w(generator), w3 = w(generator);
    const TorqueFree exact(inertia, w1, w3);
    Motion motion = {Quaterniond::Identity(), Vector3d(w1, 0.0, w3)};
    constexpr int k_steps = 2000;
    constexpr double h = 1e-3;
    for (int step = 0; step < k_steps; ++step) motion = gauss_step(inertia, motion, h);
    const double t = k_steps * h;
    const std::string where = "w1 " + std::to_string(w1) + " w3 " + std::to_string(w3);
    worst.see((motion.w - exact.spin_radps(t)).norm() / (w1 + w3), where + " spin");
    worst.see(angle_between_rad(motion.q.normalized(), exact.orientation(t)), where + " attitude");
  }
  EXPECT_TRUE(worst.within(k_motion));
}

TEST(TorqueFree, FlipsWhereTheMiddleSpinVanishes) {
  const TorqueFree exact({1.0, 1.5, 2.0}, 3.0, 2.0);
  EXPECT_NEAR(exact.spin_radps(exact.flip_s())[1], 0.0, 1e-13);
  EXPECT_LT(exact.spin_radps(0.99 * exact.flip_s())[1] * exact.spin_radps(1.01 * exact.flip_s())[1],
            0.0);
}

}  // namespace
}  // namespace brickbench::exact
