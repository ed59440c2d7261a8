// Newton's law as one problem, and the energy bound, apart from the engine that uses them.
#include "ourengine/fast/rebound.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <tuple>
#include <vector>

#include "tests/support/tolerance.hpp"

namespace ourengine {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;

constexpr Tolerance k_law = {"velocity beyond its target, over the largest target", 2e-6, 2e-7,
                             "k_rebound_share and how fast the sweeps converge"};
constexpr Tolerance k_kept = {"momenta and energies, relative", 1e-13, 1e-15, "double precision"};

// A row of balls that touch, with these masses, joined by central contacts; the last one may be
// fixed (mass 0).
struct Chain {
  std::vector<double> masses_kg;
  std::vector<Twist> velocity;
  std::vector<ReboundRow> rows;
};

Chain chain_of(std::vector<double> masses_kg, std::vector<double> speeds_mps) {
  Chain chain{std::move(masses_kg), {}, {}};
  for (const double speed : speeds_mps) chain.velocity.push_back({{0, 0, speed}, {0, 0, 0}});
  const auto inverse = [](double mass_kg) { return mass_kg > 0.0 ? 1.0 / mass_kg : 0.0; };
  for (std::size_t i = 0; i + 1 < chain.masses_kg.size(); ++i) {
    ReboundRow row;
    row.body_a = static_cast<int>(i);
    row.body_b = static_cast<int>(i + 1);
    row.count = 1;
    row.inverse_mass_a = inverse(chain.masses_kg[i]);
    row.inverse_mass_b = inverse(chain.masses_kg[i + 1]);
    chain.rows.push_back(row);
  }
  return chain;
}

double separation_mps(const Chain& chain, std::size_t row) {
  return chain.velocity[row + 1].linear.z() - chain.velocity[row].linear.z();
}

// One call ends where changes are small beside its first; others go on until nothing changes.
bool settle_fully(std::span<ReboundRow> rows, double fastest_mps, std::span<Twist> velocity) {
  for (int calls = 0; calls < 1000; ++calls) {
    const std::vector<Twist> before(velocity.begin(), velocity.end());
    settle_rebound(rows, fastest_mps, velocity);
    double change_mps = 0.0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      change_mps = std::max(change_mps, (velocity[i].linear - before[i].linear).norm());
    }
    if (change_mps <= k_rebound_share * fastest_mps) return true;
  }
  return false;
}

// Three balls after a plastic hit of the first: all leave as the one problem of Newton's law says,
// -1/3, 2/3, 2/3, whatever the order of contacts.
TEST(Rebound, SolvesACradleAsOneProblem) {
  Chain chain = chain_of({1, 1, 1}, {1.0 / 3, 1.0 / 3, 1.0 / 3});
  chain.rows[0].target_mps[0] = 1.0;
  chain.rows[0].impulse_ns[0] = 2.0 / 3;
  chain.rows[1].impulse_ns[0] = 1.0 / 3;
  ASSERT_TRUE(settle_fully(chain.rows, 1e-2, chain.velocity));
  Worst worst;
  worst.see(chain.velocity[0].linear.z() + 1.0 / 3, "first");
  worst.see(chain.velocity[1].linear.z() - 2.0 / 3, "second");
  worst.see(chain.velocity[2].linear.z() - 2.0 / 3, "third");
  EXPECT_TRUE(worst.within(k_law));
}

// Random chains: targets are met, no impulse pulls, and only where a target is met exactly is there
// an impulse.
TEST(Rebound, IsComplementary) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> any(0.0, 1.0);
  Worst worst;
  for (int round = 0; round < 200; ++round) {
    const std::size_t n = 2 + random() % 5;
    std::vector<double> masses_kg, speeds_mps;
    for (std::size_t i = 0; i < n; ++i) {
      masses_kg.push_back(std::pow(10.0, any(random) - 0.5));
      speeds_mps.push_back(2.0 * any(random) - 1.0);
    }
    if (round % 3 == 0) {
      masses_kg.back() = 0.0;
      speeds_mps.back() = 0.0;
    }
    Chain chain = chain_of(masses_kg, speeds_mps);
    double largest_mps = 0.0;
    for (ReboundRow& row : chain.rows) {
      if (any(random) < 0.3) continue;
      row.target_mps[0] = any(random);
      row.impulse_ns[0] = any(random);
      largest_mps = std::max(largest_mps, row.target_mps[0]);
    }
    if (largest_mps == 0.0) continue;
    ASSERT_TRUE(settle_fully(chain.rows, 1e-5 * largest_mps, chain.velocity)) << round;
    for (std::size_t k = 0; k < chain.rows.size(); ++k) {
      const ReboundRow& row = chain.rows[k];
      const double beyond_mps = separation_mps(chain, k) - row.target_mps[0];
      ASSERT_GE(row.impulse_ns[0], 0.0);
      worst.see(std::min(0.0, beyond_mps) / largest_mps, "target");
      if (row.impulse_ns[0] > 0.0) worst.see(beyond_mps / largest_mps, "impulse");
    }
  }
  EXPECT_TRUE(worst.within(k_law));
}

