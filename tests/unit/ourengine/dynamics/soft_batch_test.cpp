// The passes over batches of soft contacts: SIMD against the scalar twins.
#include "ourengine/fast/soft_batch.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "tests/support/tolerance.hpp"

namespace ourengine {
namespace {

using brickbench::testing::Worst;

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
    batch.lanes = k_lanes;
    for (SoftPoint& point : batch.point) {
      fill_row(point.row);
      fill(point.mass, 0.3F);
      for (float& gap : point.gap) gap = 0.01F * any(random);
      for (float& gap : point.gap_now) gap = 0.01F * any(random);
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
      for (const std::size_t k : std::array<std::size_t, 6>{0, 1, 2, 4, 5, 6}) {
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
      for (std::size_t p = 0; p < k_soft_points; ++p) {
        ASSERT_EQ(simd[b].point[p].impulse, scalar[b].point[p].impulse);
        ASSERT_EQ(simd[b].point[p].gap_now, scalar[b].point[p].gap_now);
        ASSERT_EQ(simd[b].point[p].total, scalar[b].point[p].total);
      }
      ASSERT_EQ(simd[b].friction_impulse[0], scalar[b].friction_impulse[0]);
      ASSERT_EQ(simd[b].twist_impulse, scalar[b].twist_impulse);
      ASSERT_EQ(simd[b].friction_total, scalar[b].friction_total);
      ASSERT_EQ(simd[b].twist_total, scalar[b].twist_total);
    }
  }
}

std::vector<SoftInertia> random_inertias(std::mt19937_64& random, std::size_t bodies) {
  std::uniform_real_distribution<float> any(-0.2F, 0.2F);
  std::uniform_real_distribution<float> positive(0.5F, 1.0F);
  std::vector<SoftInertia> inertias(bodies + 1, SoftInertia{});
  for (std::size_t i = 0; i < bodies; ++i) {
    inertias[i] = {positive(random), any(random),      any(random),      positive(random),
                   any(random),      positive(random), positive(random), 0.0F};
  }
  return inertias;
}

// Byte for byte, but for padding, which neither writes.
TEST(SoftPrepare, SimdAndScalarTwinGiveTheSameNumbers) {
  std::mt19937_64 random(22);
  const int bodies = 160;
  for (int round = 0; round < 20; ++round) {
    std::vector<SoftBatch> simd = random_batches(random, 9, bodies);
    for (SoftBatch& batch : simd) {
      for (SoftPoint& point : batch.point)
        for (float& present : point.mass) present = present > 0.15F ? 1.0F : 0.0F;
      for (std::size_t k = 0; k < 3; ++k) batch.carried_friction[k] = batch.tangent[0][k];
    }
    std::vector<SoftBatch> scalar = simd;
    const std::vector<SoftInertia> inertias = random_inertias(random, bodies);
    soft_prepare(simd, inertias);
    soft_prepare_scalar(scalar, inertias);
    ASSERT_EQ(std::memcmp(simd.data(), scalar.data(), simd.size() * sizeof(SoftBatch)), 0)
        << "round " << round;
    std::vector<SoftVector> change(bodies + 1, SoftVector{});
    std::vector<SoftVector> change_scalar = change;
    soft_push(simd, change);
    soft_push_scalar(scalar, change_scalar);
    ASSERT_EQ(std::memcmp(change.data(), change_scalar.data(), change.size() * sizeof(SoftVector)),
              0)
        << "round " << round;
  }
}

// Rows against the textbook: the effective mass of a point is 1 / (J M^-1 J^T).
TEST(SoftPrepare, EffectiveMassIsThatOfTheTwoBodies) {
  SoftBatch batch{};
  batch.body_a.fill(2);
  batch.body_b.fill(2);
  batch.body_a[0] = 0;
  batch.body_b[0] = 1;
  batch.points = 1;
  batch.lanes = k_lanes;
  const Eigen::Vector3f n = Eigen::Vector3f(1, -2, 3).normalized();
  const Eigen::Vector3f arms[2] = {{0.1F, 0.2F, -0.3F}, {-0.2F, 0.05F, 0.1F}};
  for (std::size_t k = 0; k < 3; ++k) {
    batch.normal[k][0] = n[static_cast<Eigen::Index>(k)];
    batch.point[0].row.arm_a[k][0] = arms[0][static_cast<Eigen::Index>(k)];
    batch.point[0].row.arm_b[k][0] = arms[1][static_cast<Eigen::Index>(k)];
  }
  batch.point[0].mass[0] = 1.0F;
  const std::vector<SoftInertia> inertias = {
      {2, 0.1F, 0.2F, 3, 0.3F, 4, 0.5F, 0}, {5, 0.3F, 0.1F, 2, 0.2F, 6, 0.25F, 0}, {}};
  soft_prepare(std::span(&batch, 1), inertias);
  float sum = 0.75F;
  for (std::size_t k = 0; k < 2; ++k) {
    const SoftInertia& i = inertias[k];
    Eigen::Matrix3f inverse;
    inverse << i[0], i[1], i[2], i[1], i[3], i[4], i[2], i[4], i[5];
    const Eigen::Vector3f moment = arms[k].cross(n);
    sum += moment.dot(inverse * moment);
  }
  Worst worst;
  worst.see(std::abs(batch.point[0].mass[0] * sum - 1.0F), "of 1 / (J M^-1 J^T)");
  EXPECT_TRUE(worst.within({"effective mass, relative", 1.2e-6, 6e-8, "single precision"}));
  EXPECT_EQ(batch.point[0].mass[1], 0.0F) << "an empty lane has no point";
}

}  // namespace
}  // namespace ourengine
