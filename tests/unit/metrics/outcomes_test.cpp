// The outcomes of a structure on runs known by heart.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/metrics/metric_runs.hpp"

namespace brickbench::testing {
namespace {

// Ten bricks in a row on the ground at gravity 10 m/s2. The last one leaves sideways at 2 m/s from
// step 20 to step 60 and lies still again.
SyntheticRun leaving() {
  std::vector<Body> bodies;
  for (const char* name : {"a", "b", "c", "d", "e", "f", "g", "h", "i", "j"}) {
    bodies.push_back(test_brick(name, {static_cast<double>(bodies.size()), 0, 0.05}));
  }
  SyntheticRun run{.scene = scene_of(bodies, {0, 0, -10}), .step_s = 0.01};
  run.states = [start = initial_states(run.scene)](std::size_t step) {
    auto states = start;
    const auto gone = static_cast<double>(std::clamp<std::size_t>(step, 20, 60) - 20);
    states[9].position_m.y() += 0.02 * gone;
    if (step > 20 && step <= 60) states[9].velocity_mps.y() = 2.0;
    return states;
  };
  return run;
}

TEST(Outcomes, OfOneBrickThatLeaves) {
  const auto found = measure("outcomes", leaving());
  EXPECT_NEAR(value(found, "rubble_height_m"), 0.1, 1e-15);
  EXPECT_NEAR(value(found, "bricks_run_out_m"), 0.8, 1e-12);
  EXPECT_NEAR(value(found, "settling_time_s"), 0.6, 1e-12);
  // 0.05 m are passed in the third step; one of ten bricks is a tenth.
  EXPECT_NEAR(value(found, "collapse_time_s"), 0.23, 1e-12);
}

TEST(Outcomes, OfAWallThatStands) {
  SyntheticRun run = leaving();
  run.states = [start = initial_states(run.scene)](std::size_t) { return start; };
  const auto found = measure("outcomes", run);
  EXPECT_EQ(value(found, "settling_time_s"), 0.0);
  EXPECT_NEAR(value(found, "collapse_time_s"), 1.0, 1e-12);
  EXPECT_EQ(find(found, "collapse_time_s").note, "did not collapse");
  EXPECT_EQ(value(found, "bricks_run_out_m"), 0.0);
}

// Out by 0.2 m from step 20 to step 30, back to its place, and out again from step `again` on.
SyntheticRun swaying(std::size_t again) {
  SyntheticRun run = leaving();
  run.states = [start = initial_states(run.scene), again](std::size_t step) {
    auto states = start;
    if ((step >= 20 && step < 30) || step >= again) states[9].position_m.y() += 0.2;
    return states;
  };
  return run;
}

TEST(Outcomes, WhatComesBackHasNotCollapsed) {
  const auto back = measure("outcomes", swaying(1000));
  EXPECT_NEAR(value(back, "collapse_time_s"), 1.0, 1e-12);
  EXPECT_EQ(find(back, "collapse_time_s").note, "did not collapse");
  EXPECT_NEAR(value(measure("outcomes", swaying(70)), "collapse_time_s"), 0.7, 1e-12);
}

// A brick of 0.2 m x 0.1 m x 0.1 m that turns in place about z: its corners move by
// 2 sin(turn / 2) sqrt(0.1^2 + 0.05^2) m, half the smallest edge at 0.452 rad.
TEST(Outcomes, ATurnInPlaceIsADisplacement) {
  for (const double turn_rad : {0.44, 0.46, 1.0, 3.0}) {
    SyntheticRun run = leaving();
    run.states = [start = initial_states(run.scene), turn_rad](std::size_t step) {
      auto states = start;
      if (step >= 50) states[4].orientation = Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ());
      return states;
    };
    const bool moved = turn_rad > 0.452;
    EXPECT_EQ(value(measure("displaced", run), "bricks_displaced"), moved ? 1.0 : 0.0) << turn_rad;
    EXPECT_EQ(value(measure("displaced", run), "brick_displacement_max_m"), 0.0);
    EXPECT_NEAR(value(measure("outcomes", run), "collapse_time_s"), moved ? 0.5 : 1.0, 1e-12);
  }
}

TEST(Outcomes, HeightFollowsATurnedBrick) {
  SyntheticRun run = leaving();
  run.states = [start = initial_states(run.scene)](std::size_t step) {
    auto states = start;
    if (step == 0) return states;
    states[3].orientation = Eigen::AngleAxisd(M_PI_2, Eigen::Vector3d::UnitY());
    states[3].position_m.z() = 0.1;
    return states;
  };
  EXPECT_NEAR(value(measure("outcomes", run), "rubble_height_m"), 0.2, 1e-12);
}

}  // namespace
}  // namespace brickbench::testing
