// Contact problems of brick walls, for the tests and benchmarks of the contact solvers.
//
// Running bond, bricks 0.2 x 0.1 x 0.1 m at 2000 kg/m3, half bricks at the ends of every second
// course; four contacts per touching pair of faces (bed joints, and head joints if asked for); on a
// fixed floor. Two states, at step 1/240 s under gravity:
//
//  * rest: velocities with 1e-3 m/s of noise;
//  * impact: a struck patch in the middle (sigma 2 m/s and 10 rad/s), normals tilted by noise of
//    0.02 rad, 30 % of the pairs open by about 1e-4 m.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "ourengine/contact/problem.hpp"

namespace brickbench::testing {

enum class WallState { kRest, kImpact };

struct WallSpec {
  int columns = 10;
  int courses = 10;
  WallState state = WallState::kRest;
  double friction = 0.0;
  bool head_joints = true;
  unsigned seed = 1;
  double noise_mps = 1e-3;
};

class WallBuilder {
 public:
  explicit WallBuilder(const WallSpec& spec) : spec_(spec), random_(spec.seed) {}

  ourengine::ContactProblem build() {
    problem_.step_s = 1.0 / 240.0;
    problem_.bodies.push_back({1.0, Eigen::Matrix3d::Identity(), true});  // the floor
    bricks_.push_back({Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
    std::vector<std::vector<int>> courses;
    for (int r = 0; r < spec_.courses; ++r) courses.push_back(lay_course(r));
    for (int r = 0; r < spec_.courses; ++r) {
      for (std::size_t k = 0; k < courses[index(r)].size(); ++k) {
        const int brick = courses[index(r)][k];
        if (r == 0) bed_joint(0, brick);
        if (r > 0) {
          for (const int below : courses[index(r - 1)]) bed_joint(below, brick);
        }
        if (spec_.head_joints && k > 0) head_joint(courses[index(r)][k - 1], brick);
      }
    }
    set_velocities();
    return std::move(problem_);
  }

 private:
  struct Brick {
    Eigen::Vector3d centre, half;
  };
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  double normal() { return normal_(random_); }

  std::vector<int> lay_course(int r) {
    std::vector<int> course;
    const int count = r % 2 == 1 ? spec_.columns + 1 : spec_.columns;
    double x = 0.0;
    for (int k = 0; k < count; ++k) {
      const bool half = r % 2 == 1 && (k == 0 || k == count - 1);
      const Eigen::Vector3d size(half ? 0.1 : 0.2, 0.1, 0.1);
      const double mass = 2000.0 * size.prod();
      const Eigen::Vector3d square = size.cwiseAbs2();
      const Eigen::Vector3d inertia =
          mass / 12.0 * (Eigen::Vector3d::Constant(square.sum()) - square);
      problem_.bodies.push_back({mass, inertia.asDiagonal(), false});
      bricks_.push_back({{x + size[0] / 2, 0.0, 0.1 * (r + 0.5)}, size / 2});
      course.push_back(static_cast<int>(bricks_.size()) - 1);
      x += size[0];
    }
    return course;
  }

  void bed_joint(int below, int above) {
    const Brick& b = bricks_[index(above)];
    double low = b.centre[0] - b.half[0], high = b.centre[0] + b.half[0];
    if (below > 0) {
      const Brick& a = bricks_[index(below)];
      low = std::max(low, a.centre[0] - a.half[0]);
      high = std::min(high, a.centre[0] + a.half[0]);
    }
    if (high - low < 1e-6) return;
    const double z = b.centre[2] - b.half[2];
    add_face(below, above, {low, -b.half[1], z}, {high, b.half[1], z}, 2);
  }

  void head_joint(int left, int right) {
    const Brick& b = bricks_[index(right)];
    const double x = b.centre[0] - b.half[0];
    add_face(left, right, {x, -b.half[1], b.centre[2] - b.half[2]},
             {x, b.half[1], b.centre[2] + b.half[2]}, 0);
  }

  void add_face(int a, int b, const Eigen::Vector3d& low, const Eigen::Vector3d& high, int axis) {
    ourengine::ProblemContact contact;
    contact.body_a = a;
    contact.body_b = b;
    contact.friction = spec_.friction;
    contact.normal = Eigen::Vector3d::Unit(axis);
    const bool impact = spec_.state == WallState::kImpact;
    if (impact) {
      for (int c = 0; c < 3; ++c) contact.normal[c] += 0.02 * normal();
      contact.normal.normalize();
    }
    const Eigen::Vector3d help =
        std::abs(contact.normal[0]) < 0.7 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
    contact.tangent_1 = help.cross(contact.normal).normalized();
    contact.tangent_2 = contact.normal.cross(contact.tangent_1);
    const bool open = impact && random_() % 10 < 3;
    for (int q = 0; q < 4; ++q) {
      Eigen::Vector3d point = low;
      const int u = (axis + 1) % 3, w = (axis + 2) % 3;
      if (q & 1) point[u] = high[u];
      if (q & 2) point[w] = high[w];
      contact.arm_a_m = a == 0 ? point : Eigen::Vector3d(point - bricks_[index(a)].centre);
      contact.arm_b_m = point - bricks_[index(b)].centre;
      contact.gap_m = open ? 1e-4 * std::abs(normal()) : 0.0;
      contact.id = problem_.contacts.size();
      problem_.contacts.push_back(contact);
    }
  }

  void set_velocities() {
    const double width = 0.2 * spec_.columns;
    const Eigen::Vector3d centre(width / 2, 0.0, 0.05 * spec_.courses);
    const double spread = width / 6;
    problem_.free_velocity.push_back(ourengine::Velocity6::Zero());
    for (std::size_t i = 1; i < bricks_.size(); ++i) {
      double size = spec_.noise_mps;
      if (spec_.state == WallState::kImpact) {
        const double r2 = (bricks_[i].centre - centre).squaredNorm();
        size += 2.0 * std::exp(-r2 / (2.0 * spread * spread));
      }
      ourengine::Velocity6 velocity;
      for (int c = 0; c < 6; ++c) velocity[c] = (c < 3 ? 1.0 : 5.0) * size * normal();
      velocity[2] -= 9.81 * problem_.step_s;
      problem_.free_velocity.push_back(velocity);
    }
  }

  WallSpec spec_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  std::vector<Brick> bricks_;
  ourengine::ContactProblem problem_;
};

inline ourengine::ContactProblem make_wall(const WallSpec& spec) {
  return WallBuilder(spec).build();
}

}  // namespace brickbench::testing
