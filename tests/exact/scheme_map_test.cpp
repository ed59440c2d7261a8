// The discrete maps against brute force: recurrences, implicit equations and sums written out here.
#include "experiments/exact/schemes/scheme_map.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "experiments/exact/cases/builders.hpp"
#include "experiments/exact/schemes/impulse_map.hpp"
#include "experiments/exact/schemes/pivoting.hpp"
#include "tests/exact/random_parameters.hpp"
#include "tests/support/tolerance.hpp"

namespace brickbench::exact {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr Tolerance k_sums = {"maps against written-out sums", 2e-12, 2.2e-13,
                              "rounding of a thousand additions"};
constexpr Tolerance k_implicit = {"residual of implicit updates", 4e-15, 2.7e-16,
                                  "one linear solve"};
constexpr Tolerance k_newton = {"Newton's step against the converged implicit update", 0.02, 2.1e-3,
                                "quadratic convergence, in units of the squared turn per step"};
constexpr Tolerance k_pivots = {"complementarity by pivoting", 4e-14, 2.2e-15,
                                "linear solves of at most seven rows"};

Scheme scheme(PositionRule position) {
  Scheme s;
  s.position = position;
  return s;
}

Scheme impulse_scheme() {
  Scheme s;
  s.contact = ImpulseContact{};
  return s;
}

std::vector<double> discrete(std::string_view id, const Scheme& s,
                             const ParameterValues& given = {}) {
  const ExactCase exact_case = testing::find_case(id);
  const ExactRun run = build(exact_case, given).value();
  return discrete_truth(exact_case, run, s).value();
}

TEST(SchemeMap, PlaneThatLooksAheadEatsTheRebound) {
  // 2 mm per step from 21 mm: seen at 3 mm, as the next 5 mm are beyond 0.02 sqrt(3) 0.1 m. Then
  // e v - gap/h is 2 - 3, 1 - 2 and 1 - 1 m/s: the ball stops 1 mm above the plane.
  ExactRun run;
  run.step_s = 0.001;
  run.world.law.restitution = 1.0;
  run.world.bodies = {ground_plane(), ball("ball", 0.1, 1.0, at({0.0, 0.0, 0.121}, {0, 0, -2}))};
  run.world.gravity_mps2.setZero();
  run.geometry = sphere_contact(0, 1, 0.1, true);
  Scheme s = impulse_scheme();
  std::get<ImpulseContact>(s.contact).margin_m = 1e18;
  std::get<ImpulseContact>(s.contact).plane_reach_share = 0.02;
  std::get<ImpulseContact>(s.contact).approach_allowed = true;
  std::vector<State> states = {run.world.bodies[0].initial, run.world.bodies[1].initial};
  const std::vector<Wrench> wrenches(2);
  std::string why;
  for (int step = 0; step < 20; ++step) ASSERT_TRUE(advance(s, run, wrenches, states, why)) << why;
  Worst worst;
  worst.see(states[1].position_m.z() - 0.101, "height");
  worst.see(states[1].velocity_mps.z(), "velocity");
  EXPECT_TRUE(worst.within(k_sums));
}

TEST(SchemeMap, PlaneThatSeesOneCornerTurnsALevelEdge) {
  // The rod of impact.rod comes 1 mm per step from 10.5 mm: from 0.5 mm, e v - gap/h is 1 - 1 m/s,
  // which stops the corner at +y; the other one, as low, is not seen.
  Scheme s = impulse_scheme();
  std::get<ImpulseContact>(s.contact).margin_m = 1e18;
  std::get<ImpulseContact>(s.contact).plane_reach_share = 0.02;
  std::get<ImpulseContact>(s.contact).approach_allowed = true;
  const ExactCase exact_case = testing::find_case("impact.rod");
  const ExactRun run = build(exact_case).value();
  const std::vector<double> values = discrete("impact.rod", s);
  const Body& rod = run.world.bodies[1];
  const Eigen::Quaterniond& q = rod.initial.orientation;
  const Eigen::Vector3d arm = q * Eigen::Vector3d(0.5, 0.02, -0.02);
  const Eigen::Vector3d turn = arm.cross(Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d response = q * (q.conjugate() * turn).cwiseQuotient(rod.inertia_kgm2);
  const double impulse_ns = 2.0 / (1.0 / rod.mass_kg + turn.dot(response));
  Worst worst;
  worst.see(values[0] + 2.0 - impulse_ns / rod.mass_kg, "velocity");
  worst.see((values[1] - impulse_ns * response.x()) / response.norm(), "spin about x");
  worst.see((values[2] - impulse_ns * response.y()) / response.norm(), "spin about y");
  EXPECT_TRUE(worst.within(k_sums));
}

TEST(SchemeMap, ProjectileLagsAndLeadsByHalfAStep) {
  Worst worst;
  const ExactCase exact_case = testing::find_case("free_flight.projectile");
  const ExactRun run = build(exact_case).value();
  const double t = 1.0, h = run.step_s, g = k_gravity_mps2;
  const double exact = run.truths[1].value;
  const auto z = [&](PositionRule rule) {
    return discrete("free_flight.projectile", scheme(rule))[1];
  };
  worst.see(z(PositionRule::new_velocity) - (exact - 0.5 * g * h * t), "semi-implicit");
  worst.see(z(PositionRule::old_velocity) - (exact + 0.5 * g * h * t), "explicit");
  worst.see(z(PositionRule::mean_velocity) - exact, "mean");
  worst.see(z(PositionRule::middle_momentum) - exact, "middle");
  worst.see(z(PositionRule::runge_kutta_4) - exact, "Runge-Kutta");
  EXPECT_TRUE(worst.within(k_sums));
}

TEST(SchemeMap, NormalisedEulerTurnsByTwiceTheArcTangent) {
  Scheme s;
  s.attitude = AttitudeRule::normalised_euler;
  const double per_step = 2.0 * std::atan(0.5 * 5.0 * 0.001);
  Worst worst;
  worst.see(discrete("rotation.uniform_spin", s)[0] - 2000.0 * per_step, "normalised Euler");
  s.attitude = AttitudeRule::exponential;
  worst.see(discrete("rotation.uniform_spin", s)[0] - 10.0, "exponential");
  s.turn_limit_rad = 0.004;  // of 0.005 rad per step
  worst.see(
      discrete("rotation.uniform_spin", s)[0] - 2000.0 * 2.0 * std::atan(1.25 * std::tan(0.002)),
      "beyond the limit");
  s.turn_limit_rad = std::numeric_limits<double>::infinity();
  // Sum of the spins after each step.
  const double inertia =
      build(testing::find_case("rotation.spin_up")).value().world.bodies[0].inertia_kgm2.x();
  const double alpha = 0.01 / inertia;
  worst.see(discrete("rotation.spin_up", s)[0] - alpha * 1e-6 * 1000.0 * 1001.0 / 2.0, "spin up");
  EXPECT_TRUE(worst.within(k_sums));
}

TEST(SchemeMap, FrozenMomentumSolvesItsImplicitEquation) {
  Worst implicit, newton;
  std::mt19937_64 generator(20);
  std::uniform_real_distribution<double> w(-5.0, 5.0);
  const Vector3d inertia(1.0, 2.0, 2.5);
  const double h = 0.01;
  for (int i = 0; i < 100; ++i) {
    const Vector3d spin(w(generator), w(generator), w(generator));
    const Vector3d momentum = inertia.cwiseProduct(spin);
    const Vector3d frozen =
        next_spin_radps(GyroscopicRule::frozen_momentum, inertia, spin, Vector3d::Zero(), h);
    implicit.see((inertia.cwiseProduct(frozen) + h * frozen.cross(momentum) - momentum).norm() /
                     momentum.norm(),
                 "frozen momentum");
    // Implicit Euler by fixed-point iteration to convergence.
    Vector3d converged = spin;
    for (int sweep = 0; sweep < 200; ++sweep) {
      converged =
          (momentum - h * converged.cross(inertia.cwiseProduct(converged))).cwiseQuotient(inertia);
    }
    const Vector3d one =
        next_spin_radps(GyroscopicRule::newton_body, inertia, spin, Vector3d::Zero(), h);
    newton.see((one - converged).norm() / (spin.norm() * std::pow(h * spin.norm(), 2)),
               "Newton's step, over the square of the turn");
    const Vector3d pushed =
        next_spin_radps(GyroscopicRule::explicit_body, inertia, spin, Vector3d(1.0, 2.0, 2.5), h);
    const Vector3d by_hand =
        spin + h * (Vector3d::Ones() - spin.cross(momentum).cwiseQuotient(inertia));
    implicit.see((pushed - by_hand).norm() / spin.norm(), "explicit with torque");
  }
  EXPECT_TRUE(implicit.within(k_implicit));
  EXPECT_TRUE(newton.within(k_newton));
}

// Observed orders of the maps on the torque-free brick between 2 ms and 0.5 ms.
TEST(SchemeMap, ConvergesWithTheOrderOfEachScheme) {
  const auto order = [](GyroscopicRule gyroscopic, std::size_t observable) {
    Scheme s;
    s.gyroscopic = gyroscopic;
    const ExactCase exact_case = testing::find_case("rotation.torque_free_3");
    std::array<double, 2> error{};
    int i = 0;
    for (const double step : {0.002, 0.0005}) {
      const ExactRun run = build(exact_case, {{"step_s", step}}).value();
      const double value = discrete_truth(exact_case, run, s).value()[observable];
      error[static_cast<std::size_t>(i++)] = std::abs(value - run.truths[observable].value);
    }
    return std::log2(error[0] / error[1]) / 2.0;
  };
  EXPECT_NEAR(order(GyroscopicRule::explicit_body, 0), 1.0, 0.1);
  EXPECT_NEAR(order(GyroscopicRule::newton_body, 0), 1.0, 0.1);
  EXPECT_NEAR(order(GyroscopicRule::frozen_momentum, 0), 1.0, 0.15);
  EXPECT_NEAR(order(GyroscopicRule::runge_kutta_4, 4), 4.0, 0.3) << "energy";
  // The attitude averages spins of different body frames, which costs two orders.
  EXPECT_NEAR(order(GyroscopicRule::runge_kutta_4, 0), 2.0, 0.1) << "attitude";
}

TEST(SchemeMap, BouncingBallFollowsTheWrittenOutRecurrence) {
  Worst worst;
  Scheme s = impulse_scheme();
  std::get<ImpulseContact>(s.contact).error_reduction = 0.2;
  const double h = 0.001, g = k_gravity_mps2, e = 0.8, r = 0.1;
  double z = 1.0 + r, v = 0.0, before = 0.0;
  std::vector<double> times;
  for (int step = 0; step < 2400; ++step) {
    const double free = v - h * g;
    const double gap = z - r;
    double next = free;
    if (gap <= 0.0) next = std::max({free, v < 0.0 ? -e * v : 0.0, -0.2 * gap / h});
    v = next;
    z += h * v;
    if (before < 0.0 && v > 0.0) times.push_back((step + 1) * h);
    before = v;
  }
  const std::vector<double> values = discrete("impact.ball_bounce_times", s);
  ASSERT_GE(times.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) worst.see(values[i] - times[i], "bounce");
  EXPECT_TRUE(worst.within(k_sums));
}

TEST(SchemeMap, SlidingStopsHalfAStepShort) {
  // Speed a whole number of friction's steps: no remainder at the stop.
  const double brake = 0.5 * k_gravity_mps2, h = 0.001;
  const ParameterValues given = {{"speed_mps", 400.0 * brake * h}};
  const ExactRun run = build(testing::find_case("friction.sliding_stop"), given).value();
  const std::vector<double> values = discrete("friction.sliding_stop", impulse_scheme(), given);
  Worst worst;
  worst.see(values[0] - (run.truths[0].value - 0.5 * 400.0 * brake * h * h), "distance");
  worst.see(values[2] - 0.4, "time");
  EXPECT_TRUE(worst.within(k_sums));
}

TEST(SchemeMap, SquareFrictionSetBendsTheWay) {
  Scheme s = impulse_scheme();
  const double straight = discrete("friction.diagonal_slide", s)[1];
  s.friction = FrictionSet::square;
  const double bent = discrete("friction.diagonal_slide", s)[1];
  EXPECT_NEAR(straight, 0.0, 1e-14);
  // Axis by axis: dx = vx^2/(2 mu g), dy = vy^2/(2 mu g), up to the step.
  const double speed = 2.0, brake = 0.5 * k_gravity_mps2, c = std::cos(M_PI / 6), w = 0.5;
  const double dx = speed * speed * c * c / (2 * brake), dy = speed * speed * w * w / (2 * brake);
  EXPECT_NEAR(bent, -dx * w + dy * c, 0.002);
}

TEST(SchemeMap, TargetVelocityFollowsEachRule) {
  ImpulseContact c;
  c.error_reduction = 0.2;
  const double h = 0.01;
  EXPECT_DOUBLE_EQ(target_velocity_mps(c, 0.5, -0.1, -1.0, h), 2.0) << "the larger: 0.2 0.1/0.01";
  EXPECT_DOUBLE_EQ(target_velocity_mps(c, 0.5, -0.01, -1.0, h), 0.5) << "the larger: e v";
  c.sum_of_targets = true;
  EXPECT_DOUBLE_EQ(target_velocity_mps(c, 0.5, -0.1, -1.0, h), 2.5) << "the sum";
  c.max_correction_mps = 0.1;
  EXPECT_DOUBLE_EQ(target_velocity_mps(c, 0.5, -0.1, -1.0, h), 0.6) << "correction limited";
  c.split_at_gap_m = 0.0;
  EXPECT_DOUBLE_EQ(target_velocity_mps(c, 0.5, -0.1, -1.0, h), 0.5) << "correction split off";
  c.restitution_threshold_mps = 2.0;
  EXPECT_DOUBLE_EQ(target_velocity_mps(c, 0.5, -0.1, -1.0, h), 0.0) << "too slow to bounce";
  EXPECT_DOUBLE_EQ(target_velocity_mps(c, 0.5, -0.1, 1.0, h), 0.0) << "separating";
  c.margin_m = c.split_at_gap_m = 0.02;
  c.approach_allowed = true;
  EXPECT_DOUBLE_EQ(target_velocity_mps(c, 0.0, 0.01, -3.0, h), -1.0) << "may close the gap";
  EXPECT_EQ(target_velocity_mps(c, 0.0, 0.03, -3.0, h), -HUGE_VAL) << "no row";
}

// Momentum in the world frame, attitude by q + h/2 (0, w) q with the spin of the step's start.
TEST(SchemeMap, SpatialMomentumIsKeptWhileTheAttitudeDrifts) {
  Scheme s;
  s.position = PositionRule::old_velocity;
  s.gyroscopic = GyroscopicRule::spatial_momentum;
  s.attitude = AttitudeRule::normalised_euler;
  const Body body = build(testing::find_case("rotation.torque_free_3")).value().world.bodies[0];
  State state = body.initial;
  const Vector3d start = spin_momentum_nms(body, state);
  Eigen::Vector4d q(1.0, 0.0, 0.0, 0.0);
  Vector3d w = state.angular_velocity_radps;
  const double h = 0.002;
  for (int step = 0; step < 500; ++step) {
    state = next_free_state(s, body, state, Wrench{}, Vector3d::Zero(), h);
    const Eigen::Vector4d rate(-w.dot(q.tail<3>()), 0, 0, 0);
    Eigen::Vector4d next = q + 0.5 * h * rate;
    next.tail<3>() += 0.5 * h * (q[0] * w + w.cross(q.tail<3>()));
    q = next.normalized();
    const Eigen::Matrix3d r = Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
    w = (r * body.inertia_kgm2.asDiagonal() * r.transpose()).inverse() * start;
  }
  Worst worst;
  worst.see((spin_momentum_nms(body, state) - start).norm() / start.norm(), "momentum");
  worst.see((state.angular_velocity_radps - w).norm(), "spin");
  EXPECT_TRUE(worst.within(k_sums));
}

TEST(SchemeMap, CradleHitAtOnceFollowsNewtonsComplementarity) {
  const std::vector<double> values = discrete("impact.cradle", impulse_scheme());
  Worst worst;
  worst.see(values[0] + 1.0 / 3.0, "first");
  worst.see(values[1] - 2.0 / 3.0, "middle");
  worst.see(values[2] - 2.0 / 3.0, "last");
  EXPECT_TRUE(worst.within(k_sums));
}

TEST(SchemeMap, SoftnessAndSplitCorrectionActAsWrittenDown) {
  Scheme s = impulse_scheme();
  std::get<ImpulseContact>(s.contact).error_reduction = 0.2;
  std::get<ImpulseContact>(s.contact).softness_per_kgs = 1e-3;
  std::get<ImpulseContact>(s.contact).split_at_gap_m = 0.0;
  ExactRun run = build(testing::find_case("impact.flat_landing")).value();
  std::vector<State> states = {run.world.bodies[0].initial, run.world.bodies[1].initial};
  states[1].position_m.z() = 0.125 - 0.01;
  states[1].velocity_mps.z() = -2.0;
  std::vector<Wrench> wrenches(2);
  std::string why;
  ASSERT_TRUE(advance(s, run, wrenches, states, why)) << why;
  const double h = run.step_s, m = 5.0;
  const double free = -2.0 - h * k_gravity_mps2;
  const double v = free - free / m / (1.0 / m + 1e-3 / (4.0 * h));
  Worst worst;
  worst.see(states[1].velocity_mps.z() - v, "velocity");
  const double shift = 0.2 * 0.01 / m / (1.0 / m + 1e-3 / (4.0 * h));
  worst.see(states[1].position_m.z() - (0.115 + h * v + shift), "position");
  EXPECT_TRUE(worst.within(k_sums));
}

// n equal points, each with f_i R = a_ref - a and a = a_free + sum f_i/m, R = (1-d)/(d m).
TEST(SchemeMap, CompliantContactBalancesItsForces) {
  Worst worst;
  CompliantContact c;
  c.impedance_start = c.impedance_end = 0.93;
  for (const int points : {1, 4}) {
    const double gap = -0.002, velocity = -0.3, free = -9.81, h = 0.001;
    const double a = compliant_acceleration_mps2(c, gap, velocity, free, points, h);
    const double d = 0.93, time = 0.02;
    const double reference = -2.0 / (d * time) * velocity - d * gap / (d * d * time * time);
    const double force = (a - free) / points;  // per mass and point
    worst.see(force * (1.0 - d) / d - (reference - a), "force balance");
  }
  // Nothing pulls: a contact that separates fast enough falls freely.
  worst.see(compliant_acceleration_mps2(c, -1e-6, 10.0, -9.81, 1, 0.001) + 9.81, "no pull");
  EXPECT_TRUE(worst.within(k_sums));
}

TEST(SchemeMap, RestsAtTheDepthThatCarriesTheWeight) {
  // At rest a = v = 0: (1-d) a_free + n d a_ref = 0 with a_ref = k d depth.
  Scheme s;
  s.contact = CompliantContact{};
  std::get<CompliantContact>(s.contact).impedance_start =
      std::get<CompliantContact>(s.contact).impedance_end = 0.9;
  const std::vector<double> values =
      discrete("impact.ball_landing", s, {{"duration_s", 2.0}, {"height_m", 0.01}});
  const double d = 0.9, stiffness = 1.0 / (d * d * 0.02 * 0.02);
  const double depth = (1.0 - d) * k_gravity_mps2 / (d * stiffness * d);
  Worst worst;
  worst.see((values[0] + depth) / depth, "depth");
  worst.see(values[1], "velocity");
  EXPECT_TRUE(worst.within({"rest", 6e-12, 3.6e-13, "the damped motion has died out"}));
}

TEST(SchemeMap, SaysWhyItClaimsNothing) {
  const auto reason = [](std::string_view id, const Scheme& s) {
    const ExactCase exact_case = testing::find_case(id);
    std::string why;
    EXPECT_FALSE(discrete_truth(exact_case, build(exact_case).value(), s, &why).has_value()) << id;
    return why;
  };
  Scheme compliant;
  compliant.contact = CompliantContact{};
  EXPECT_FALSE(reason("impact.ball_apexes", compliant).empty());
  EXPECT_FALSE(reason("friction.sliding_stop", compliant).empty());
  EXPECT_FALSE(reason("impact.corner", compliant).empty());
  EXPECT_FALSE(reason("statics.tower", impulse_scheme()).empty());
  EXPECT_FALSE(reason("impact.ball_apexes", Scheme{}).empty());
}

TEST(Pivoting, SolvesRandomComplementarityProblems) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  Worst worst;
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Index n = 1 + trial % 7;
    const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return normal(random); });
    const Eigen::MatrixXd a = root * root.transpose() + Eigen::MatrixXd::Identity(n, n);
    const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(n, [&] { return normal(random); });
    const Eigen::VectorXd x = pivot_in_order(a, b);
    worst.see(x.cwiseMin(a * x - b).norm(), "trial " + std::to_string(trial));
  }
  EXPECT_TRUE(worst.within(k_pivots));
}

