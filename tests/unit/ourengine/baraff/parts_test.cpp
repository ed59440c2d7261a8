// The parts of the paper's system: body, forward Euler, axes, impulse, A, b and the pivoting.
#include <gtest/gtest.h>

#include "ourengine/baraff/colliding_contact.hpp"
#include "ourengine/baraff/forward_euler.hpp"
#include "ourengine/baraff/qp_solve.hpp"
#include "ourengine/baraff/resting_contact.hpp"
#include "tests/support/tolerance.hpp"
#include "tests/unit/ourengine/baraff/motion.hpp"

namespace ourengine::baraff {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;
using testing::k_second_difference;
using testing::moved;
using testing::Random;

constexpr Tolerance k_rounding{"rounding", 2e-14, 2e-15, "a few hundred operations of order one"};
constexpr Tolerance k_residual{"complementarity", 1e-11, 4.5e-12,
                               "random problems of up to 31 contacts"};

TEST(Body, DerivedQuantitiesFollowFromMomenta) {
  Random random;
  Worst worst;
  for (int i = 0; i < 100; ++i) {
    const RigidBody body = random.body(random.vector());
    const Eigen::Matrix3d inertia = body.rotation * body.inertia_body * body.rotation.transpose();
    worst.see((inertia * body.angular_velocity_radps - body.angular_momentum_nms).norm(), "L");
    worst.see((body.mass_kg * body.velocity_mps - body.linear_momentum_ns).norm(), "P");
  }
  EXPECT_TRUE(worst.within(k_rounding));
}

TEST(ForwardEuler, TakesAllRatesAtTheStart) {
  Random random;
  RigidBody body = random.body({1, 2, 3});
  body.force_n = {1, -2, 3};
  body.torque_nm = {0.1, 0.2, -0.3};
  const RigidBody old = body;
  forward_euler(body, 0.01);
  Eigen::Quaterniond spin(0, old.angular_velocity_radps.x(), old.angular_velocity_radps.y(),
                          old.angular_velocity_radps.z());
  Eigen::Quaterniond turned = old.orientation;
  turned.coeffs() += 0.005 * (spin * old.orientation).coeffs();
  Worst worst;
  worst.see((body.position_m - old.position_m - 0.01 * old.velocity_mps).norm(), "x");
  worst.see((body.orientation.coeffs() - turned.normalized().coeffs()).norm(), "q");
  worst.see((body.linear_momentum_ns - old.linear_momentum_ns - 0.01 * old.force_n).norm(), "P");
  worst.see((body.angular_momentum_nms - old.angular_momentum_nms - 0.01 * old.torque_nm).norm(),
            "L");
  EXPECT_TRUE(worst.within(k_rounding));
}

// Gap along the axis found, from all 64 pairs of corners instead of half extents.
TEST(SeparatingAxis, GapIsThatOfTheCorners) {
  Random random;
  Worst worst;
  int edges = 0;
  for (int i = 0; i < 2000; ++i) {
    const RigidBody a = random.body({0, 0, 0});
    const RigidBody b = random.body(0.12 * random.vector());
    const Axis axis = separating_axis(a, b);
    edges += axis.index >= 6 ? 1 : 0;
    double highest = -1e9;
    double lowest = 1e9;
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector3d corner(k & 1 ? 0.1 : -0.1, k & 2 ? 0.05 : -0.05, k & 4 ? 0.05 : -0.05);
      highest = std::max(highest, axis.direction.dot(a.position_m + a.rotation * corner));
      lowest = std::min(lowest, axis.direction.dot(b.position_m + b.rotation * corner));
    }
    worst.see(lowest - highest - axis.gap_m, "pair " + std::to_string(i));
  }
  EXPECT_GT(edges, 100);
  EXPECT_TRUE(worst.within(k_rounding));
}

TEST(FaceContact, HalfCoveredBrickTouchesInFourCorners) {
  std::vector<RigidBody> bodies(2, make_body(Box{{0.1, 0.05, 0.05}}, 2.0, {0.01, 0.02, 0.02}));
  bodies[1].position_m = {0.1, 0.0, 0.1};
  for (RigidBody& body : bodies) compute_derived(body);
  std::vector<Collision> contacts;
  find_collisions(bodies, 1e-6, contacts);
  ASSERT_EQ(contacts.size(), 4U);
  Worst worst;
  for (const Collision& contact : contacts) {
    worst.see(std::abs(std::abs(contact.location.x() - 0.05) - 0.05), "x");
    worst.see(std::abs(std::abs(contact.location.y()) - 0.05), "y");
    worst.see(contact.location.z() - 0.05, "z");
    worst.see(contact.gap_m, "gap");
  }
  EXPECT_TRUE(worst.within(k_rounding));
}

