// Head-on hits of two bricks through whole steps: whatever the gap is when the last step before
// the hit begins, the bricks go on together, and what a solver could not do is told.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "ourengine/exact/dynamics.hpp"
#include "tests/support/tolerance.hpp"
#include "tests/unit/ourengine/dynamics/wall.hpp"

namespace ourengine {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;
using testing::add_brick;
using testing::Wall;

struct Hit {
  double gap_m = 0.1;
  double speed_mps = 5.0;
  double step_s = 1e-3;
  double friction = 0.0;
  double restitution = 0.0;
  double size = 1.0;        // of the bricks, times 0.2 x 0.1 x 0.1 m
  double mass_ratio = 1.0;  // of the brick that is hit over the other
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  // of the whole scene
};

std::string name_of(const Hit& h) {
  return "gap " + std::to_string(h.gap_m) + " m, " + std::to_string(h.speed_mps) + " m/s, step " +
         std::to_string(h.step_s) + " s, mu " + std::to_string(h.friction) + ", e " +
         std::to_string(h.restitution) + ", size " + std::to_string(h.size) +
         ", masses 1 : " + std::to_string(h.mass_ratio);
}

struct Result {
  double approach_mps = 0.0;  // of the one to the other, afterwards
  double common_mps = 0.0;    // velocity of their common centre
  double energy_j = 0.0;      // kinetic, over that of the common motion
  double turning = 0.0;       // speed of a corner by spin, over the speed before
  bool unsolved = false;
};

// Flies until the bricks have met and some steps more. No gravity.
Result fly(const Hit& h, Solver solver) {
  Wall wall;
  const Eigen::Vector3d half = h.size * Eigen::Vector3d(0.1, 0.05, 0.05);
  add_brick(wall, half, {0, 0, 0}, {h.speed_mps, 0, 0});
  add_brick(wall, half, {2.0 * half.x() + h.gap_m, 0, 0});
  wall.bodies[1].mass_kg *= h.mass_ratio;
  wall.bodies[1].inertia_kgm2 *= h.mass_ratio;
  for (Motion& motion : wall.motions) {
    motion.position_m = h.turn * motion.position_m;
    motion.velocity_mps = h.turn * motion.velocity_mps;
    motion.attitude = h.turn;
  }
  DynamicsOptions options;
  options.step_s = h.step_s;
  options.gravity_mps2.setZero();
  options.solver = solver;
  options.solve = {1e-10, 0, 1e-6};
  options.frictionless = h.friction == 0.0;
  Dynamics dynamics(wall.bodies, wall.motions, SurfaceLaws(1, {h.friction, h.restitution}),
                    options);
  Result result;
  const int steps = static_cast<int>(std::ceil(h.gap_m / (h.speed_mps * h.step_s))) + 5;
  for (int i = 0; i < steps; ++i)
    result.unsolved = dynamics.step().status != SolveStatus::kSolved || result.unsolved;
  const double m[2] = {dynamics.bodies()[0].mass_kg, dynamics.bodies()[1].mass_kg};
  const auto v = [&](std::size_t i) {
    return (h.turn.conjugate() * dynamics.motions()[i].velocity_mps).x();
  };
  for (std::size_t i = 0; i < 2; ++i) {
    const Motion& end = dynamics.motions()[i];
    const Eigen::Vector3d spin = angular_velocity_radps(
        end.attitude, dynamics.bodies()[i].inertia_kgm2, end.angular_momentum_kgm2ps);
    result.turning = std::max(result.turning, spin.norm() * half.norm() / h.speed_mps);
  }
  result.approach_mps = v(0) - v(1);
  result.common_mps = (m[0] * v(0) + m[1] * v(1)) / (m[0] + m[1]);
  const double common_j = 0.5 * m[0] * m[0] / (m[0] + m[1]) * h.speed_mps * h.speed_mps;
  result.energy_j = (0.5 * m[0] * v(0) * v(0) + 0.5 * m[1] * v(1) * v(1)) / common_j;
  return result;
}

constexpr Tolerance k_equal{"energy after a plastic hit, over that of the common motion, minus 1",
                            5e-15, 4.5e-16,
                            "rounding: the contacts that carry load are solved for"};
constexpr Tolerance k_plastic{"the same over masses, sizes, speeds and steps", 5e-12, 3.1e-13,
                              "the residual of a solve, at most 1e-10 of the speed"};
constexpr Tolerance k_restituted{"approach after a hit, over -e times that before, minus 1", 5e-9,
                                 2.8e-10, "the residual of a solve, over e"};

// The 180 hits in which the gap closes within a step to some last bits, with and without friction.
TEST(PlasticHits, KeepTheEnergyOfTheCommonMotionWhateverTheGap) {
  Worst smooth, rough;
  for (int i = 1; i <= 20; ++i) {
    for (const double speed_mps : {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0}) {
      for (const Solver solver : {&solve_exact, &solve_ipm_first, &solve_dantzig_first}) {
        const Hit hit{.gap_m = 0.01 * i, .speed_mps = speed_mps};
        const Result result = fly(hit, solver);
        EXPECT_FALSE(result.unsolved) << name_of(hit);
        smooth.see(result.energy_j - 1.0, name_of(hit));
      }
      const Hit hit{.gap_m = 0.01 * i, .speed_mps = speed_mps, .friction = 0.5};
      const Result result = fly(hit, &solve_exact);
      EXPECT_FALSE(result.unsolved) << name_of(hit);
      rough.see(result.energy_j - 1.0, name_of(hit));
    }
  }
  EXPECT_TRUE(smooth.within(k_equal));
  EXPECT_TRUE(rough.within(k_equal));
}

// The same over friction, masses, sizes, speeds and steps; with restitution the bricks part at e
// times the speed.
TEST(PlasticHits, AndOverMassesSizesSpeedsAndSteps) {
  Worst plastic, restituted;
  for (const double size : {5e-3, 1.0, 50.0}) {
    for (const double speed_mps : {1e-3, 0.7, 5.0, 200.0}) {
      for (const double step_s : {1e-5, 1e-3, 1.0 / 60.0}) {
        for (const double mass_ratio : {1e-6, 0.3, 1e6}) {
          for (const double friction : {0.0, 0.5, 3.0}) {
            for (const double restitution : {0.0, 0.4, 1.0}) {
              // Some two and a half steps before they meet, to the last bit or not.
              for (const double steps : {2.0, 2.5}) {
                const Hit hit{steps * speed_mps * step_s,
                              speed_mps,
                              step_s,
                              friction,
                              restitution,
                              size,
                              mass_ratio};
                const Result result = fly(hit, &solve_exact);
                EXPECT_FALSE(result.unsolved) << name_of(hit);
                if (restitution == 0.0) {
                  plastic.see(result.energy_j - 1.0, name_of(hit));
                } else {
                  restituted.see(-result.approach_mps / (restitution * speed_mps) - 1.0,
                                 name_of(hit));
                }
              }
            }
          }
        }
      }
    }
  }
  EXPECT_TRUE(plastic.within(k_plastic));
  EXPECT_TRUE(restituted.within(k_restituted));
}

// Faces that meet at the very end of a step, where rounding puts some corners into it and others
// behind it, whatever the axes.
TEST(PlasticHits, AFaceIsHitAsAWholeWhateverTheAxes) {
  constexpr Tolerance k_turning = {"speed of a corner by spin, over that before", 5e-10, 3e-11,
                                   "the residual of a solve, at most 1e-10 of the speed"};
  std::mt19937_64 dice(3);
  std::uniform_real_distribution<> any(-1.0, 1.0);
  Worst turning, restituted;
  for (int trial = 0; trial < 400; ++trial) {
    Hit hit{.speed_mps = 5.0, .restitution = trial % 2 == 0 ? 1.0 : 0.4};
    hit.gap_m = (1 + trial % 7) * hit.speed_mps * hit.step_s;
    hit.friction = trial % 3 == 0 ? 0.5 : 0.0;
    hit.turn = Eigen::Quaterniond(any(dice), any(dice), any(dice), any(dice)).normalized();
    const Result result = fly(hit, &solve_exact);
    const std::string name = name_of(hit) + ", trial " + std::to_string(trial);
    EXPECT_FALSE(result.unsolved) << name;
    turning.see(result.turning, name);
    restituted.see(-result.approach_mps / (hit.restitution * hit.speed_mps) - 1.0, name);
  }
  EXPECT_TRUE(turning.within(k_turning));
  EXPECT_TRUE(restituted.within(k_restituted));
}

ContactSolution give_up(const ContactProblem& problem, const SolveOptions&, const WarmStart&,
                        SolverMemory&) {
  ContactSolution solution;
  solution.velocity = problem.free_velocity;
  solution.impulse_ns.assign(problem.contacts.size(), Eigen::Vector3d::Zero());
  solution.residual = 0.25;
  solution.status = SolveStatus::kStalled;
  solution.method = "none";
  return solution;
}

TEST(PlasticHits, AStepThatIsNotSolvedIsTold) {
  Wall wall;
  add_brick(wall, {0.1, 0.05, 0.05}, {0, 0, 0}, {1, 0, 0});
  add_brick(wall, {0.1, 0.05, 0.05}, {0.2, 0, 0});
  DynamicsOptions options;
  options.solver = give_up;
  Dynamics dynamics(wall.bodies, wall.motions, SurfaceLaws(), options);
  const StepReport& report = dynamics.step();
  EXPECT_EQ(report.status, SolveStatus::kStalled);
  EXPECT_EQ(report.residual, 0.25);
  EXPECT_EQ(report.method, "none");
}

}  // namespace
}  // namespace ourengine
