#include "ourengine/integration/rotation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "tests/support/rotate_cf4.hpp"
#include "tests/support/tolerance.hpp"

namespace ourengine {
namespace {

using brickbench::testing::rotate_cf4;
using brickbench::testing::Tolerance;
using brickbench::testing::Worst;
using Rotate = decltype(&rotate_moser_veselov);

// A brick spinning about its middle axis, 10 rad/s, slightly off: it flips again and again.
struct Spin {
  Eigen::Vector3d inertia_kgm2 = {0.0125 / 3, 0.0425 / 3, 0.05 / 3};
  Eigen::Vector3d momentum_kgm2ps = inertia_kgm2.cwiseProduct(Eigen::Vector3d(0.01, 10.0, 0.02));

  double energy_j(const Eigen::Quaterniond& q) const {
    return 0.5 * momentum_kgm2ps.dot(angular_velocity_radps(q, inertia_kgm2, momentum_kgm2ps));
  }
  // Attitude at the end; energy error over the run, relative.
  Eigen::Quaterniond run(Rotate rotate, double step_s, double time_s,
                         double* energy_error = nullptr) const {
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
    const double start = energy_j(q);
    const long steps = std::lround(time_s / step_s);
    for (long i = 0; i < steps; ++i) {
      q = rotate(q, inertia_kgm2, momentum_kgm2ps, step_s);
      if (energy_error != nullptr) {
        *energy_error = std::max(*energy_error, std::abs(energy_j(q) / start - 1.0));
      }
    }
    return q;
  }
};

// Slope of the attitude error between two steps, against a run with a much smaller one.
double order_of(Rotate rotate, double coarse_s, double time_s) {
  const Spin spin;
  const Eigen::Quaterniond truth = spin.run(rotate, coarse_s / 64, time_s);
  const double coarse = truth.angularDistance(spin.run(rotate, coarse_s, time_s));
  const double fine = truth.angularDistance(spin.run(rotate, coarse_s / 2, time_s));
  return std::log2(coarse / fine);
}

TEST(Rotation, OrdersAreThoseOfTheSchemes) {
  EXPECT_NEAR(order_of(&rotate_semi_implicit, 1e-3, 0.25), 1.0, 0.15);
  EXPECT_NEAR(order_of(&rotate_cf4, 1e-2, 0.5), 4.0, 0.4);
  // Steps small enough (|w| h < 0.02 rad) that none is split.
  EXPECT_NEAR(order_of(&rotate_moser_veselov, 1.9e-3, 0.95), 4.0, 0.4);
}

TEST(Rotation, TwoIndependentSchemesAgreeOnTheAttitude) {
  constexpr Tolerance k_agreement = {"attitude after 10 s (rad)", 7e-9, 3.6e-10,
                                     "both of order four, at steps where each has 1e-9"};
  const Spin spin;
  Worst worst;
  worst.see(spin.run(&rotate_cf4, 1.0 / 61440, 10.0)
                .angularDistance(spin.run(&rotate_moser_veselov, 1.0 / 15360, 10.0)),
            "10 s");
  EXPECT_TRUE(worst.within(k_agreement));
}

TEST(Rotation, MoserVeselovKeepsTheEnergyToRounding) {
  constexpr Tolerance k_energy = {"energy error over 100 s at 1/240 s, relative", 1e-13, 8.7e-15,
                                  "24000 steps of rounding, random walk"};
  double error = 0.0;
  Spin{}.run(&rotate_moser_veselov, 1.0 / 240, 100.0, &error);
  Worst worst;
  worst.see(error, "100 s");
  EXPECT_TRUE(worst.within(k_energy));
}

// Boxes up to 200 times as long as thick, spun about any axis, in one step of up to a hundred
// turns.
TEST(Rotation, MoserVeselovMakesNoEnergyInALargeStep) {
  constexpr Tolerance k_energy = {"energy of one step, relative", 1e-12, 8.9e-14,
                                  "30000 parts of rounding, times the stiffness of the box"};
  std::mt19937_64 dice(11);
  const auto draw = [&dice](double low, double high) {
    return std::exp(std::uniform_real_distribution<>(std::log(low), std::log(high))(dice));
  };
  Worst worst;
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector3d edge(1.0, draw(0.005, 1.0), draw(0.005, 1.0));
    Spin spin;
    spin.inertia_kgm2 = (Eigen::Vector3d::Constant(edge.squaredNorm()) - edge.cwiseAbs2()) / 12.0;
    const Eigen::Vector3d axis(draw(0.01, 1.0), draw(0.01, 1.0), draw(0.01, 1.0));
    spin.momentum_kgm2ps = spin.inertia_kgm2.cwiseProduct(draw(0.01, 600.0) * axis.normalized());
    double error = 0.0;
    spin.run(&rotate_moser_veselov, 1.0, 1.0, &error);
    worst.see(error, "trial " + std::to_string(trial));
  }
  EXPECT_TRUE(worst.within(k_energy));
}

TEST(Rotation, SteadySpinAboutAPrincipalAxisIsATurnAtConstantRate) {
  const Spin spin;
  Worst worst;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d rate = 3.0 * Eigen::Vector3d::Unit(axis);
    const Eigen::Vector3d momentum = spin.inertia_kgm2.cwiseProduct(rate);
    for (const Rotate rotate : {&rotate_semi_implicit, &rotate_cf4}) {
      const Eigen::Quaterniond q =
          rotate(Eigen::Quaterniond::Identity(), spin.inertia_kgm2, momentum, 0.1);
      worst.see(q.angularDistance(
                    Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::Unit(axis)))),
                "axis " + std::to_string(axis));
    }
  }
  EXPECT_TRUE(worst.within({"turn (rad)", 1e-15, 5.6e-17, "rounding of one exponential"}));
}

TEST(Rotation, BodyAtRestStays) {
  const Spin spin;
  for (const RotationScheme scheme :
       {RotationScheme::k_semi_implicit, RotationScheme::k_moser_veselov}) {
    const Eigen::Quaterniond q = rotate(scheme, Eigen::Quaterniond::Identity(), spin.inertia_kgm2,
                                        Eigen::Vector3d::Zero(), 0.1);
    EXPECT_EQ(q.w(), 1.0) << rotation_name(scheme);
    EXPECT_TRUE(q.vec().isZero(0.0)) << rotation_name(scheme);
  }
}

}  // namespace
}  // namespace ourengine
