// The fast engine makes no energy, whatever hits what: families over restitution, friction, masses,
// sizes, speeds, places of the blow and steps.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "ourengine/fast/fast_dynamics.hpp"
#include "tests/support/tolerance.hpp"
#include "tests/unit/ourengine/dynamics/wall.hpp"

namespace ourengine {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;
using testing::add_brick;
using testing::deepest_overlap_m;
using testing::Wall;

// Islands are held to what they had in double precision.
constexpr Tolerance k_gain = {"energy gained in a step, relative", 3e-14, 1.9e-15,
                              "double precision of sums over the bodies"};
constexpr Tolerance k_rebound = {"velocities after a central hit, over the approach", 1e-6, 1.7e-7,
                                 "single precision of the sub-steps"};
constexpr Tolerance k_momentum = {"momentum of a hit, relative", 1e-14, 6.4e-16,
                                  "double precision: roundings of the sub-steps are taken out"};

struct Setting {
  SurfaceLaw law;
  double step_s = 1.0 / 240;
  double gravity_mps2 = 0.0;
};

FastDynamics engine_for(const Wall& scene, const Setting& setting) {
  FastOptions options;
  options.step_s = setting.step_s;
  options.substeps = std::max(1, static_cast<int>(std::ceil(setting.step_s * 4800 - 1e-9)));
  options.gravity_mps2 = {0.0, 0.0, -setting.gravity_mps2};
  return FastDynamics(scene.bodies, scene.motions, SurfaceLaws(1, setting.law), options);
}

double mechanical_energy_j(const FastDynamics& dynamics) {
  double energy_j = 0.0;
  for (std::size_t i = 0; i < dynamics.bodies().size(); ++i) {
    const BodyModel& body = dynamics.bodies()[i];
    if (body.fixed) continue;
    const Motion& motion = dynamics.motions()[i];
    const Eigen::Vector3d spin = motion.attitude.conjugate() * motion.angular_momentum_kgm2ps;
    energy_j += 0.5 * body.mass_kg * motion.velocity_mps.squaredNorm() +
                0.5 * spin.dot(spin.cwiseQuotient(body.inertia_kgm2)) -
                body.mass_kg * dynamics.options().gravity_mps2.dot(motion.position_m);
  }
  return energy_j;
}

Eigen::Vector3d momentum_ns(const FastDynamics& dynamics) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < dynamics.bodies().size(); ++i) {
    if (dynamics.bodies()[i].fixed) continue;
    sum += dynamics.bodies()[i].mass_kg * dynamics.motions()[i].velocity_mps;
  }
  return sum;
}

void add_slab(Wall& scene, const Eigen::Vector3d& half_m, const Eigen::Vector3d& at_m) {
  add_brick(scene, half_m, at_m);
  scene.bodies.back().fixed = true;
}

void spin_body(Wall& scene, std::size_t i, const Eigen::Vector3d& spin_radps) {
  scene.motions[i].angular_momentum_kgm2ps =
      scene.motions[i].attitude *
      scene.bodies[i].inertia_kgm2.cwiseProduct(scene.motions[i].attitude.conjugate() * spin_radps);
}

class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}
  double uniform(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random_);
  }
  double log(double from, double to) { return std::exp(uniform(std::log(from), std::log(to))); }
  Eigen::Vector3d vector(double size) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }
  double one_of(std::initializer_list<double> values) {
    return values.begin()[static_cast<std::size_t>(random_() % values.size())];
  }

 private:
  std::mt19937_64 random_;
};