// A slab of any shape that comes down on one to four points of fixed ground, any way, with some
// impulses already in its velocity.
struct Slab {
  double mass_kg = 1.0;
  Eigen::Matrix3d inertia_kgm2 = Eigen::Matrix3d::Identity();
  std::vector<Twist> velocity = std::vector<Twist>(2);  // of the ground, of the slab
  ReboundRow row;

  double kinetic_j() const {
    const Twist& v = velocity[1];
    return 0.5 * mass_kg * v.linear.squaredNorm() + 0.5 * v.angular.dot(inertia_kgm2 * v.angular);
  }
  Eigen::Vector2d slip_mps() const {
    const Twist& v = velocity[1];
    return {row.tangent[0].dot(v.linear) + row.slide[0].on_b.dot(v.angular),
            row.tangent[1].dot(v.linear) + row.slide[1].on_b.dot(v.angular)};
  }
};

Slab slab_of(std::mt19937_64& random) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const auto vector = [&] { return Eigen::Vector3d(any(random), any(random), any(random)); };
  Slab slab;
  slab.mass_kg = std::exp(2.0 * any(random));
  slab.inertia_kgm2.diagonal() =
      slab.mass_kg *
      Eigen::Vector3d(0.5 + 0.4 * any(random), 0.5 + 0.4 * any(random), 0.5 + 0.4 * any(random));
  slab.velocity[1] = {vector() - Eigen::Vector3d(0, 0, 2), 2.0 * vector()};
  const auto set = [&](ReboundRow::Arm& arm, const Eigen::Vector3d& on_b) {
    arm.on_b = on_b;
    arm.turn_b = slab.inertia_kgm2.inverse() * on_b;
  };
  ReboundRow& row = slab.row;
  row.body_a = 0;
  row.body_b = 1;
  row.count = 1 + random() % 4;
  row.inverse_mass_b = 1.0 / slab.mass_kg;
  row.friction = std::exp(2.0 * any(random) - 1.0);
  row.tangent = {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()};
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (std::size_t p = 0; p < row.count; ++p) {
    const Eigen::Vector3d lever(any(random), any(random), -0.5);
    middle += lever / static_cast<double>(row.count);
    set(row.point[p], lever.cross(row.normal));
  }
  for (std::size_t k = 0; k < 2; ++k) set(row.slide[k], middle.cross(row.tangent[k]));
  set(row.twist, row.normal);
  row.twist_arm_m = 0.3;
  return slab;
}

