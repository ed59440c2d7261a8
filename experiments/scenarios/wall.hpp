// Walls: bricks laid dry, course upon course, in the x-z plane. Columns run along x, courses along
// z, the thickness along y; the middle of the wall's foot is the origin.
#pragma once

#include <vector>

#include "experiments/scenarios/scenario.hpp"

namespace brickbench {

enum class Bond {
  running,  // odd courses are shifted by half a brick
  stack,    // every head joint stands on the one below
};

struct WallPlan {
  int courses = 10;
  int columns = 10;                           // full bricks in the lowest course
  Eigen::Vector3d brick_m = {0.2, 0.1, 0.1};  // full edges
  double density_kgpm3 = 2000.0;
  Bond bond = Bond::running;
  // Running bond only. True: half bricks close both ends of odd courses. False: the ends are racked
  // back, each course one brick shorter than the one below (a toothed end would not stand dry).
  bool half_bricks = true;
  double head_joint_gap_m = 0.001;  // between neighbours of a course; bed joints are closed
};

// courses, columns, brick_*_m, density_kgpm3, bond, half_bricks, head_joint_gap_m.
std::vector<Parameter> wall_parameters(int courses, int columns);
WallPlan wall_plan(const ParameterValues& values);

// The bricks course by course from below, each course along +x; brick n of course c is named
// "brick_cC_nN", both counted from 0. The lowest course stands on z = 0. Fault::invalid if the
// head joint is so wide that a brick finds no support or a half brick has no length.
Expected<std::vector<Body>> wall_bricks(const WallPlan& plan);

// Height of the wall's top (m) and half its greatest length along x (m).
double wall_height_m(const WallPlan& plan);
double wall_half_length_m(const WallPlan& plan);

}  // namespace brickbench
