// Spheres in the paper's system: closest features, acceleration of the gap, impacts and rest.
#include <gtest/gtest.h>

#include <map>

#include "ourengine/baraff/ball_contact.hpp"
#include "ourengine/baraff/simulator.hpp"
#include "tests/unit/ourengine/baraff/motion.hpp"

namespace ourengine::baraff {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;
using testing::k_second_difference;
using testing::moved;
using testing::Random;

constexpr Tolerance k_ball_rounding{"rounding", 2e-14, 1e-15,
                                    "a few hundred operations of order one"};
constexpr Tolerance k_rest{"rest", 1e-9, 1e-10, "the contact tolerance leaves 1e-7 m/s at most"};

RigidBody ball(double radius_m, const Eigen::Vector3d& position_m) {
  RigidBody made = make_body(Sphere{radius_m}, 2.0, Eigen::Vector3d::Constant(0.02));
  made.position_m = position_m;
  compute_derived(made);
  return made;
}

Collision only_contact(std::span<const RigidBody> bodies) {
  std::vector<Collision> found;
  find_collisions(bodies, 10.0, found);
  EXPECT_EQ(found.size(), 1U);
  return found.at(0);
}

// The second difference of the gap that the search itself reports, along a motion with spin, force
// and torque: over faces, edges and corners of a box, and over another sphere. Closer than 0.05 m
// the normal turns too fast for the step of the difference.
TEST(BallContact, BIsTheSecondDerivativeOfTheGap) {
  Random random;
  Worst worst;
  std::map<BallOn, int> seen;
  for (int i = 0; i < 400; ++i) {
    std::vector<RigidBody> start = {random.body({0, 0, 0}), random.body({0, 0, 0})};
    const Eigen::Vector3d away = random.vector().normalized();
    start[0].position_m = (0.15 + 0.1 * std::abs(random.number())) * away;
    start[0].solid = Sphere{0.05};
    if (i % 8 == 0) start[1].solid = Sphere{0.04};
    for (RigidBody& body : start) {
      body.force_n = random.vector();
      body.torque_nm = 0.1 * random.vector();
      compute_derived(body);
    }
    const double h = 1e-4;
    const Collision now = only_contact(start);
    // Five points, as the normal turns by some 20 rad/s.
    double second = -30.0 * now.gap_m;
    bool same = true;
    for (const auto& [steps, weight] : {std::pair(-2, -1), {-1, 16}, {1, 16}, {2, -1}}) {
      const Collision then = only_contact(moved(start, steps * h));
      same = same && then.ball == now.ball;
      second += weight * then.gap_m;
    }
    second /= 12.0 * h * h;
    if (!same || now.gap_m < 0.05) continue;
    ++seen[now.ball];
    const double b = compute_b_vector(start, std::vector<Collision>{now})[0];
    worst.see((b - second) / (1.0 + std::abs(b)), "case " + std::to_string(i));
  }
  for (const BallOn kind : {BallOn::face, BallOn::edge, BallOn::corner, BallOn::centre}) {
    EXPECT_GT(seen[kind], 20) << "kind " << static_cast<int>(kind);
  }
  EXPECT_TRUE(worst.within(k_second_difference));
}

// A centre inside a box: depth is the way out through the closest face plus the radius.
TEST(BallContact, CentreInsideABoxLeavesThroughTheClosestFace) {
  std::vector<RigidBody> bodies = {ball(0.03, {0.02, 0.0, 0.04}),
                                   make_fixed_body(Box{{0.1, 0.05, 0.05}})};
  const Collision contact = only_contact(bodies);
  Worst worst;
  worst.see(contact.gap_m + 0.04, "gap");
  worst.see((contact.normal - Eigen::Vector3d::UnitZ()).norm(), "normal");
  worst.see((contact.location - Eigen::Vector3d(0.02, 0.0, 0.05)).norm(), "location");
  EXPECT_TRUE(worst.within(k_ball_rounding));
}

// Sphere on plane, falling from 0.2 m/s with restitution 0.5: it leaves with half the speed.
TEST(BallContact, ReboundsWithItsRestitution) {
  const std::pair<Solid, double> floors[] = {{Plane{}, 0.0}, {Box{{1.0, 1.0, 0.5}}, -0.5}};
  for (const auto& [floor, height_m] : floors) {
    std::vector<RigidBody> bodies = {ball(0.1, {0, 0, 0.1}), make_fixed_body(floor)};
    bodies[1].position_m.z() = height_m;
    set_velocity(bodies[0], {0.3, 0, -0.2}, {1, 2, 3});
    compute_derived(bodies[1]);
    Options options;
    options.gravity_mps2.setZero();
    Simulator simulator(bodies, RestitutionTable::Constant(1, 1, 0.5), options);
    simulator.step();
    Worst worst;
    worst.see((simulator.bodies()[0].velocity_mps - Eigen::Vector3d(0.3, 0, 0.1)).norm(), "v");
    worst.see((simulator.bodies()[0].angular_velocity_radps - Eigen::Vector3d(1, 2, 3)).norm(),
              "w");
    EXPECT_TRUE(worst.within(k_ball_rounding));
  }
}

// A brick on four balls on the plane stays for 2 s, though the balls are free to roll.
TEST(BallContact, BrickRestsOnBalls) {
  std::vector<RigidBody> bodies = {make_fixed_body(Plane{})};
  for (const double x : {-0.1, 0.1}) {
    for (const double y : {-0.06, 0.06}) bodies.push_back(ball(0.05, {x, y, 0.05}));
  }
  bodies.push_back(make_body(Box{{0.2, 0.1, 0.05}}, 16.0, {0.07, 0.23, 0.27}));
  bodies.back().position_m = {0, 0, 0.15};
  compute_derived(bodies.back());
  const std::vector<RigidBody> start = bodies;
  Simulator simulator(bodies, RestitutionTable::Constant(1, 1, 0.0), Options{});
  Worst worst;
  for (int i = 0; i < 2000; ++i) {
    ASSERT_FALSE(simulator.step().failed);
    EXPECT_EQ(simulator.report().resting_contacts, 8);
  }
  for (std::size_t k = 0; k < start.size(); ++k) {
    worst.see((simulator.bodies()[k].position_m - start[k].position_m).norm(),
              "body " + std::to_string(k));
  }
  EXPECT_TRUE(worst.within(k_rest));
}

}  // namespace
}  // namespace ourengine::baraff