// Two bricks face to face, without friction: each leaves with what Newton's law gives it, whatever
// the masses and where in the step they meet, and nothing turns. What does not bounce settles
// within the next steps.
TEST(FastEnergy, CentralHitsFollowNewtonsLaw) {
  Worst rebound;
  for (const double restitution : {0.0, 0.2, 0.5, 0.8, 1.0}) {
    for (const double ratio : {1e-5, 1e-2, 1.0, 7.0, 1e3, 1e5}) {
      for (const double gap_share : {0.03, 0.5, 0.97}) {
        const Setting setting = {{0.0, restitution}, 1e-3};
        Wall scene;
        const double speed_mps = 5.0;
        add_brick(scene, {0.1, 0.05, 0.03}, {0, 0, 0}, {speed_mps, 0, 0});
        add_brick(scene, {0.1, 0.05, 0.03}, {0.2 + gap_share * speed_mps * 1e-3, 0, 0}, {0, 0, 0},
                  2000.0 * ratio);
        FastDynamics dynamics = engine_for(scene, setting);
        for (int i = 0; i < 8; ++i) dynamics.step();
        const double share = 1.0 / (1.0 + ratio);  // mass of a over that of both
        const double common_mps = speed_mps * share;
        const double a_mps = common_mps - restitution * (1.0 - share) * speed_mps;
        const double b_mps = common_mps + restitution * share * speed_mps;
        const std::string where = "e " + std::to_string(restitution) + ", masses 1 to " +
                                  std::to_string(ratio) + ", gap " + std::to_string(gap_share);
        const auto& motions = dynamics.motions();
        rebound.see((motions[0].velocity_mps - Eigen::Vector3d(a_mps, 0, 0)).norm() / speed_mps,
                    where);
        rebound.see((motions[1].velocity_mps - Eigen::Vector3d(b_mps, 0, 0)).norm() / speed_mps,
                    where);
      }
    }
  }
  EXPECT_TRUE(rebound.within(k_rebound));
}

// Any two bricks in space, spinning, hitting each other anywhere.
TEST(FastEnergy, NoHitOfTwoBricksAddsEnergy) {
  Worst gain, momentum;
  for (unsigned seed = 0; seed < 300; ++seed) {
    Draw draw(seed);
    const double size_m = draw.log(3e-3, 3.0);
    const double speed_mps = draw.log(1e-2, 50.0);
    const auto half_m = [&]() -> Eigen::Vector3d {
      return Eigen::Vector3d(draw.log(0.1, 1.0), draw.log(0.1, 1.0), draw.log(0.1, 1.0)) * size_m;
    };
    const Eigen::Vector3d half_a = half_m(), half_b = half_m();
    Wall scene;
    add_brick(scene, half_a, {0, 0, 0}, {speed_mps, 0, 0}, draw.log(30.0, 3e4));
    add_brick(scene, half_b,
              {half_a.x() + half_b.x() + draw.log(1e-4, 0.3) * size_m,
               draw.uniform(-0.5, 0.5) * size_m, draw.uniform(-0.5, 0.5) * size_m},
              {0, 0, 0}, draw.log(30.0, 3e4) * draw.one_of({1.0, 1.0, 100.0}));
    spin_body(scene, 0, draw.vector(draw.log(0.1, 60.0)));
    spin_body(scene, 1, draw.vector(draw.log(0.1, 60.0)));
    const Setting setting = {{draw.one_of({0.0, 0.3, 1.0, 3.0}), draw.one_of({0.0, 0.3, 0.8, 1.0})},
                             draw.one_of({1e-4, 1e-3, 1.0 / 240, 1.0 / 60})};
    FastDynamics dynamics = engine_for(scene, setting);
    const double start_j = mechanical_energy_j(dynamics);
    const Eigen::Vector3d start_ns = momentum_ns(dynamics);
    double before_j = start_j;
    for (int i = 0; i < 100; ++i) {
      dynamics.step();
      const double now_j = mechanical_energy_j(dynamics);
      gain.see(std::max(0.0, now_j - before_j) / start_j, "seed " + std::to_string(seed));
      before_j = now_j;
    }
    double scale_ns = start_ns.norm();
    for (const Motion& motion : scene.motions) {
      scale_ns += motion.angular_momentum_kgm2ps.norm() / (0.1 * size_m);
    }
    momentum.see((momentum_ns(dynamics) - start_ns).norm() / scale_ns,
                 "seed " + std::to_string(seed));
  }
  EXPECT_TRUE(gain.within(k_gain));
  EXPECT_TRUE(momentum.within(k_momentum));
}