// Friction stays in its cone, stops what it can and opposes what it cannot; nothing that is plastic
// gives energy (Carnot).
TEST(Rebound, HoldsCoulombsLaw) {
  std::mt19937_64 random(11);
  Worst stuck, opposed, energy;
  int slides = 0, sticks = 0;
  for (int round = 0; round < 300; ++round) {
    Slab slab = slab_of(random);
    const double before_j = slab.kinetic_j();
    ASSERT_TRUE(settle_fully(std::span(&slab.row, 1), 1e-5, slab.velocity)) << round;
    const ReboundRow& row = slab.row;
    double load_ns = 0.0;
    for (std::size_t p = 0; p < row.count; ++p) load_ns += row.impulse_ns[p];
    const Eigen::Vector2d held_ns(row.friction_ns[0], row.friction_ns[1]);
    if (load_ns == 0.0) continue;
    ASSERT_LE(held_ns.norm(), row.friction * load_ns * (1.0 + 1e-12));
    ASSERT_LE(std::abs(row.twist_nms), row.friction * load_ns * row.twist_arm_m * (1.0 + 1e-12));
    if (held_ns.norm() > row.friction * load_ns * (1.0 - 1e-9)) {
      ++slides;
      const Eigen::Vector2d slip_mps = slab.slip_mps();
      if (slip_mps.norm() > 1e-6) {
        opposed.see((held_ns.normalized() + slip_mps.normalized()).norm(), std::to_string(round));
      }
    } else {
      ++sticks;
      stuck.see(slab.slip_mps().norm(), "round " + std::to_string(round));
    }
    energy.see(std::max(0.0, slab.kinetic_j() - before_j) / before_j, std::to_string(round));
  }
  EXPECT_GT(slides, 20);
  EXPECT_GT(sticks, 20);
  EXPECT_TRUE(opposed.within({"friction against the slip, rad", 2e-8, 1.2e-9, "where sweeps end"}));
  EXPECT_TRUE(stuck.within({"slip of what sticks, m/s", 2e-9, 2e-10, "where the sweeps end"}));
  EXPECT_TRUE(
      energy.within({"energy gained in a plastic hit, relative", 1e-15, 1e-16, "rounding"}));
}

// Groups of random bodies: momentum and angular momentum are kept, the energy is what is allowed or
// that of the rigid motion, and velocities between points keep their direction.
TEST(EnergyLimit, KeepsMomentaAndDirections) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const auto vector = [&] { return Eigen::Vector3d(any(random), any(random), any(random)); };
  Worst worst;
  for (int round = 0; round < 200; ++round) {
    std::vector<GroupMember> members(2 + random() % 5);
    for (GroupMember& m : members) {
      const Eigen::Matrix3d r = Eigen::Matrix3d::NullaryExpr([&] { return any(random); });
      m = {std::exp(2.0 * any(random)),
           r * r.transpose() + 0.1 * Eigen::Matrix3d::Identity(),
           vector(),
           {vector(), vector()}};
    }
    const auto sums = [&] {
      Eigen::Vector3d linear = Eigen::Vector3d::Zero(), angular = linear;
      double energy_j = 0.0;
      for (const GroupMember& m : members) {
        linear += m.mass_kg * m.velocity.linear;
        angular +=
            m.position_m.cross(m.mass_kg * m.velocity.linear) + m.inertia_kgm2 * m.velocity.angular;
        energy_j += 0.5 * m.mass_kg * m.velocity.linear.squaredNorm() +
                    0.5 * m.velocity.angular.dot(m.inertia_kgm2 * m.velocity.angular);
      }
      return std::tuple(linear, angular, energy_j);
    };
    const auto apart = [&] {  // of the first two, at a common point
      const auto at_origin = [](const GroupMember& m) {
        return Eigen::Vector3d(m.velocity.linear - m.velocity.angular.cross(m.position_m));
      };
      return Eigen::Vector3d(at_origin(members[1]) - at_origin(members[0]));
    };
    const auto [linear, angular, before_j] = sums();
    const Eigen::Vector3d apart_before = apart();
    const double allowed_j = before_j * (0.6 + 0.3 * any(random));
    const double taken_j = limit_energy(members, allowed_j);
    const auto [linear_after, angular_after, after_j] = sums();
    worst.see((before_j - after_j - taken_j) / before_j, "what was taken");
    EXPECT_GE(after_j, allowed_j * (1.0 - 1e-12));
    worst.see(apart().cross(apart_before).norm() / apart_before.squaredNorm(), "direction");
    EXPECT_GE(apart().dot(apart_before), -1e-12 * apart_before.squaredNorm());
    worst.see((linear_after - linear).norm() / linear.norm(), "momentum");
    worst.see((angular_after - angular).norm() / angular.norm(), "angular momentum");
  }
  EXPECT_TRUE(worst.within(k_kept));
}

TEST(EnergyLimit, LeavesAloneWhatIsAllowed) {
  std::vector<GroupMember> members = {
      {2.0, Eigen::Matrix3d::Identity(), {0, 0, 0}, {{1, 2, 3}, {3, 2, 1}}}};
  EXPECT_EQ(limit_energy(members, 100.0), 0.0);
  EXPECT_EQ(members[0].velocity.linear, Eigen::Vector3d(1, 2, 3));
}

}  // namespace
}  // namespace ourengine
