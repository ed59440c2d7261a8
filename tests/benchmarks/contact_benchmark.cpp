// Times of the contact solvers on brick walls (tests/support/contact_walls.hpp), thread CPU time.
//
//   ourengine_contact_benchmark --benchmark_filter=frictionless --benchmark_repetitions=5
//
// Each row has counters: the residual of the law that was solved (relative, natural map), the
// iterations of the method, and `missed`, the number of solves that missed their tolerance.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "ourengine/contact/solvers.hpp"
#include "tests/support/contact_walls.hpp"

namespace {

using brickbench::testing::make_wall;
using brickbench::testing::WallSpec;
using brickbench::testing::WallState;
using ourengine::ContactProblem;
using ourengine::ContactSolution;
using ourengine::Solver;
using ourengine::SolverMemory;
using ourengine::SolveStatus;

struct Tally {
  double residual = 0.0;
  double iterations = 0.0;
  double missed = 0.0;
  double solves = 0.0;

  void add(const ContactSolution& solution) {
    residual = std::max(residual, solution.residual);
    iterations += solution.iterations;
    missed += solution.status == SolveStatus::kSolved ? 0.0 : 1.0;
    solves += 1.0;
  }
  void report(benchmark::State& state) const {
    state.counters["residual"] = residual;
    state.counters["iterations"] = iterations / solves;
    state.counters["missed"] = missed;
  }
};

// Cold solves of one problem; the symbolic factorisation is kept, as from step to step.
void cold(benchmark::State& state, Solver solver, const WallSpec& spec, double tolerance,
          int threads = 1) {
  const ContactProblem problem = make_wall(spec);
  SolverMemory memory(threads);
  Tally tally;
  for (auto _ : state) {
    const ContactSolution solution = solver(problem, {tolerance, 0}, {}, memory);
    benchmark::DoNotOptimize(solution.velocity.data());
    tally.add(solution);
  }
  tally.report(state);
}

// Steps of a standing wall: each starts from the velocities and impulses of the last, with gravity
// and noise of `stir_mps` on every velocity component. Positions are frozen.
void standing(benchmark::State& state, int size, double stir_mps, double tolerance) {
  ContactProblem problem = make_wall({size, size, WallState::kRest, 0.5});
  SolverMemory memory;
  Tally tally;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  ContactSolution last = ourengine::solve_exact(problem, {tolerance, 0}, {}, memory);
  for (auto _ : state) {
    state.PauseTiming();
    for (std::size_t i = 1; i < problem.bodies.size(); ++i) {
      problem.free_velocity[i] = last.velocity[i];
      problem.free_velocity[i][2] -= 9.81 * problem.step_s;
      for (int c = 0; c < 6; ++c) problem.free_velocity[i][c] += stir_mps * normal(random);
    }
    const ourengine::WarmStart warm{last.impulse_ns};
    state.ResumeTiming();
    last = ourengine::solve_exact(problem, {tolerance, 0}, warm, memory);
    tally.add(last);
  }
  tally.report(state);
}

template <class Function>
void add(const std::string& name, Function function) {
  benchmark::RegisterBenchmark(name.c_str(), function)->Unit(benchmark::kMillisecond)->MinTime(0.2);
}

std::string square(int size) { return std::to_string(size) + "x" + std::to_string(size); }

void add_frictionless() {
  for (const WallState wall : {WallState::kRest, WallState::kImpact}) {
    const std::string name = wall == WallState::kRest ? "rest" : "impact";
    for (const int size : {10, 20, 30, 50}) {
      for (const unsigned seed : {1u, 2u, 3u}) {
        add("frictionless/" + name + "/" + square(size) + "/seed" + std::to_string(seed),
            [=](benchmark::State& state) {
              cold(state, ourengine::solve_ipm, {size, size, wall, 0.0, true, seed}, 1e-10);
            });
      }
    }
  }
}

void add_friction() {
  for (const int size : {10, 20, 30}) {
    add("friction_at_rest/" + square(size), [=](benchmark::State& state) {
      cold(state, ourengine::solve_exact, {size, size, WallState::kRest, 0.5}, 1e-10);
    });
  }
  for (const int digits : {3, 6, 10}) {
    const double tolerance = std::pow(10.0, -digits);
    for (const unsigned seed : {1u, 2u, 3u, 4u, 5u}) {
      add("slipping_impact/10x10/to" + std::to_string(digits) + "digits/seed" +
              std::to_string(seed),
          [=](benchmark::State& state) {
            cold(state, ourengine::solve_newton, {10, 10, WallState::kImpact, 0.5, true, seed},
                 tolerance);
          });
    }
  }
}

// Wall time of one cold frictionless solve, one and two threads.
void add_threads() {
  for (const int size : {30, 50, 100}) {
    for (const int threads : {1, 2}) {
      benchmark::RegisterBenchmark(
          ("threads/impact/" + square(size) + "/" + std::to_string(threads)).c_str(),
          [=](benchmark::State& state) {
            cold(state, ourengine::solve_ipm, {size, size, WallState::kImpact, 0.0}, 1e-10,
                 threads);
          })
          ->Unit(benchmark::kMillisecond)
          ->UseRealTime()
          ->MeasureProcessCPUTime();
    }
  }
}

void add_standing() {
  for (const int size : {10, 20, 30}) {
    for (const int digits : {0, 9, 7, 6}) {  // 0: no noise
      const double stir_mps = digits == 0 ? 0.0 : std::pow(10.0, -digits);
      add("standing/" + square(size) + "/stir_digits" + std::to_string(digits),
          [=](benchmark::State& state) { standing(state, size, stir_mps, 1e-8); });
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  add_frictionless();
  add_friction();
  add_standing();
  add_threads();
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
