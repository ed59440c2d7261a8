// Static truth against borders that statics gives in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "experiments/oracle/assemblies.hpp"

namespace brickbench::gate {
namespace {

World two_bricks(double shift_m) {
  World world;
  world.law.friction = 0.6;
  world.bodies = {ground_plane(), solid_body("low", BoxShape{{0.1, 0.05, 0.05}}, 1800.0),
                  solid_body("high", BoxShape{{0.1, 0.05, 0.05}}, 1800.0)};
  world.bodies[1].initial.position_m = {0.0, 0.0, 0.05};
  world.bodies[2].initial.position_m = {shift_m, 0.0, 0.15};
  return world;
}

World incline(double friction, double angle_rad) {
  World world;
  world.law.friction = friction;
  world.gravity_mps2 = 9.81 * Eigen::Vector3d(std::sin(angle_rad), 0.0, -std::cos(angle_rad));
  world.bodies = {ground_plane(), solid_body("brick", BoxShape{{0.1, 0.05, 0.05}}, 1800.0)};
  world.bodies[1].initial.position_m.z() = 0.05;
  return world;
}

// N bricks, each 1/i of half a length over the one below: the harmonic border, from the top.
World harmonic(int count, double factor) {
  World world;
  world.law.friction = 0.6;
  world.bodies.push_back(ground_plane());
  double x = 0.0;
  std::vector<double> at(static_cast<std::size_t>(count), 0.0);
  for (int i = count - 1; i > 0; --i) {  // from the top brick down
    x -= factor * 0.1 / (count - i);
    at[static_cast<std::size_t>(i - 1)] = x;
  }
  for (int i = 0; i < count; ++i) {
    Body brick = solid_body("b" + std::to_string(i), BoxShape{{0.1, 0.05, 0.05}}, 1800.0);
    brick.initial.position_m = {at[static_cast<std::size_t>(i)], 0.0, 0.05 + 0.1 * i};
    world.bodies.push_back(brick);
  }
  return world;
}

TEST(StaticTruth, BordersAreThoseOfStatics) {
  using enum StaticLabel;
  EXPECT_EQ(static_verdict(two_bricks(0.099)).label, stands);
  EXPECT_EQ(static_verdict(two_bricks(0.101)).label, falls);
  EXPECT_EQ(static_verdict(incline(0.5, std::atan(0.5) - 0.005)).label, stands);
  EXPECT_EQ(static_verdict(incline(0.5, std::atan(0.5) + 0.005)).label, falls);
  EXPECT_EQ(static_verdict(harmonic(5, 0.99)).label, stands);
  EXPECT_EQ(static_verdict(harmonic(5, 1.01)).label, falls);
}

TEST(StaticTruth, SlidingOnASlopeLeavesTheClosedFormUnbalanced) {
  // Distance of the weight to the cone, over the weight: sin(angle - atan mu), where the torque
  // about the centre can be met as well; that costs more, never less.
  const double share = static_verdict(incline(0.3, 0.5)).lower_share;
  EXPECT_GE(share, 0.999 * std::sin(0.5 - std::atan(0.3)));
}

// A wall of two courses whose upper bricks have the given part of their length below them at the
// wall's end.
World end_brick(double share) {
  World world;
  world.law.friction = 0.6;
  const BoxShape brick{{0.1, 0.05, 0.05}};
  world.bodies = {ground_plane(), solid_body("low", brick, 1800.0),
                  solid_body("low_2", brick, 1800.0), solid_body("inner", brick, 1800.0),
                  solid_body("end", brick, 1800.0)};
  const double end_m = 0.4 - share * 0.2;  // where the last brick begins
  world.bodies[1].initial.position_m = {0.1, 0.0, 0.05};
  world.bodies[2].initial.position_m = {0.3, 0.0, 0.05};
  world.bodies[3].initial.position_m = {end_m - 0.1, 0.0, 0.15};
  world.bodies[4].initial.position_m = {end_m + 0.1, 0.0, 0.15};
  return world;
}

TEST(StaticTruth, HalfSupportedEndBricksHaveNoStrictLabel) {
  using enum StaticLabel;
  EXPECT_TRUE(robust(end_brick(0.55), stands));
  EXPECT_FALSE(robust(end_brick(0.5), stands));
  EXPECT_FALSE(robust(end_brick(0.5), falls));
}

TEST(StaticTruth, MarginsOfFrictionAndFacesCount) {
  using enum StaticLabel;
  const Margins friction_only{.tilt_rad = 0.0, .friction_share = 0.1, .border_share = 0.0};
  EXPECT_TRUE(robust(incline(0.5, std::atan(0.44)), stands, friction_only));
  EXPECT_FALSE(robust(incline(0.5, std::atan(0.46)), stands, friction_only));
  EXPECT_FALSE(robust(incline(0.5, std::atan(0.54)), falls, friction_only));
  EXPECT_TRUE(robust(incline(0.5, std::atan(0.56)), falls, friction_only));
  const Margins faces_only{.tilt_rad = 0.0, .friction_share = 0.0, .border_share = 0.05};
  EXPECT_TRUE(robust(two_bricks(0.094), stands, faces_only));  // 0.05 of 0.1 m are 5 mm
  EXPECT_FALSE(robust(two_bricks(0.096), stands, faces_only));
  EXPECT_FALSE(robust(two_bricks(0.104), falls, faces_only));
  EXPECT_TRUE(robust(two_bricks(0.106), falls, faces_only));
}

TEST(StaticTruth, AssembliesAreLabelledOnBothSidesInEveryFamily) {
  std::map<std::string, int> count;
  for (const LabelledAssembly& item : labelled_assemblies(24, 1)) {
    ++count[item.family + (item.verdict.label == StaticLabel::falls ? " falls" : " stands")];
  }
  const std::map<std::string, int> expected = {
      {"tower falls", 3},           {"tower stands", 3},
      {"leaning_courses falls", 3}, {"leaning_courses stands", 3},
      {"missing_bricks falls", 3},  {"missing_bricks stands", 3},
      {"overhang falls", 3},        {"overhang stands", 3}};
  EXPECT_EQ(count, expected);
}

}  // namespace
}  // namespace brickbench::gate
