// Oracles: each is silent on what the laws allow, over a family, and speaks where they are broken.
#include "experiments/hunt/oracles.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "experiments/hunt/dice.hpp"
#include "tests/unit/hunt/motions.hpp"

namespace brickbench::hunt {
namespace {

using namespace brickbench::hunt::testing;

constexpr double k_g_mps2 = 9.81;
constexpr int k_family = 200;

bool breaks(const Motion& motion, std::string_view oracle) {
  for (const OracleInfo& info : oracles()) {
    if (info.name == oracle) return info.judge(motion).has_value();
  }
  ADD_FAILURE() << "no oracle " << oracle;
  return false;
}

std::string all_broken(const Motion& motion) {
  std::string names;
  for (const OracleInfo& info : oracles()) {
    if (info.judge != nullptr && info.judge(motion)) names += std::string(info.name) + " ";
  }
  return names;
}

// A ball that falls by symplectic Euler, and bounces with `bounce` where it enters the ground.
struct Bouncing {
  double radius_m, height_m, speed_mps, restitution, step_s, bounce;
  Motion motion() const {
    State start;
    start.position_m.z() = radius_m + height_m;
    start.velocity_mps.z() = -speed_mps;
    const Scene scene = one_body(SphereShape{radius_m}, start, true, {0.0, restitution});
    return motion_of(scene, step_s, 400, [this](std::vector<State>& states, std::size_t) {
      State& ball = states.back();
      const double free_mps = ball.velocity_mps.z() - k_g_mps2 * step_s;
      const bool hits = ball.position_m.z() < radius_m && free_mps < 0.0;
      ball.velocity_mps.z() = hits ? std::max(0.0, -bounce * ball.velocity_mps.z()) : free_mps;
      ball.position_m.z() += step_s * ball.velocity_mps.z();
    });
  }
};

Bouncing draw_bouncing(Dice& dice) {
  Bouncing ball{};
  ball.radius_m = dice.decades(0.1, 10.0);
  // So that no ball goes farther than half its radius in a step.
  ball.step_s = dice.decades(1e-4, 0.002);
  ball.speed_mps = dice.decades(0.5, 10.0);
  ball.height_m = ball.speed_mps * ball.step_s * dice.uniform(1.0, 50.0);
  ball.restitution = dice.chance(0.3) ? 0.0 : dice.chance(0.3) ? 1.0 : dice.unit();
  ball.bounce = ball.restitution;
  return ball;
}

TEST(Oracles, AreSilentOnABallThatBouncesAsItShould) {
  Dice dice({1}, "bounce");
  for (int k = 0; k < k_family; ++k) {
    const Bouncing ball = draw_bouncing(dice);
    EXPECT_EQ(all_broken(ball.motion()), "")
        << "r " << ball.radius_m << " v " << ball.speed_mps << " e " << ball.restitution << " h "
        << ball.step_s << " height " << ball.height_m;
  }
}

TEST(Oracles, SeeAPlasticHitThatBounces) {
  Dice dice({2}, "plastic");
  int seen = 0;
  for (int k = 0; k < k_family; ++k) {
    Bouncing ball = draw_bouncing(dice);
    ball.restitution = 0.0;
    ball.bounce = 1.0;
    if (breaks(ball.motion(), "impact")) ++seen;
  }
  // Where the fall of a step is as large as the speed, nobody can tell.
  EXPECT_GT(seen, k_family / 2);
}

TEST(Oracles, SeeEnergyMadeByABounce) {
  Dice dice({3}, "made");
  int seen = 0;
  for (int k = 0; k < k_family; ++k) {
    Bouncing ball = draw_bouncing(dice);
    ball.restitution = 1.0;
    ball.bounce = 1.3;
    const Motion motion = ball.motion();
    if (breaks(motion, "impact") || breaks(motion, "energy")) ++seen;
  }
  EXPECT_GT(seen, k_family / 2);
}

// A brick on level ground that slides with `share` of the friction, from 1 m/s.
Motion sliding(double friction, double share) {
  State start;
  start.position_m.z() = 0.05;
  start.velocity_mps.x() = 1.0;
  const Scene scene = one_body(BoxShape{{0.1, 0.1, 0.05}}, start, true, {friction, 0.0});
  return motion_of(scene, 0.001, 300, [&](std::vector<State>& states, std::size_t) {
    State& brick = states.back();
    const double loss_mps = share * friction * k_g_mps2 * 0.001;
    brick.velocity_mps.x() = std::max(0.0, brick.velocity_mps.x() - loss_mps);
    brick.position_m.x() += 0.001 * brick.velocity_mps.x();
  });
}

TEST(Oracles, HoldFrictionToItsCoefficient) {
  for (const double friction : {0.01, 0.1, 0.5, 1.0}) {
    EXPECT_EQ(all_broken(sliding(friction, 1.0)), "") << friction;
    EXPECT_TRUE(breaks(sliding(friction, 0.8), "friction")) << friction;
    EXPECT_TRUE(breaks(sliding(friction, 1.2), "cone")) << friction;
  }
}

// Two bricks that meet without gravity; `through`: nothing happens; else they stop each other.
Motion meeting(double speed_mps, double step_s, bool through) {
  Scene scene;
  scene.world.gravity_mps2.setZero();
  State left;
  left.velocity_mps.x() = speed_mps;
  State right;
  right.position_m.x() = 1.0;
  scene.world.bodies = {solid_body("a", BoxShape{{0.1, 0.05, 0.05}}, 1000.0, left),
                        solid_body("b", BoxShape{{0.1, 0.05, 0.05}}, 1000.0, right)};
  return motion_of(scene, step_s, 100, [&](std::vector<State>& states, std::size_t) {
    State& a = states[0];
    State& b = states[1];
    if (!through && b.position_m.x() - a.position_m.x() < 0.2 + speed_mps * step_s) {
      a.velocity_mps.x() = b.velocity_mps.x() = 0.5 * speed_mps;
    }
    a.position_m += step_s * a.velocity_mps;
    b.position_m += step_s * b.velocity_mps;
  });
}

TEST(Oracles, SeeWhatPassesOrEnters) {
  EXPECT_EQ(all_broken(meeting(5.0, 0.005, false)), "");
  EXPECT_TRUE(breaks(meeting(5.0, 0.005, true), "overlap"));
  // 0.7 m in a step: no pose shows the two bricks inside each other.
  EXPECT_TRUE(breaks(meeting(140.0, 0.005, true), "passage"));
  EXPECT_EQ(all_broken(meeting(140.0, 0.005, false)), "");
}

TEST(Oracles, SeeABodyBehindThePlane) {
  State start;
  start.position_m.z() = 0.5;
  const Scene scene = one_body(BoxShape{{0.1, 0.1, 0.1}}, start, true, {});
  const Motion falls = motion_of(scene, 0.01, 100, [](std::vector<State>& states, std::size_t) {
    states.back().velocity_mps.z() -= 0.01 * k_g_mps2;
    states.back().position_m += 0.01 * states.back().velocity_mps;
  });
  EXPECT_TRUE(breaks(falls, "passage"));
  EXPECT_TRUE(breaks(falls, "overlap"));
}

TEST(Oracles, SeeMomentumThatComesFromNowhere) {
  for (const double leak : {1e-6, 1e-3, 0.1}) {
    Motion motion = meeting(5.0, 0.005, false);
    EXPECT_FALSE(breaks(motion, "momentum"));
    for (std::size_t n = 50; n < motion.states.size(); ++n) {
      motion.states[n][0].velocity_mps.y() += leak;
    }
    EXPECT_TRUE(breaks(motion, "momentum")) << leak;
  }
}

TEST(Oracles, SeeSpinThatComesFromNowhere) {
  Motion motion = meeting(5.0, 0.005, false);
  motion.scheme->gyroscopic = GyroscopicRule::explicit_body;
  EXPECT_FALSE(breaks(motion, "spin"));
  for (std::size_t n = 20; n < motion.states.size(); ++n) {
    motion.states[n][0].angular_velocity_radps.z() += 1.0;
  }
  EXPECT_TRUE(breaks(motion, "spin"));
}

// Bodies that fall side by side: their angular momentum is nothing but the rounding of velocities.
TEST(Oracles, LetTheVelocitiesOfWhatFallsTogetherRound) {
  for (const double off : {1e-15, 1e-9}) {
    Scene scene = one_body(BoxShape{{0.1, 0.1, 0.1}}, {}, false, {});
    State other;
    other.position_m.x() = 0.2;
    scene.world.bodies.push_back(solid_body("other", BoxShape{{0.1, 0.1, 0.1}}, 1000.0, other));
    Motion motion = motion_of(scene, 0.001, 3, [&](std::vector<State>& states, std::size_t step) {
      states[0].velocity_mps.z() = -k_g_mps2 * 0.001 * static_cast<double>(step) * (1.0 + off);
      states[1].velocity_mps.z() = -k_g_mps2 * 0.001 * static_cast<double>(step) * (1.0 - off);
      const double way_m = -0.5 * k_g_mps2 * 1e-6 * (2.0 * static_cast<double>(step) - 1.0);
      for (State& state : states) state.position_m.z() += way_m;
    });
    motion.scheme->gyroscopic = GyroscopicRule::spatial_momentum;
    EXPECT_EQ(breaks(motion, "spin"), off > 1e-12) << off;
  }
}

// A brick at rest that goes most of the way of its neighbour's double speed in one step and rests
// again: thrown and stopped by the neighbours within the step, if the engine looks so often.
Motion thrown_and_stopped(double depth_share, double apart_m) {
  constexpr double k_step_s = 0.005;
  Scene scene = one_body(BoxShape{{0.1, 0.1, 0.1}}, {}, false, {});
  State other;
  other.position_m.x() = apart_m;
  other.velocity_mps.x() = 10.0;
  scene.world.gravity_mps2.setZero();
  scene.world.bodies.push_back(solid_body("other", BoxShape{{0.1, 0.1, 0.1}}, 1000.0, other));
  Motion motion = motion_of(scene, k_step_s, 3, [](std::vector<State>& states, std::size_t step) {
    states[1].position_m.x() += 10.0 * k_step_s;
    if (step == 2) states[0].position_m.x() -= 1.8 * 10.0 * k_step_s;
  });
  motion.scheme->contact = SequentialContact{.depth_share = depth_share};
  return motion;
}

TEST(Oracles, LetACutStepThrowABodyToAndFro) {
  EXPECT_FALSE(breaks(thrown_and_stopped(0.25, 0.25), "kinematics"));
  EXPECT_TRUE(breaks(thrown_and_stopped(0.0, 0.25), "kinematics"));
  EXPECT_TRUE(breaks(thrown_and_stopped(0.25, 5.0), "kinematics"));
  for (const bool within : {true, false}) {
    Motion motion = thrown_and_stopped(0.0, 0.25);
    motion.scheme->contact = ImpulseContact{.bounces_before_touch = within};
    EXPECT_EQ(breaks(motion, "kinematics"), !within);
  }
}

// Points that are hit one after the other may part after a plastic hit; none adds energy.
TEST(Oracles, HoldHitsInTurnToTheirEnergyAlone) {
  Dice dice({4}, "turn");
  int joint = 0;
  int made = 0;
  for (int k = 0; k < k_family; ++k) {
    Bouncing ball = draw_bouncing(dice);
    ball.restitution = 0.0;
    const auto breaks_impact = [&](double bounce, bool at_once) {
      ball.bounce = bounce;
      Motion motion = ball.motion();
      motion.scheme->contact = SequentialContact{.hits_at_once = at_once};
      return breaks(motion, "impact");
    };
    EXPECT_FALSE(breaks_impact(0.9, false));
    if (breaks_impact(0.9, true)) ++joint;
    if (breaks_impact(2.0, false)) ++made;
  }
  EXPECT_GT(joint, k_family / 2);
  EXPECT_GT(made, k_family / 2);
}

// One body alone, and three, of any law: there is no pair whose face could be asked for.
TEST(Oracles, HoldHitsInTurnOfAnyNumberOfBodies) {
  for (const std::size_t others : {0U, 2U}) {
    Scene scene = one_body(BoxShape{{0.1, 0.1, 0.1}}, {}, false, {0.5, 0.5});
    for (std::size_t k = 1; k <= others; ++k) {
      State other;
      other.position_m.x() = 0.5 * static_cast<double>(k);
      scene.world.bodies.push_back(solid_body("other", BoxShape{{0.1, 0.1, 0.1}}, 1000.0, other));
    }
    scene.world.gravity_mps2.setZero();
    Motion motion = motion_of(scene, 0.01, 3, [](std::vector<State>&, std::size_t) {});
    motion.scheme->contact = SequentialContact{};
    EXPECT_EQ(all_broken(motion), "") << others;
  }
}

TEST(Oracles, SeeABodyHeldInTheAir) {
  State start;
  start.position_m.z() = 5.0;
  const Scene scene = one_body(BoxShape{{0.1, 0.1, 0.1}}, start, true, {});
  const Motion held = motion_of(scene, 0.01, 50, [](std::vector<State>& states, std::size_t step) {
    if (step > 20) return;
    states.back().velocity_mps.z() -= 0.01 * k_g_mps2;
    states.back().position_m += 0.01 * states.back().velocity_mps;
  });
  EXPECT_TRUE(breaks(held, "push"));
}

}  // namespace
}  // namespace brickbench::hunt
