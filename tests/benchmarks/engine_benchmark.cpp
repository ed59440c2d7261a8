// Parts of the velocity-level engine against the clock: separating axes per pair of nearly touching
// bricks, steps of the soft engine on standing walls with one and two threads, and a body in free
// rotation.
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "ourengine/fast/fast_dynamics.hpp"
#include "ourengine/integration/rotation.hpp"
#include "tests/support/box_batch.hpp"
#include "tests/support/rotate_cf4.hpp"
#include "tests/unit/ourengine/dynamics/wall.hpp"

namespace ourengine {
namespace {

struct Pairs {
  std::vector<PosedBox> boxes;
  std::vector<PackedBox> packed;
  std::vector<BodyPair> pairs;
};

// Neighbours in a running bond of 100 x 100 bricks, shaken by 0.5 mm and 0.01 rad, or turned at
// will: gaps of a millimetre or so.
Pairs nearly_touching(double tilt_rad) {
  const testing::Wall wall = testing::running_bond(100, 100);
  std::mt19937_64 random(41);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  Pairs scene;
  std::vector<Aabb> bounds;
  for (std::size_t i = 1; i < wall.bodies.size(); ++i) {
    const Eigen::Vector3d axis(any(random), any(random), any(random));
    const Eigen::Vector3d shake(any(random), any(random), any(random));
    const Eigen::Vector3d half = std::get<BoxGeometry>(wall.bodies[i].geometry).half_m;
    const Eigen::Vector3d at = wall.motions[i].position_m + 5e-4 * shake;
    scene.boxes.push_back(
        {half, at,
         Eigen::AngleAxisd(tilt_rad * any(random), axis.normalized()).toRotationMatrix()});
    scene.packed.push_back(pack(scene.boxes.back()));
    const Eigen::Vector3d reach = half + Eigen::Vector3d::Constant(5e-4);
    bounds.push_back({at - reach, at + reach});
  }
  BroadPhase broad_phase(std::vector<bool>(bounds.size(), false), 1e-9);
  broad_phase.update(bounds);
  scene.pairs.assign(broad_phase.pairs().begin(), broad_phase.pairs().end());
  return scene;
}

double per_pair(benchmark::State& state, const Pairs& scene) {
  return static_cast<double>(state.iterations()) * static_cast<double>(scene.pairs.size());
}

void separate_scalar(benchmark::State& state) {
  const Pairs scene = nearly_touching(1e-2 * static_cast<double>(state.range(0)));
  for (auto _ : state) {
    for (const BodyPair& pair : scene.pairs) {
      benchmark::DoNotOptimize(separate(scene.boxes[static_cast<std::size_t>(pair.first)],
                                        scene.boxes[static_cast<std::size_t>(pair.second)], 1e-3));
    }
  }
  state.counters["pairs"] = static_cast<double>(scene.pairs.size());
  state.counters["per_pair"] = benchmark::Counter(
      per_pair(state, scene), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void separate_batch(benchmark::State& state) {
  const Pairs scene = nearly_touching(1e-2 * static_cast<double>(state.range(0)));
  std::vector<PairSeparation> out(scene.pairs.size());
  for (auto _ : state) {
    separate_pairs(scene.packed, scene.pairs, 1e-3, out);
    benchmark::DoNotOptimize(out.data());
  }
  state.counters["pairs"] = static_cast<double>(scene.pairs.size());
  state.counters["per_pair"] = benchmark::Counter(
      per_pair(state, scene), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

// A standing wall of n x n at the default sub-steps; wall time, threads as given.
void fast_step(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  const testing::Wall wall = testing::running_bond(n, n);
  FastOptions options;
  options.threads = static_cast<int>(state.range(1));
  FastDynamics engine(wall.bodies, wall.motions, SurfaceLaws(1, {0.5, 0.0}), options);
  for (int i = 0; i < 5; ++i) engine.step();
  for (auto _ : state) engine.step();
  state.counters["per_brick"] = benchmark::Counter(
      static_cast<double>(state.iterations()) * static_cast<double>(wall.bodies.size() - 1),
      benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

// A brick that spins at 10 rad/s about its middle axis, slightly off, and flips again and again.
struct Spin {
  Eigen::Vector3d inertia_kgm2 = {0.0125 / 3, 0.0425 / 3, 0.05 / 3};
  Eigen::Vector3d momentum_kgm2ps = inertia_kgm2.cwiseProduct(Eigen::Vector3d(0.01, 10.0, 0.02));

  double energy_j(const Eigen::Quaterniond& q) const {
    return 0.5 * momentum_kgm2ps.dot(angular_velocity_radps(q, inertia_kgm2, momentum_kgm2ps));
  }
  Eigen::Quaterniond run(decltype(&rotate_moser_veselov) rotate, int per_s, int duration_s) const {
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
    for (int i = 0; i < per_s * duration_s; ++i) {
      q = rotate(q, inertia_kgm2, momentum_kgm2ps, 1.0 / per_s);
    }
    return q;
  }
};

// Time of a step, and counters: the largest relative error of the energy over 100 s at 1/240 s,
// and the attitude after 10 s beside that of another scheme with a step of 1/61440 s.
void torque_free(benchmark::State& state) {
  const Spin spin;
  constexpr int k_per_s = 240;
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  const auto step = [&] {
    q = rotate_moser_veselov(q, spin.inertia_kgm2, spin.momentum_kgm2ps, 1.0 / k_per_s);
  };
  const double start_j = spin.energy_j(q);
  double error = 0.0;
  for (int i = 0; i < 100 * k_per_s; ++i) {
    step();
    error = std::max(error, std::abs(spin.energy_j(q) / start_j - 1.0));
  }
  for (auto _ : state) {
    step();
    benchmark::DoNotOptimize(q);
  }
  state.counters["energy_error"] = error;
  state.counters["attitude_error_rad"] =
      spin.run(&rotate_moser_veselov, k_per_s, 10)
          .angularDistance(spin.run(&brickbench::testing::rotate_cf4, 61440, 10));
}

BENCHMARK(torque_free);
BENCHMARK(separate_scalar)->ArgName("tilt_crad")->Arg(1)->Arg(300);
BENCHMARK(separate_batch)->ArgName("tilt_crad")->Arg(1)->Arg(300);
BENCHMARK(fast_step)
    ->ArgNames({"n", "threads"})
    ->ArgsProduct({{10, 30, 50, 100}, {1, 2}})
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace ourengine

BENCHMARK_MAIN();