// 27 bricks that fly apart in a closed box and hit each other and its walls again and again.
TEST(FastEnergy, AnExplosionInABoxAddsNone) {
  Worst gain;
  for (unsigned seed = 0; seed < 6; ++seed) {
    Draw draw(seed);
    Wall scene;
    const double room_m = 0.5;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-1.0, 1.0}) {
        Eigen::Vector3d half_m = Eigen::Vector3d::Constant(room_m);
        half_m[axis] = 0.1;
        add_slab(scene, half_m, side * (room_m + 0.1) * Eigen::Vector3d::Unit(axis));
      }
    }
    for (int k = 0; k < 27; ++k) {
      const Eigen::Vector3d cell(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      add_brick(scene, {0.08, 0.05, 0.03}, cell.cwiseProduct(Eigen::Vector3d(0.165, 0.105, 0.065)),
                5.0 * cell + draw.vector(5.0), draw.log(500.0, 8000.0));
      spin_body(scene, scene.bodies.size() - 1, draw.vector(20.0));
    }
    const Setting setting = {{seed % 2 == 0 ? 0.0 : 0.5, seed < 4 ? 1.0 : 0.5},
                             seed < 3 ? 1e-3 : 1.0 / 240};
    FastDynamics dynamics = engine_for(scene, setting);
    const double start_j = mechanical_energy_j(dynamics);
    double before_j = start_j;
    for (int i = 0; i < 120; ++i) {
      dynamics.step();
      const double now_j = mechanical_energy_j(dynamics);
      gain.see(std::max(0.0, now_j - before_j) / start_j, "seed " + std::to_string(seed));
      before_j = now_j;
    }
    EXPECT_LT(deepest_overlap_m(dynamics.bodies(), dynamics.motions()), 1e-3) << "seed " << seed;
  }
  EXPECT_TRUE(gain.within(k_gain));
}

// A wall on the ground that a brick hits: the sum of both energies never exceeds its start by more
// than what the springs of the contacts held, half their load times their depth.
TEST(FastEnergy, AHitWallAddsNoneWhateverTheRestitution) {
  for (const double restitution : {0.0, 0.3, 0.5, 1.0}) {
    for (const double step_s : {1e-3, 1.0 / 240}) {
      Wall scene = testing::running_bond(4, 4, 0.001);
      add_brick(scene, {0.1, 0.05, 0.05}, {0.43, -0.5, 0.22}, {0.3, 20.0, -2.0}, 10000.0);
      FastDynamics dynamics = engine_for(scene, {{0.5, restitution}, step_s, 9.81});
      const double start_j = mechanical_energy_j(dynamics);
      double highest_j = start_j;
      double deepest_m = 0.0;
      for (int i = 0; i < static_cast<int>(0.5 / step_s); ++i) {
        dynamics.step();
        highest_j = std::max(highest_j, mechanical_energy_j(dynamics));
        deepest_m = std::max(deepest_m, deepest_overlap_m(dynamics.bodies(), dynamics.motions()));
      }
      // Observed: 0, since the first steps lose more than any later one brings back.
      EXPECT_LE(highest_j, start_j * (1.0 + 1e-9)) << "e " << restitution << ", step " << step_s;
      EXPECT_LT(deepest_m, 1e-3) << "e " << restitution << ", step " << step_s;
    }
  }
}

