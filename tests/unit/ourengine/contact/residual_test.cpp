#include "ourengine/contact/residual.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/tolerance.hpp"
#include "tests/unit/ourengine/contact/small_problems.hpp"

namespace brickbench::testing {
namespace {

using ourengine::contact_residual;
using ourengine::ContactLaw;

constexpr Tolerance kClosedForm{"residual of a closed-form solution", 5e-16, 2.8e-17,
                                "a handful of roundings relative to max |b|"};

// A point that hits the floor with (3, 4, -2) m/s and mu = 0.5: it stays down with f_n = 2 N s and
// loses mu f_n = 1 m/s of its 5 m/s along the sliding direction.
TEST(ContactResidual, VanishesForASlidingPoint) {
  const ContactProblem problem = point_on_floor({3.0, 4.0, -2.0}, 0.5);
  Worst worst;
  worst.see(contact_residual(problem, std::vector<Eigen::Vector3d>{{2.0, -0.6, -0.8}}), "slide");
  EXPECT_TRUE(worst.within(kClosedForm));
}

TEST(ContactResidual, VanishesForStickingAndForSeparation) {
  Worst worst;
  worst.see(contact_residual(point_on_floor({0.3, 0.0, -2.0}, 0.5),
                             std::vector<Eigen::Vector3d>{{2.0, -0.3, 0.0}}),
            "stick");
  worst.see(contact_residual(point_on_floor({0.3, 0.1, 0.2}, 0.5),
                             std::vector<Eigen::Vector3d>{{0.0, 0.0, 0.0}}),
            "separation");
  EXPECT_TRUE(worst.within(kClosedForm));
}

// Each way to break the law by 0.01 of the scale is seen, at about its size.
TEST(ContactResidual, SeesEachViolation) {
  struct Case {
    const char* name;
    Eigen::Vector3d velocity;
    Eigen::Vector3d impulse;
  };
  const double s = 0.02;  // 1 % of max |b| = 2 m/s, or of the impulse that belongs to it
  const Case cases[] = {
      {"penetrating", {0.0, 0.0, -2.0}, {2.0 - s, 0.0, 0.0}},
      {"pushed off", {0.0, 0.0, -2.0}, {2.0 + s, 0.0, 0.0}},
      {"pulled down", {0.0, 0.0, 2.0}, {-s, 0.0, 0.0}},
      {"force at a distance", {0.0, 0.0, 2.0}, {s, 0.0, 0.0}},
      {"outside the cone", {1.1, 0.0, -2.0}, {2.0, -1.0 - s, 0.0}},
      {"slips below the cone's surface", {1.5, 0.0, -2.0}, {2.0, -1.0 + s, 0.0}},
      {"slips across its friction", {1.5, 0.0, -2.0}, {2.0, -1.0, s}},
  };
  for (const Case& c : cases) {
    const double residual =
        contact_residual(point_on_floor(c.velocity, 0.5), std::vector<Eigen::Vector3d>{c.impulse});
    EXPECT_GT(residual, 0.003) << c.name;
    EXPECT_LT(residual, 0.03) << c.name;
  }
}

// The convex law lifts a sliding point by mu |w_t|; each residual tells the two solutions apart.
TEST(ContactResidual, TellsTheConvexLawFromCoulombs) {
  const ContactProblem problem = point_on_floor({3.0, 4.0, -2.0}, 0.5);
  // min 1/2 |v - v_free|^2 subject to v_n >= mu |v_t|: f = P_K(-v_free) = (3.6, -1.08, -1.44).
  const std::vector<Eigen::Vector3d> convex{{3.6, -1.08, -1.44}};
  Worst worst;
  worst.see(contact_residual(problem, convex, ContactLaw::kConvex), "convex");
  EXPECT_TRUE(worst.within(kClosedForm));
  EXPECT_GT(contact_residual(problem, convex, ContactLaw::kCoulomb), 0.1);
}

TEST(ContactResidual, FrictionlessIsTheComplementarityResidual) {
  const ContactProblem problem = point_on_floor({3.0, 0.0, -2.0}, 0.0);
  // The scale is the speed of the point, sqrt(3^2 + 2^2) m/s.
  const double residual = contact_residual(problem, std::vector<Eigen::Vector3d>{{1.5, 0.0, 0.0}});
  EXPECT_DOUBLE_EQ(residual, 0.5 / std::sqrt(13.0));
}

// An approach that closes its gap within the step, to the last bits: the entry of J v_free + b is
// rounding, and whatever is done about it must not count as an error of the law; an impulse of the
// step before must.
TEST(ContactResidual, HasAScaleThatCannotCancel) {
  for (const double left_mps : {0.0, 1e-16, -1e-16, 1e-11, -1e-11}) {
    ContactProblem problem = point_on_floor({0.0, 0.0, -5.0}, 0.0);
    problem.contacts[0].gap_m = (5.0 + left_mps) * problem.step_s;
    EXPECT_LE(contact_residual(problem, std::vector<Eigen::Vector3d>{{0.0, 0.0, 0.0}}), 3e-12);
    EXPECT_NEAR(contact_residual(problem, std::vector<Eigen::Vector3d>{{5.0, 0.0, 0.0}}), 1.0,
                1e-11);
  }
  // Two bodies in flight together, and a wheel that rolls: J v_free is rounding there.
  ContactProblem together = point_on_floor({0.3, 0.0, -7.0}, 0.5);
  together.bodies[0].fixed = false;
  together.free_velocity[0] = together.free_velocity[1];
  ContactProblem wheel = point_on_floor({0.3, 0.0, 0.0}, 0.5);
  wheel.contacts[0].arm_b_m = {0.0, 0.0, -0.1};
  wheel.free_velocity[1][4] = 3.0;
  for (const ContactProblem& problem : {together, wheel}) {
    EXPECT_LE(contact_residual(problem, std::vector<Eigen::Vector3d>{{1e-16, 1e-16, 0.0}}), 1e-14);
  }
}

TEST(ContactResidual, IsZeroWhereNothingIsToBeDone) {
  ContactProblem problem = point_on_floor({0.0, 0.0, 0.0}, 0.5);
  EXPECT_EQ(contact_residual(problem, std::vector<Eigen::Vector3d>{{0.0, 0.0, 0.0}}), 0.0);
  problem.contacts[0].gap_m = 1e-3;
  EXPECT_EQ(contact_residual(problem, std::vector<Eigen::Vector3d>{{0.0, 0.0, 0.0}}), 0.0);
}

// What the scale is made of: each part alone, when the others are smaller.
TEST(ContactResidual, IsRelativeToTheLargestSpeed) {
  const auto scale = [](const ContactProblem& problem) {
    ourengine::SymbolicCache cache;
    return ourengine::ContactSystem(problem, 3, cache).scale_mps();
  };
  ContactProblem problem = point_on_floor({0.0, 3.0, -4.0}, 0.5);
  EXPECT_DOUBLE_EQ(scale(problem), 5.0);
  problem.contacts[0].arm_b_m = {0.0, 0.0, -2.0};
  problem.free_velocity[1][3] = 1.5;
  EXPECT_DOUBLE_EQ(scale(problem), 8.0);
  problem.contacts[0].gap_m = -1.0;  // pushed apart at recovery_mps = 1 m/s
  EXPECT_DOUBLE_EQ(scale(problem), 9.0);
  problem.contacts[0].gap_m = 1.0;  // room, however far in a step
  EXPECT_DOUBLE_EQ(scale(problem), 8.0);
  problem.free_velocity[0] << 2.0, 0.0, 0.0, 0.0, 0.0, 0.0;
  EXPECT_DOUBLE_EQ(scale(problem), 10.0);
  problem.least_speed_mps = 11.0;
  EXPECT_DOUBLE_EQ(scale(problem), 11.0);
}

TEST(ContactResidual, IsInfiniteForWhatIsNotANumber) {
  const ContactProblem problem = point_on_floor({3.0, 4.0, -2.0}, 0.5);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int k = 0; k < 3; ++k) {
    Eigen::Vector3d impulse(2.0, -0.6, -0.8);
    impulse[k] = nan;
    EXPECT_EQ(contact_residual(problem, std::vector<Eigen::Vector3d>{impulse}), HUGE_VAL) << k;
  }
  EXPECT_EQ(contact_residual(problem, std::vector<Eigen::Vector3d>{}), HUGE_VAL);
}

}  // namespace
}  // namespace brickbench::testing
