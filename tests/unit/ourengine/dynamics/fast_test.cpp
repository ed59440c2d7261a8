#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <random>
#include <string>

#include "ourengine/fast/fast_dynamics.hpp"
#include "tests/support/tolerance.hpp"
#include "tests/unit/ourengine/dynamics/wall.hpp"

namespace ourengine {
namespace {

using brickbench::testing::Worst;
using testing::add_brick;
using testing::running_bond;
using testing::Wall;

// Batches of random numbers: nothing physical, every branch taken.
std::vector<SoftBatch> random_batches(std::mt19937_64& random, int count, int bodies) {
  std::uniform_real_distribution<float> any(-1.0F, 1.0F);
  std::uniform_real_distribution<float> positive(0.01F, 1.0F);
  std::vector<SoftBatch> batches(static_cast<std::size_t>(count));
  const auto fill3 = [&](Lane3& lanes) {
    for (Lane& lane : lanes)
      for (float& x : lane) x = any(random);
  };
  const auto fill = [&](Lane& lane, float scale) {
    for (float& x : lane) x = scale * positive(random);
  };
  const auto fill_row = [&](SoftRow& row) {
    fill3(row.arm_a);
    fill3(row.arm_b);
    fill3(row.turn_a);
    fill3(row.turn_b);
  };
  int next = 0;
  for (SoftBatch& batch : batches) {
    for (std::size_t i = 0; i < k_lanes; ++i) {
      batch.body_a[i] = next++ % bodies;
      batch.body_b[i] = i == 3 ? bodies : next++ % bodies;  // one lane rests on the fixed body
    }
    fill3(batch.normal);
    fill3(batch.tangent[0]);
    fill3(batch.tangent[1]);
    fill(batch.inverse_mass_a, 1.0F);
    fill(batch.inverse_mass_b, 1.0F);
    batch.points = 1 + count % k_soft_points;
    for (SoftPoint& point : batch.point) {
      fill_row(point.row);
      fill(point.mass, 0.3F);
      for (float& gap : point.gap) gap = 0.01F * any(random);
      fill(point.impulse, 1.0F);
      point.bounce.fill(0.0F);
      point.max_impulse.fill(0.0F);
    }
    fill_row(batch.friction_row[0]);
    fill_row(batch.friction_row[1]);
    fill(batch.friction_mass_11, 0.3F);
    fill(batch.friction_mass_12, 0.05F);
    fill(batch.friction_mass_22, 0.3F);
    fill(batch.friction_impulse[0], 0.3F);
    fill(batch.friction_impulse[1], 0.3F);
    fill3(batch.twist_a);
    fill3(batch.twist_b);
    fill(batch.twist_mass, 0.3F);
    fill(batch.twist_impulse, 0.3F);
    fill(batch.twist_arm, 0.1F);
    fill(batch.friction, 0.5F);
  }
  return batches;
}

// The sign of a zero impulse may differ; nothing else may.
TEST(SoftSweep, SimdAndScalarTwinGiveTheSameNumbers) {
  std::mt19937_64 random(21);
  std::uniform_real_distribution<float> any(-1.0F, 1.0F);
  const int bodies = 160;
  for (int round = 0; round < 50; ++round) {
    std::vector<SoftBatch> simd = random_batches(random, 9, bodies);
    std::vector<SoftBatch> scalar = simd;
    std::vector<SoftVector> velocity(bodies + 1, SoftVector{});
    std::vector<SoftVector> moved(bodies + 1, SoftVector{});
    for (std::size_t i = 0; i < bodies; ++i)
      for (const std::size_t k : {0, 1, 2, 4, 5, 6}) {
        velocity[i][k] = any(random);
        moved[i][k] = 1e-3F * any(random);
      }
    std::vector<SoftVector> velocity_scalar = velocity;
    const SoftStep step{1.0F / 960, 36.0F, 0.94F, 0.06F, 3.0F};
    const bool biased = round % 2 == 0;
    soft_sweep(simd, step, biased, velocity, moved);
    soft_sweep_scalar(scalar, step, biased, velocity_scalar, moved);
    ASSERT_EQ(
        std::memcmp(velocity.data(), velocity_scalar.data(), velocity.size() * sizeof(SoftVector)),
        0)
        << "round " << round;
    for (std::size_t b = 0; b < simd.size(); ++b) {
      for (std::size_t p = 0; p < k_soft_points; ++p)
        ASSERT_EQ(simd[b].point[p].impulse, scalar[b].point[p].impulse);
      ASSERT_EQ(simd[b].friction_impulse[0], scalar[b].friction_impulse[0]);
      ASSERT_EQ(simd[b].twist_impulse, scalar[b].twist_impulse);
    }
  }
}

FastOptions options_of(double step_s, int substeps) {
  FastOptions options;
  options.step_s = step_s;
  options.substeps = substeps;
  return options;
}

// The static overlap of a soft contact under n bricks' load: see docs/contact.md. Bounds, not
// tolerances: what the engine promises at this setting.
TEST(FastDynamics, WallStandsWithinItsPromise) {
  const Wall wall = running_bond(6, 6);
  FastDynamics dynamics(wall.bodies, wall.motions, SurfaceLaws(1, {0.5, 0.0}),
                        options_of(1.0 / 240, 8));
  double deepest = 0.0;
  for (int i = 0; i < 480; ++i) {
    dynamics.step();
    for (const ContactPoint& point : dynamics.contacts()) deepest = std::min(deepest, point.gap_m);
  }
  EXPECT_GT(deepest, -1e-4);
  for (std::size_t k = 0; k < wall.motions.size(); ++k) {
    ASSERT_LT((dynamics.motions()[k].position_m - wall.motions[k].position_m).norm(), 3e-4) << k;
    ASSERT_LT(dynamics.motions()[k].velocity_mps.norm(), 1e-4) << k;
  }
}

TEST(FastDynamics, MomentumOfACollisionInSpaceIsKept) {
  Wall wall;
  add_brick(wall, {0.1, 0.05, 0.05}, {0, 0, 0}, {2, 0.3, 0});
  add_brick(wall, {0.1, 0.05, 0.05}, {0.3, 0.04, 0.01}, {-1, 0, 0.2}, 4000.0);
  FastOptions options = options_of(1.0 / 240, 8);
  options.gravity_mps2.setZero();
  FastDynamics dynamics(wall.bodies, wall.motions, SurfaceLaws(1, {0.5, 0.5}), options);
  const auto momentum = [&] {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < 2; ++i)
      sum += wall.bodies[i].mass_kg * dynamics.motions()[i].velocity_mps;
    return sum;
  };
  const Eigen::Vector3d before = momentum();
  for (int i = 0; i < 120; ++i) dynamics.step();
  EXPECT_GT(dynamics.motions()[1].velocity_mps.x(), 0.0) << "they never met";
  Worst worst;
  worst.see((momentum() - before).norm() / before.norm(), "after the hit");
  EXPECT_TRUE(worst.within({"momentum, relative", 5e-7, 2.7e-8, "single precision, 8 sub-steps"}));
}

TEST(FastDynamics, RunsRepeatBitForBitAlsoAfterSetMotions) {
  Wall wall = running_bond(4, 4);
  add_brick(wall, {0.1, 0.05, 0.05}, {0.4, -0.3, 0.2}, {0, 20, 0});
  const auto make = [&](std::span<const Motion> motions) {
    return std::make_unique<FastDynamics>(wall.bodies,
                                          std::vector<Motion>(motions.begin(), motions.end()),
                                          SurfaceLaws(1, {0.5, 0.0}), options_of(1.0 / 240, 4));
  };
  auto used = make(wall.motions);
  for (int i = 0; i < 20; ++i) used->step();
  const std::vector<Motion> now(used->motions().begin(), used->motions().end());
  used->set_motions(now);
  auto fresh = make(now);
  for (int i = 0; i < 20; ++i) {
    used->step();
    fresh->step();
  }
  for (std::size_t i = 0; i < now.size(); ++i) {
    ASSERT_EQ(used->motions()[i].position_m, fresh->motions()[i].position_m) << i;
    ASSERT_EQ(used->motions()[i].velocity_mps, fresh->motions()[i].velocity_mps) << i;
  }
}

}  // namespace
}  // namespace ourengine
