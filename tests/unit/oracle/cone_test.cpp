// The cone program on problems whose answer is known in closed form, and its two bounds against a
// check that shares nothing with the solver.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "experiments/oracle/cone_program.hpp"
#include "experiments/oracle/impulse_oracle.hpp"
#include "tests/support/tolerance.hpp"

namespace brickbench::gate {
namespace {

using testing::Tolerance;
using testing::Worst;

const Tolerance k_known{"known distance", 1e-6, 7.6e-8,
                        "the solver stops at bounds 1e-7 N s apart, or where rounding stops it"};

// One body on one point below its centre: the impulses that it can get are the cone itself.
ConeProblem point_below(const Eigen::Vector3d& change_ns, double friction) {
  ConeProblem problem;
  problem.linear_ns = {change_ns};
  problem.angular_nms = {Eigen::Vector3d::Zero()};
  problem.gyration_m = {0.1};
  problem.contacts = {{.body_b = 0, .friction = friction}};
  return problem;
}

// The distance of (n, t) to the cone |t| <= mu n in closed form (projection onto a circular cone).
double cone_distance(double n, double t, double mu) {
  if (t <= mu * n) return 0.0;
  if (n + mu * t <= 0.0) return std::hypot(n, t);
  return (t - mu * n) / std::sqrt(1.0 + mu * mu);
}

TEST(Cone, DistanceToOneConeIsTheClosedForm) {
  Worst worst;
  for (const double mu : {0.0, 0.3, 1.0}) {
    for (const double angle : {-3.0, -1.0, 0.2, 0.7, 1.4, 2.6}) {
      const Eigen::Vector3d change(3.0 * std::sin(angle), 0.0, 3.0 * std::cos(angle));
      const ConeProblem problem = point_below(change, mu);
      const ConeSolution solution = solve(problem, 1e-7);
      const double exact = cone_distance(change.z(), std::abs(change.x()), mu);
      const std::string where = "mu " + std::to_string(mu) + " angle " + std::to_string(angle);
      worst.see(solution.residual_ns - exact, where + " upper");
      if (exact > 0.0) worst.see(solution.bound_ns - exact, where + " lower");
    }
  }
  EXPECT_TRUE(worst.within(k_known));
}

TEST(Cone, PullingIsNeverExplained) {
  const ConeProblem problem = point_below({0.0, 0.0, -2.0}, 0.5);
  const ConeSolution solution = solve(problem, 1e-9);
  EXPECT_NEAR(solution.bound_ns, 2.0, 1e-6);
}

TEST(Cone, BothBoundsSurviveAnIndependentCheck) {
  // Random heaps: the solver's bounds bracket, and the checker finds the same numbers.
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const auto vector = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random));
  };
  Worst disagreement, gap;
  for (int trial = 0; trial < 30; ++trial) {
    ConeProblem problem;
    for (int i = 0; i < 4; ++i) {
      problem.linear_ns.push_back(vector());
      problem.angular_nms.push_back(0.1 * vector());
      problem.gyration_m.push_back(0.1);
    }
    for (std::size_t c = 0; c < 10; ++c) {
      ConeContact contact;
      contact.body_a = c < 4 ? ConeContact::none : c % 4;
      contact.body_b = c < 4 ? c : (c + 1) % 4;
      contact.normal = vector().normalized();
      contact.arm_a_m = 0.1 * vector();
      contact.arm_b_m = 0.1 * vector();
      contact.friction = trial % 3 == 0 ? 0.0 : 0.6;
      problem.contacts.push_back(contact);
    }
    const ConeSolution solution = solve(problem, 1e-7);
    const ConeBounds bounds = certify(problem, solution);
    const std::string where = "heap " + std::to_string(trial);
    disagreement.see(bounds.upper_ns - solution.residual_ns, where);
    gap.see(bounds.upper_ns - bounds.lower_ns, where);
    EXPECT_LE(solution.bound_ns, solution.residual_ns * (1 + 1e-12)) << where;
  }
  EXPECT_TRUE(
      disagreement.within({"two evaluations", 1e-14, 8.9e-16, "rounding of residuals near 1"}));
  EXPECT_TRUE(gap.within({"certified gap", 2e-6, 2.0e-7, "the stated gap, or rounding"}));
}

// A brick on the ground, and what it does in one step.
struct OneBrick {
  World world;
  std::vector<State> before, after;
  std::vector<Wrench> none = std::vector<Wrench>(2);

  explicit OneBrick(double friction) {
    world.law.friction = friction;
    world.bodies = {ground_plane(), solid_body("brick", BoxShape{{0.1, 0.05, 0.05}}, 1000.0)};
    world.bodies[1].initial.position_m.z() = 0.05;
    for (const Body& body : world.bodies) before.push_back(body.initial);
    after = before;
  }
  Unexplained judge() const {
    return unexplained_momentum(world, {before, after, none, 0.01}, 1e-9);
  }
};

TEST(Oracle, ABrickThatRestsIsExplained) { EXPECT_LE(OneBrick(0.5).judge().upper_ns, 1e-7); }

TEST(Oracle, SlidingWithinTheConeIsExplainedAndBeyondItIsNot) {
  // The ground gives m g h = 2 * 9.81 * 0.01 N s; along it at most mu times that. Braking twice as
  // hard leaves mu N / sqrt(1 + mu^2) over if the point of attack is free; the torque of friction
  // about the centre adds to it.
  OneBrick brick(0.5);
  brick.before[1].velocity_mps.x() = 1.0;
  brick.after[1].velocity_mps.x() = 1.0 - 0.5 * 9.81 * 0.01;
  const double fair = brick.judge().upper_ns;
  EXPECT_LE(fair, 1e-6);
  brick.after[1].velocity_mps.x() = 1.0 - 2.0 * 0.5 * 9.81 * 0.01;
  const Unexplained hard = brick.judge();
  EXPECT_GE(hard.lower_ns, 0.5 * 2.0 * 9.81 * 0.01 / std::sqrt(1.25) * 0.999);
  EXPECT_EQ(hard.worst_body, 1u);
}

TEST(Oracle, AFloatingBrickIsNotExplained) {
  OneBrick brick(0.5);
  brick.before[1].position_m.z() = brick.after[1].position_m.z() = 1.0;
  const Unexplained floats = brick.judge();  // no gravity: it hangs in the air
  EXPECT_NEAR(floats.lower_ns, 2.0 * 9.81 * 0.01, 1e-12);
}

TEST(Oracle, AnUpwardPullIntoTheGroundIsNotExplained) {
  OneBrick brick(0.5);
  brick.after[1].velocity_mps.z() = -1.0;
  EXPECT_NEAR(brick.judge().lower_ns, 2.0 * (1.0 - 0.0981), 1e-6);
}

}  // namespace
}  // namespace brickbench::gate