// A brick thrown at the ground any way, also by a blow within the step, comes to rest on it, or the
// run says that it does not.
TEST(FastEnergy, NothingSinksWhateverThrowsIt) {
  int bounced = 0;
  int told_runs = 0;
  for (unsigned seed = 0; seed < 120; ++seed) {
    Draw draw(seed);
    const double size_m = draw.log(3e-3, 1.0);
    const Eigen::Vector3d half_m =
        Eigen::Vector3d(draw.log(0.1, 1.0), draw.log(0.1, 1.0), draw.log(0.1, 1.0)) * size_m;
    Wall scene;
    BodyModel ground;
    ground.geometry = PlaneGeometry{};
    ground.fixed = true;
    scene.bodies.push_back(ground);
    scene.motions.push_back({});
    add_brick(scene, half_m, {0, 0, half_m.z() + draw.one_of({0.0, 0.3}) * size_m});
    const Setting setting = {{draw.one_of({0.0, 0.5, 3.0}), draw.one_of({0.0, 0.5, 1.0})},
                             draw.one_of({1e-3, 1.0 / 240, 1.0 / 60}),
                             9.81};
    FastDynamics dynamics = engine_for(scene, setting);
    const double speed_mps = draw.log(0.1, 60.0);
    double before_j = 0.0;
    double overlap_m = 0.0;
    double scale_j = 1.0;
    bool told = false;
    for (int i = 0; i < 60; ++i) {
      if (i == 1) {
        const BodyModel& body = scene.bodies[1];
        const Eigen::Vector3d spin_radps = draw.vector(speed_mps / size_m);
        dynamics.apply(
            std::vector<Load>{{},
                              {body.mass_kg / setting.step_s *
                                   (draw.vector(speed_mps) - Eigen::Vector3d(0, 0, speed_mps)),
                               spin_radps * body.inertia_kgm2.minCoeff() / setting.step_s}});
      }
      // What gravity does on the way down that the ground cuts short is not taken from the
      // velocity.
      const double fall_m =
          setting.step_s * (std::max(0.0, -dynamics.motions()[1].velocity_mps.z()) +
                            0.5 * setting.gravity_mps2 * setting.step_s);
      dynamics.step();
      const double now_j = mechanical_energy_j(dynamics);
      if (i == 1) scale_j = std::abs(now_j);
      // An overlap that is pushed out lifts the brick; up to half a margin may be new in the step.
      if (i > 1) {
        const double lifted_m = overlap_m + fall_m + 0.5 * dynamics.options().margin_m;
        ASSERT_LE(now_j - before_j, 1e-6 * scale_j + 9.81 * scene.bodies[1].mass_kg * lifted_m)
            << "seed " << seed << ", step " << i;
      }
      before_j = now_j;
      overlap_m = deepest_overlap_m(dynamics.bodies(), dynamics.motions());
      const FastReport& report = dynamics.report();
      told = told || report.overlap_left_m > 0.0 || report.ran_out || report.unsolved;
      ASSERT_TRUE(told || overlap_m < std::max(1e-3, 0.05 * half_m.minCoeff()))
          << "seed " << seed << ", step " << i << ": " << overlap_m << " m";
    }
    told_runs += told ? 1 : 0;
    bounced += dynamics.motions()[1].position_m.z() > 1.5 * half_m.norm() ? 1 : 0;
  }
  EXPECT_GT(bounced, 10) << "the family has nothing that flies";
  EXPECT_LE(told_runs, 12) << "what is told is the exception";
}

// What the springs cannot hold is told: the deepest contact is the deepest overlap there is, and an
// overlap of more than a twentieth of the thinner body raises the flag.
TEST(FastEnergy, HeavyOnLightIsHeldOrTold) {
  for (const double ratio : {1.0, 10.0, 100.0, 1e3, 2500.0, 1e4, 25000.0, 1e5, 1e6}) {
    Wall scene;
    BodyModel ground;
    ground.geometry = PlaneGeometry{};
    ground.fixed = true;
    scene.bodies.push_back(ground);
    scene.motions.push_back({});
    add_brick(scene, {0.1, 0.1, 0.05}, {0, 0, 0.05}, {0, 0, 0}, 100.0);
    add_brick(scene, {0.1, 0.1, 0.05}, {0, 0, 0.15}, {0, 0, 0}, 100.0 * ratio);
    FastDynamics dynamics = engine_for(scene, {{0.5, 0.0}, 1.0 / 240, 9.81});
    for (int i = 0; i < 240; ++i) {
      const FastReport& report = dynamics.step();
      const double overlap_m = deepest_overlap_m(dynamics.bodies(), dynamics.motions());
      ASSERT_NEAR(report.deepest_m, overlap_m, 1e-5 + 0.05 * overlap_m)
          << "ratio " << ratio << ", step " << i;
      const bool told = report.overlap_left_m > 0.0 || report.ran_out || report.unsolved;
      ASSERT_TRUE(told || overlap_m <= 1.05 * FastLimits::k_told_share * 0.1)
          << "ratio " << ratio << ", step " << i << ": " << overlap_m << " m";
    }
  }
}

}  // namespace
}  // namespace ourengine