TEST(FaceContact, CrossedBricksTouchInFourEdgeCrossings) {
  std::vector<RigidBody> bodies(2, make_body(Box{{0.1, 0.05, 0.05}}, 2.0, {0.01, 0.02, 0.02}));
  bodies[1].position_m = {0.0, 0.0, 0.1};
  bodies[1].orientation = Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitZ());
  for (RigidBody& body : bodies) compute_derived(body);
  std::vector<Collision> contacts;
  find_collisions(bodies, 1e-6, contacts);
  ASSERT_EQ(contacts.size(), 4U);
  for (const Collision& contact : contacts) EXPECT_FALSE(contact.vertex_face);
}

// Two bodies with a made-up contact between them.
Collision contact_between(Random& random, bool vertex_face) {
  Collision contact{.obj1 = 0,
                    .obj2 = 1,
                    .location = 0.1 * random.vector(),
                    .normal = {},
                    .vertex_face = vertex_face};
  contact.edge1 = random.vector().normalized();
  contact.edge2 = random.vector().normalized();
  contact.normal = contact.edge1.cross(contact.edge2).normalized();
  return contact;
}

TEST(CollidingContact, ImpulseReversesTheApproachAndConservesMomentum) {
  Random random;
  Worst worst;
  for (int i = 0; i < 200; ++i) {
    std::vector<RigidBody> bodies = {random.body({0.1, 0, 0}), random.body({-0.1, 0, 0})};
    Collision contact = contact_between(random, true);
    const double e = 0.3;
    const double before = relative_normal_velocity(bodies, contact);
    const auto momentum = [&] {
      Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
      for (const RigidBody& b : bodies) {
        sum.head<3>() += b.linear_momentum_ns;
        sum.tail<3>() += b.angular_momentum_nms + b.position_m.cross(b.linear_momentum_ns);
      }
      return sum;
    };
    const auto start = momentum();
    apply_collision(bodies, contact, collision_impulse(bodies, contact, e));
    worst.see(relative_normal_velocity(bodies, contact) + e * before, "velocity");
    worst.see((momentum() - start).norm(), "momentum");
  }
  EXPECT_TRUE(worst.within(k_rounding));
}

// Second difference of the gap along the motion under force and torque without contact.
TEST(RestingContact, BIsTheSecondDerivativeOfTheGap) {
  Random random;
  Worst worst;
  for (int i = 0; i < 40; ++i) {
    const bool vertex_face = i % 2 == 0;
    std::vector<RigidBody> start = {random.body({0.1, 0, 0}), random.body({-0.1, 0, 0})};
    Collision contact = contact_between(random, vertex_face);
    if (!vertex_face && contact.edge1.cross(contact.edge2).norm() < 0.3) continue;
    for (RigidBody& body : start) {
      body.force_n = random.vector();
      body.torque_nm = 0.1 * random.vector();
    }
    const double h = 1e-4;
    const auto gap_at = [&](double time_s) {
      const std::vector<RigidBody> bodies = moved(start, time_s);
      const auto carried = [&](std::size_t k, const Eigen::Vector3d& v) -> Eigen::Vector3d {
        return bodies[k].rotation * (start[k].rotation.transpose() * v);
      };
      const auto point = [&](std::size_t k) -> Eigen::Vector3d {
        return bodies[k].position_m + carried(k, contact.location - start[k].position_m);
      };
      const Eigen::Vector3d normal =
          vertex_face ? carried(1, contact.normal)
                      : carried(0, contact.edge1).cross(carried(1, contact.edge2)).normalized();
      return normal.dot(point(0) - point(1));
    };
    const double second = (gap_at(h) - 2.0 * gap_at(0.0) + gap_at(-h)) / (h * h);
    const double b = compute_b_vector(start, std::vector<Collision>{contact})[0];
    worst.see((b - second) / (1.0 + std::abs(b)), "case " + std::to_string(i));
  }
  EXPECT_TRUE(worst.within(k_second_difference));
}

// Rank-deficient problems that have a solution, J J^T f + J u.
TEST(QpSolve, MeetsAllThreeConditions) {
  Random random;
  Worst worst;
  for (int i = 0; i < 2000; ++i) {
    const int n = 2 + i % 30;
    Eigen::MatrixXd j(n, 1 + n / 2);
    for (double& entry : j.reshaped()) entry = random.number();
    for (int r = 1; r < n; r += 3) j.row(r) = j.row(r - 1);
    Eigen::VectorXd u(j.cols());
    for (double& entry : u) entry = random.number();
    const SparseMatrix a = Eigen::MatrixXd(j * j.transpose()).sparseView();
    const Eigen::VectorXd b = j * u;
    const QpResult solved = qp_solve(a, b);
    worst.see(complementarity_residual(a, b, solved.force, a * solved.force + b),
              "case " + std::to_string(i));
  }
  EXPECT_TRUE(worst.within(k_residual));
}

}  // namespace
}  // namespace ourengine::baraff