// A resting contact that comes first blocks the drive of the struck one: nothing pushes. The other
// way round the middle ball's contact is struck first, and both share the blow.
TEST(Pivoting, GivesUpWhereARestingRowComesFirst) {
  Eigen::Matrix2d a;
  a << 2.0, -1.0, -1.0, 2.0;
  EXPECT_EQ(pivot_in_order(a, Eigen::Vector2d(0.0, 2.0)).norm(), 0.0);
  const Eigen::VectorXd shared = pivot_in_order(a, Eigen::Vector2d(2.0, 0.0));
  EXPECT_NEAR(shared[0], 4.0 / 3.0, k_pivots.value);
  EXPECT_NEAR(shared[1], 2.0 / 3.0, k_pivots.value);
}

TEST(Pivoting, WalksAnIslandFromTheLastBody) {
  World world;
  world.bodies = {ground_plane()};
  for (int i = 0; i < 4; ++i) world.bodies.push_back(ball("ball", 0.1, 1.0, at({0, 0, 1.0 * i})));
  const auto contact = [](std::size_t a, std::size_t b) {
    PointContact c;
    c.body_a = a;
    c.body_b = b;
    return c;
  };
  // 1 stands on the ground and carries 4; 2 carries 3.
  const std::vector<PointContact> contacts = {contact(0, 1), contact(2, 3), contact(1, 4)};
  EXPECT_EQ(island_order(world, contacts), (std::vector<std::size_t>{2, 0, 1}));
}

}  // namespace
}  // namespace brickbench::exact
