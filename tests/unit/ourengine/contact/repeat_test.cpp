// What must not matter to a solution: islands, warm starts, what was solved before, the order of
// contacts, how often one asks.
#include <gtest/gtest.h>

#include "ourengine/contact/islands.hpp"
#include "ourengine/contact/solvers.hpp"
#include "tests/support/contact_walls.hpp"
#include "tests/support/tolerance.hpp"
#include "tests/unit/ourengine/contact/small_problems.hpp"

namespace brickbench::testing {
namespace {

using ourengine::find_islands;
using ourengine::Island;
using ourengine::solver_catalog;
using ourengine::SolverEntry;
using ourengine::SolverMemory;
using ourengine::SolveStatus;
using ourengine::WarmStart;

constexpr Tolerance kWarm{"warm against cold velocities, m/s and rad/s", 3e-9, 1.9e-10,
                          "two solutions of residual 1e-10, times a condition number"};
constexpr Tolerance kIslands{"island by island against the whole, m/s and rad/s", 3e-9, 1.5e-10,
                             "two solutions of residual 1e-10, times a condition number"};

// Three towers side by side on one floor, their bodies and contacts interleaved.
ContactProblem three_towers(double friction) {
  ContactProblem all;
  all.step_s = 0.01;
  all.bodies.push_back(fixed_body());
  all.free_velocity.push_back(Velocity6::Zero());
  const int towers = 3, cubes = 3;
  std::vector<ContactProblem> parts;
  for (unsigned t = 0; t < towers; ++t) parts.push_back(random_tower(cubes, friction, t + 20));
  for (int i = 1; i <= cubes; ++i) {
    for (const ContactProblem& part : parts) {
      all.bodies.push_back(part.bodies[static_cast<std::size_t>(i)]);
      all.free_velocity.push_back(part.free_velocity[static_cast<std::size_t>(i)]);
    }
  }
  for (std::size_t c = 0; c < parts[0].contacts.size(); ++c) {
    for (int t = 0; t < towers; ++t) {
      ProblemContact contact = parts[static_cast<std::size_t>(t)].contacts[c];
      for (int* body : {&contact.body_a, &contact.body_b})
        *body = *body == 0 ? 0 : 1 + towers * (*body - 1) + t;
      all.contacts.push_back(contact);
    }
  }
  return all;
}

TEST(Islands, FixedBodiesDoNotConnect) {
  ContactProblem problem = three_towers(0.5);
  problem.bodies.push_back(ProblemBody{});  // a body that touches nothing
  problem.free_velocity.push_back(Velocity6::Zero());
  const std::vector<Island> islands = find_islands(problem);
  ASSERT_EQ(islands.size(), 3u);
  EXPECT_EQ(islands[0].bodies, (std::vector<int>{0, 1, 4, 7}));
  EXPECT_EQ(islands[1].bodies, (std::vector<int>{0, 2, 5, 8}));
  EXPECT_EQ(islands[2].bodies, (std::vector<int>{0, 3, 6, 9}));
  std::size_t contacts = 0;
  for (const Island& island : islands) contacts += island.contacts.size();
  EXPECT_EQ(contacts, problem.contacts.size());
}

TEST(Islands, EqualTheWhole) {
  Worst worst;
  for (const double friction : {0.0, 0.5}) {
    ContactProblem problem = three_towers(friction);
    problem.bodies.push_back(ProblemBody{});
    problem.free_velocity.push_back(Velocity6::Constant(0.25));
    SolverMemory memory;
    const ContactSolution parts = ourengine::solve_exact(problem, {1e-10, 0}, {}, memory);
    const ContactSolution whole = ourengine::solve_newton(problem, {1e-10, 0}, {}, memory);
    ASSERT_EQ(parts.status, SolveStatus::kSolved) << parts.residual;
    ASSERT_EQ(whole.status, SolveStatus::kSolved) << whole.residual;
    EXPECT_LE(parts.residual, 2e-10);
    worst.see(largest_difference(parts.velocity, whole.velocity), std::to_string(friction));
    EXPECT_EQ(parts.velocity.back(), problem.free_velocity.back());
  }
  EXPECT_TRUE(worst.within(kIslands));
}

TEST(Repeat, BitwiseTheSameWhateverWasSolvedBefore) {
  for (const double friction : {0.0, 0.5}) {
    const ContactProblem problem = make_wall({4, 4, WallState::kImpact, friction});
    const ContactProblem other = make_wall({5, 6, WallState::kRest, friction});
    for (const SolverEntry& solver : solver_catalog()) {
      if (solver.frictionless && friction > 0.0) continue;
      const ourengine::SolveOptions options{1e-8, solver.name == "nsgs" ? 200 : 0};
      SolverMemory fresh, used;
      const ContactSolution first = solver.solve(problem, options, {}, fresh);
      solver.solve(other, options, {}, used);
      const ContactSolution second = solver.solve(problem, options, {}, used);
      EXPECT_EQ(largest_difference(first.velocity, second.velocity), 0.0) << solver.name;
      EXPECT_EQ(first.impulse_ns, second.impulse_ns) << solver.name;
      EXPECT_EQ(first.iterations, second.iterations) << solver.name;
    }
  }
}

// On problems with one solution: a resting wall, slipping towers.
// A wall large enough for its factor to be shared, with and without friction.
TEST(Repeat, BitwiseTheSameOnOneTwoAndFourThreads) {
  for (const double friction : {0.0, 0.5}) {
    const ContactProblem problem =
        make_wall({24, 24, friction > 0.0 ? WallState::kRest : WallState::kImpact, friction});
    std::vector<ourengine::ContactSolution> solutions;
    for (const int threads : {1, 2, 4, 2}) {
      SolverMemory memory(threads);
      solutions.push_back(ourengine::solve_exact(problem, {1e-10, 4}, {}, memory));
    }
    ourengine::SymbolicCache cache;
    const ourengine::ContactSystem system(problem, 1, cache);
    ASSERT_GE(system.symbolic().fronts.subtree.size(), 4u) << "nothing was shared";
    for (const auto& solution : solutions) {
      EXPECT_EQ(solution.velocity, solutions[0].velocity);
      EXPECT_EQ(solution.impulse_ns, solutions[0].impulse_ns);
    }
  }
}

TEST(Repeat, AWarmStartChangesTheCostNotTheAnswer) {
  Worst worst;
  for (const ContactProblem& before :
       {make_wall({4, 4, WallState::kRest, 0.5, true, 3}), random_tower(3, 0.2, 2)}) {
    ContactProblem now = before;
    for (Velocity6& velocity : now.free_velocity) velocity *= 1.0 + 1e-3;
    for (const auto solve : {ourengine::solve_exact, ourengine::solve_alm, ourengine::solve_newton,
                             ourengine::solve_nsgs}) {
      SolverMemory memory;
      const ContactSolution last = solve(before, {1e-10, 0}, {}, memory);
      const ContactSolution cold = solve(now, {1e-10, 0}, {}, memory);
      const ContactSolution warm = solve(now, {1e-10, 0}, WarmStart{last.impulse_ns}, memory);
      ASSERT_EQ(cold.status, SolveStatus::kSolved) << cold.method << cold.residual;
      ASSERT_EQ(warm.status, SolveStatus::kSolved) << warm.method << warm.residual;
      worst.see(largest_difference(cold.velocity, warm.velocity), warm.method);
    }
  }
  EXPECT_TRUE(worst.within(kWarm));
}

TEST(Repeat, ASolvedProblemIsKept) {
  const ContactProblem problem = make_wall({4, 4, WallState::kRest, 0.5});
  SolverMemory memory;
  const ContactSolution first = ourengine::solve_exact(problem, {1e-10, 0}, {}, memory);
  const ContactSolution again =
      ourengine::solve_exact(problem, {1e-10, 0}, WarmStart{first.impulse_ns}, memory);
  EXPECT_EQ(again.iterations, 0);
  EXPECT_EQ(again.factorisations, 0);
  EXPECT_EQ(again.impulse_ns, first.impulse_ns);
}

}  // namespace
}  // namespace brickbench::testing
