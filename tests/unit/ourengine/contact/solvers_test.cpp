// Every solver against every other, on equal problems: velocities and wrenches per body, never
// individual impulses, which redundant contacts leave undetermined.
#include "ourengine/contact/solvers.hpp"

#include <gtest/gtest.h>

#include "tests/support/contact_walls.hpp"
#include "tests/support/tolerance.hpp"
#include "tests/unit/ourengine/contact/small_problems.hpp"

namespace brickbench::testing {
namespace {

using ourengine::contact_residual;
using ourengine::ContactLaw;
using ourengine::solver_catalog;
using ourengine::SolverEntry;
using ourengine::SolverMemory;
using ourengine::SolveStatus;

constexpr double kTolerance = 1e-10;
// Two solutions of residual 1e-10 differ by that times a condition number of the contact problem.
constexpr Tolerance kVelocities{"velocities of two solvers, m/s and rad/s, over the largest", 2e-8,
                                1.6e-9, "residual 1e-10 times a condition number of some 10"};
constexpr Tolerance kWrenches{"contact wrenches of two solvers, over the largest", 6e-9, 3.9e-10,
                              "M times the difference of velocities"};

struct Named {
  std::string name;
  ContactProblem problem;
};

std::vector<Named> towers(double friction) {
  std::vector<Named> list;
  for (unsigned seed = 1; seed <= 4; ++seed)
    list.push_back({"tower " + std::to_string(seed), random_tower(3, friction, seed)});
  return list;
}

std::vector<Named> walls(double friction, WallState state) {
  std::vector<Named> list;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    list.push_back({(state == WallState::kRest ? "rest " : "impact ") + std::to_string(seed),
                    make_wall({4, 3, state, friction, true, seed})});
  }
  return list;
}

// Solves each problem by the solvers named; compares all with the first.
void compare(const std::vector<Named>& list, const std::vector<std::string_view>& names) {
  Worst velocities, wrenches;
  for (const Named& named : list) {
    ASSERT_EQ(ourengine::problem_error(named.problem), "");
    ContactSolution reference;
    for (const SolverEntry& solver : solver_catalog()) {
      if (std::find(names.begin(), names.end(), solver.name) == names.end()) continue;
      SolverMemory memory;
      const ContactSolution s = solver.solve(named.problem, {kTolerance, 0}, {}, memory);
      const std::string where = std::string(solver.name) + " on " + named.name;
      ASSERT_EQ(s.status, SolveStatus::kSolved) << where << ", residual " << s.residual;
      ASSERT_LE(contact_residual(named.problem, s.impulse_ns), 2.0 * kTolerance) << where;
      if (reference.velocity.empty()) {
        reference = s;
        continue;
      }
      velocities.see(largest_difference(s.velocity, reference.velocity) /
                         largest_entry(named.problem.free_velocity),
                     where);
      const auto expected = body_impulses(named.problem, reference);
      wrenches.see(
          largest_difference(body_impulses(named.problem, s), expected) / largest_entry(expected),
          where);
    }
  }
  EXPECT_TRUE(velocities.within(kVelocities));
  EXPECT_TRUE(wrenches.within(kWrenches));
}

TEST(ContactSolvers, AgreeWithoutFriction) {
  compare(towers(0.0), {"exact", "ipm", "dantzig", "socp", "alm", "newton", "nsgs"});
  compare(walls(0.0, WallState::kRest),
          {"exact", "ipm", "dantzig", "socp", "alm", "newton", "nsgs"});
  compare(walls(0.0, WallState::kImpact), {"exact", "ipm", "dantzig", "alm", "newton", "nsgs"});
}

TEST(ContactSolvers, AgreeWithFrictionAtRest) {
  compare(walls(0.5, WallState::kRest), {"exact", "socp", "alm", "newton", "nsgs"});
}

TEST(ContactSolvers, AgreeOnSlippingTowers) {
  compare(towers(0.2), {"exact", "alm", "newton", "nsgs"});
}

// Coulomb's law does not determine the outcome of a slipping impact on a wall, whose contacts are
// redundant: two methods find two solutions, each within 1e-10 of the law.
TEST(ContactSolvers, ASlippingImpactOnAWallHasMoreThanOneSolution) {
  const ContactProblem problem = make_wall({3, 3, WallState::kImpact, 0.5, true, 1});
  SolverMemory memory;
  const ContactSolution one = ourengine::solve_newton(problem, {kTolerance, 0}, {}, memory);
  const ContactSolution two = ourengine::solve_nsgs(problem, {kTolerance, 0}, {}, memory);
  EXPECT_LE(contact_residual(problem, one.impulse_ns), kTolerance);
  EXPECT_LE(contact_residual(problem, two.impulse_ns), kTolerance);
  EXPECT_GT(largest_difference(one.velocity, two.velocity), 1e-3);
}

// Momentum holds to rounding in every solution: M (v - v_free) equals the contact impulses.
constexpr Tolerance kMomentum{"M (v - v_free) - J^T f, N s and N m s", 2e-15, 2e-16,
                              "rounding of impulses of some 1 N s"};

TEST(ContactSolvers, MomentumHoldsToRounding) {
  const ContactProblem problem = random_tower(4, 0.5, 9);
  Worst worst;
  for (const SolverEntry& solver : solver_catalog()) {
    if (solver.frictionless) continue;
    SolverMemory memory;
    const ContactSolution s = solver.solve(problem, {1e-6, 0}, {}, memory);
    const auto impulses = body_impulses(problem, s);
    for (std::size_t i = 1; i < problem.bodies.size(); ++i) {
      Velocity6 change = s.velocity[i] - problem.free_velocity[i];
      change.head<3>() *= problem.bodies[i].mass_kg;
      change.tail<3>() = problem.bodies[i].inertia_kgm2 * change.tail<3>().eval();
      worst.see((change - impulses[i]).cwiseAbs().maxCoeff(), std::string(solver.name));
    }
  }
  EXPECT_TRUE(worst.within(kMomentum));
}

constexpr Tolerance kPointVelocity{"velocity of a point after contact, m/s", 2e-9, 3e-10,
                                   "residual 1e-10 of 3 m/s"};

// Sliding, sticking, bouncing and moving-floor points with known answers, by every solver of
// the exact law.
TEST(ContactSolvers, ClosedForms) {
  struct Case {
    const char* name;
    ContactProblem problem;
    Eigen::Vector3d velocity;
  };
  std::vector<Case> cases = {
      {"slide", point_on_floor({3.0, 4.0, -2.0}, 0.5), {2.4, 3.2, 0.0}},
      {"stick", point_on_floor({0.3, 0.4, -2.0}, 0.5), {0.0, 0.0, 0.0}},
      {"leave", point_on_floor({0.3, 0.4, 0.1}, 0.5), {0.3, 0.4, 0.1}},
      {"bounce", point_on_floor({3.0, 4.0, -2.0}, 0.5), {2.1, 2.8, 1.0}},
      {"moving floor", point_on_floor({0.0, 0.0, -2.0}, 0.5), {1.0, 0.0, 0.25}},
      {"gap", point_on_floor({0.0, 0.0, -2.0}, 0.5), {0.0, 0.0, -0.24}},
  };
  cases[3].problem.contacts[0].restitution = 0.5;
  cases[3].problem.contacts[0].approach_mps = -2.0;
  cases[4].problem.free_velocity[0] << 3.0, 0.0, 0.25, 0.0, 0.0, 0.0;
  cases[4].velocity[0] = 0.5 * 2.25;
  cases[5].problem.contacts[0].gap_m = 0.001;  // over a step of 1/240 s
  Worst worst;
  for (const Case& c : cases) {
    for (const SolverEntry& solver : solver_catalog()) {
      if (solver.frictionless || solver.law != ContactLaw::kCoulomb) continue;
      SolverMemory memory;
      const ContactSolution s = solver.solve(c.problem, {kTolerance, 0}, {}, memory);
      worst.see((s.velocity[1].head<3>() - c.velocity).norm(),
                std::string(c.name) + " by " + std::string(solver.name));
      EXPECT_EQ(s.velocity[0], c.problem.free_velocity[0]);
    }
  }
  EXPECT_TRUE(worst.within(kPointVelocity));
}

TEST(ContactSolvers, FrictionlessMethodsRefuseFriction) {
  const ContactProblem problem = random_tower(2, 0.5, 1);
  for (const SolverEntry& solver : solver_catalog()) {
    if (!solver.frictionless) continue;
    SolverMemory memory;
    const ContactSolution s = solver.solve(problem, {}, {}, memory);
    EXPECT_EQ(s.status, SolveStatus::kUnsuitable) << solver.name;
    EXPECT_GT(s.residual, 0.01);
  }
}

TEST(ContactSolvers, AMissedToleranceIsReportedWithItsResidual) {
  const ContactProblem problem = make_wall({5, 5, WallState::kImpact, 0.5});
  for (const SolverEntry& solver : solver_catalog()) {
    if (solver.frictionless || solver.name == "exact") continue;
    SolverMemory memory;
    const ContactSolution s = solver.solve(problem, {kTolerance, 3}, {}, memory);
    EXPECT_NE(s.status, SolveStatus::kSolved) << solver.name;
    EXPECT_GT(s.residual, kTolerance) << solver.name;
    EXPECT_LE(contact_residual(problem, s.impulse_ns, solver.law), 1.001 * s.residual)
        << solver.name;
  }
}

// A slipping impact on a 10x10 wall, which the convex law gets wrong by its own size, is solved on
// the exact law.
TEST(ContactSolvers, ExactSolvesASlippingImpactWhereTheConvexLawFails) {
  const ContactProblem problem = make_wall({10, 10, WallState::kImpact, 0.5});
  SolverMemory memory;
  const ContactSolution convex = ourengine::solve_socp(problem, {1e-8, 0}, {}, memory);
  const ContactSolution exact = ourengine::solve_exact(problem, {1e-8, 0}, {}, memory);
  EXPECT_GT(contact_residual(problem, convex.impulse_ns), 1e-3);
  EXPECT_EQ(exact.status, SolveStatus::kSolved) << exact.residual;
  EXPECT_LE(contact_residual(problem, exact.impulse_ns), 1e-8);
  EXPECT_GT(largest_difference(convex.velocity, exact.velocity), 0.1);
}

}  // namespace
}  // namespace brickbench::testing
