// Hits of pairs whose answer is known, wherever in a step they take place and however fast.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "ourengine/baraff/joint_collision.hpp"
#include "ourengine/baraff/safe_step.hpp"
#include "ourengine/baraff/simulator.hpp"
#include "tests/support/tolerance.hpp"
#include "tests/unit/ourengine/baraff/motion.hpp"
#include "tests/unit/ourengine/baraff/scenes.hpp"

namespace ourengine::baraff {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;
using testing::Random;

constexpr Tolerance k_parting{"parting_share", 8e-15, 4.5e-16,
                              "rounding of one solve of four corners"};
constexpr Tolerance k_balance{"energy_share", 4e-14, 2.3e-15, "the same, of random faces"};
constexpr double k_hit_step_s = 0.001;

// A pair that meets along x with both centres on the line of the hit.
struct Meeting {
  const char* name;
  RigidBody struck;
  RigidBody thrown;
  double touch_m;  // distance of the centres, or of the centre and the plane, at touch
};

RigidBody ball(double radius_m) {
  return make_body(Sphere{radius_m}, 1.0, Eigen::Vector3d::Constant(0.4 * radius_m * radius_m));
}

RigidBody facing_x(RigidBody body) {
  body.orientation =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX());
  compute_derived(body);
  return body;
}

std::vector<Meeting> meetings() {
  const RigidBody brick = testing::brick({0.1, 0.05, 0.05}, {0, 0, 0});
  const RigidBody plate = testing::brick({0.004, 0.3, 0.2}, {0, 0, 0});
  const RigidBody wall = make_fixed_body(Box{{0.01, 2.0, 2.0}});
  return {{"brick on brick", brick, brick, 0.2},
          {"brick on plate", plate, brick, 0.104},
          {"brick on wall", wall, brick, 0.11},
          {"brick on plane", facing_x(make_fixed_body(Plane{})), brick, 0.1},
          {"ball on plane", facing_x(make_fixed_body(Plane{})), ball(0.05), 0.05},
          {"ball on brick", brick, ball(0.05), 0.15},
          {"ball on plate", plate, ball(0.05), 0.054},
          {"ball on ball", ball(0.02), ball(0.05), 0.07}};
}

// Throws at -speed along x from a gap for the steps; returns the speed at which they part.
double parting_mps(const Meeting& meeting, double gap_m, double speed_mps, double restitution,
                   double step_s, int steps) {
  std::vector<RigidBody> bodies = {meeting.struck, meeting.thrown};
  bodies[1].position_m.x() = meeting.touch_m + gap_m;
  set_velocity(bodies[1], {-speed_mps, 0, 0}, {0, 0, 0});
  Options options;
  options.step_s = step_s;
  options.gravity_mps2.setZero();
  Simulator simulator(bodies, RestitutionTable::Constant(1, 1, restitution), options);
  for (int i = 0; i < steps; ++i) {
    EXPECT_FALSE(simulator.step().unsolved) << meeting.name;
  }
  return simulator.bodies()[1].velocity_mps.x() - simulator.bodies()[0].velocity_mps.x();
}

// Gaps that close at the start of a step, at its end, within rounding of both and between them.
TEST(Hits, PartWithTheRestitutionWhereverInAStepTheGapCloses) {
  Worst worst;
  constexpr double k_speed_mps = 5.0;
  constexpr double k_way_m = k_speed_mps * k_hit_step_s;
  for (const Meeting& meeting : meetings()) {
    for (int tenth = 0; tenth <= 10; ++tenth) {
      for (const double steps : {0.0, 0.5, 1.0, 3.0}) {
        for (const double off_m : {0.0, 1e-17, -1e-17, 1e-12, -1e-12, 1e-7, -1e-7, 1e-6, 2e-6}) {
          const double e = 0.1 * tenth;
          const double gap_m = steps * k_way_m + off_m;
          const double parted_mps = parting_mps(meeting, gap_m, k_speed_mps, e, k_hit_step_s, 6);
          worst.see(parted_mps / k_speed_mps - e, std::string(meeting.name) + " e " +
                                                      std::to_string(e) + " gap " +
                                                      std::to_string(gap_m));
        }
      }
    }
  }
  EXPECT_TRUE(worst.within(k_parting));
}

// Whatever way a step would take them: a body meets what is in its way.
TEST(Hits, MeetWhatIsInTheWayAtEverySpeedAndStep) {
  Worst worst;
  for (const Meeting& meeting : meetings()) {
    for (const double speed_mps : {1.0, 10.0, 100.0, 1000.0}) {
      for (const double step_s : {1.0 / 60.0, 1.0 / 240.0, 0.001, 1e-4}) {
        for (const double share : {0.0, 0.3, 0.99}) {
          const double gap_m = share * speed_mps * step_s;
          const double parted_mps = parting_mps(meeting, gap_m, speed_mps, 0.5, step_s, 4);
          worst.see(parted_mps / speed_mps - 0.5,
                    std::string(meeting.name) + " speed " + std::to_string(speed_mps) + " step " +
                        std::to_string(step_s) + " share " + std::to_string(share));
        }
      }
    }
  }
  EXPECT_TRUE(worst.within(k_parting));
}

// Random faces on each other: no contact closes faster than restitution allows, and the energy is
// that of the impulses.
TEST(Hits, OfRandomFacesKeepNewtonsLawAndItsEnergy) {
  Random random;
  Worst approach, energy;
  for (int trial = 0; trial < 300; ++trial) {
    const double e = 0.1 * (trial % 11);
    std::vector<RigidBody> bodies = {testing::brick({0.2, 0.1, 0.05}, {0, 0, 0}),
                                     testing::brick({0.1, 0.05, 0.05}, {0, 0, 0.1})};
    bodies[1].position_m += 0.05 * random.vector().cwiseProduct(Eigen::Vector3d(1, 1, 0));
    for (RigidBody& body : bodies) set_velocity(body, random.vector(), random.vector());
    std::vector<Collision> contacts;
    find_collisions(bodies, 1e-6, contacts);
    std::vector<double> met_mps;
    for (const Collision& c : contacts) met_mps.push_back(relative_normal_velocity(bodies, c));
    if (*std::ranges::min_element(met_mps) > -1e-3) continue;
    const auto kinetic_j = [&] {
      double sum_j = 0.0;
      for (const RigidBody& b : bodies) {
        sum_j += 0.5 * b.linear_momentum_ns.dot(b.velocity_mps) +
                 0.5 * b.angular_momentum_nms.dot(b.angular_velocity_radps);
      }
      return sum_j;
    };
    const double before_j = kinetic_j();
    const RestitutionTable table = RestitutionTable::Constant(1, 1, e);
    if (collide_in_groups(bodies, contacts, table, 1e-3, 100) != 1) continue;
    double work_j = 0.0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const double after_mps = relative_normal_velocity(bodies, contacts[i]);
      approach.see(std::max(0.0, -(after_mps + e * met_mps[i])), std::to_string(trial));
      work_j += 0.5 * (1.0 - e) * contacts[i].impulse_ns * met_mps[i];
    }
    energy.see((kinetic_j() - before_j - work_j) / before_j, std::to_string(trial));
    EXPECT_LE(work_j, k_balance.value * before_j);
  }
  EXPECT_TRUE(approach.within(k_balance));
  EXPECT_TRUE(energy.within(k_balance));
}

// In a row of balls the last one leaves: groups of pairs follow each other.
TEST(Hits, OfARowOfBallsLetTheLastOneLeave) {
  std::vector<RigidBody> row(4, ball(0.05));
  for (std::size_t i = 0; i < row.size(); ++i) row[i].position_m.x() = 0.1 * static_cast<double>(i);
  set_velocity(row.front(), {2, 0, 0}, {0, 0, 0});
  std::vector<Collision> contacts;
  find_collisions(row, 1e-6, contacts);
  collide_in_groups(row, contacts, RestitutionTable::Ones(1, 1), 1e-3, 100);
  EXPECT_DOUBLE_EQ(row.back().velocity_mps.x(), 2.0);
}

// What the safe step promises: no pair is deeper than the share of the thinner one, whatever turns.
TEST(Hits, SafeStepsKeepTheDepth) {
  Random random;
  for (int trial = 0; trial < 2000; ++trial) {
    constexpr double k_share = 0.25;
    const double fast = std::pow(10.0, trial % 4);
    std::vector<RigidBody> bodies = {testing::brick({0.1, 0.05, 0.03}, {0, 0, 0}),
                                     testing::brick({0.08, 0.04, 0.02}, {0, 0, 0})};
    bodies[1].position_m = 0.3 * random.vector();
    for (RigidBody& body : bodies) {
      body.orientation =
          Eigen::Quaterniond(1.0, random.vector().x(), random.vector().y(), random.vector().z())
              .normalized();
      set_velocity(body, fast * random.vector(), 10.0 * fast * random.vector());
    }
    const double start_m = std::min(0.0, separating_axis(bodies[0], bodies[1]).gap_m);
    const double safe_s = safe_step_s(bodies, 1.0 / 60.0, k_share);
    for (RigidBody& body : bodies) {
      body.position_m += safe_s * body.velocity_mps;
      const double spin_radps = body.angular_velocity_radps.norm();
      body.orientation =
          Eigen::AngleAxisd(safe_s * spin_radps, body.angular_velocity_radps / spin_radps) *
          body.orientation;
      compute_derived(body);
    }
    // 1e-6: of the bodies' lengths, the bisection of the time.
    EXPECT_GE(separating_axis(bodies[0], bodies[1]).gap_m, start_m - k_share * 0.04 - 1e-6)
        << trial;
  }
}

}  // namespace
}  // namespace ourengine::baraff
