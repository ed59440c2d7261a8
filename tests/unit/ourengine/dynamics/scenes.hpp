// Scenes of bricks for tests of the velocity-level engines: those of the scenarios, and random ones
// over their ranges.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "ourengine/integration/rotation.hpp"
#include "ourengine/model/body_model.hpp"
#include "tests/unit/ourengine/dynamics/wall.hpp"

namespace ourengine::testing {

struct BrickScene {
  std::string name;
  Wall wall = {};
  SurfaceLaw law = {};
  double step_s = 1.0 / 240;
  int steps = 40;
  Eigen::Vector3d gravity_mps2 = {0.0, 0.0, -9.81};
  std::vector<Load> loads = {};  // of the first step; may be empty
};

struct Start {
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d spin_radps = Eigen::Vector3d::Zero();
  Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();
};

inline void add_moving(Wall& wall, const Eigen::Vector3d& edges_m, const Eigen::Vector3d& at_m,
                       double density_kgpm3, const Start& start) {
  add_brick(wall, 0.5 * edges_m, at_m, start.velocity_mps, density_kgpm3);
  Motion& motion = wall.motions.back();
  motion.attitude = start.attitude;
  const Eigen::Matrix3d r = start.attitude.toRotationMatrix();
  motion.angular_momentum_kgm2ps =
      r * wall.bodies.back().inertia_kgm2.cwiseProduct(r.transpose() * start.spin_radps);
}

inline void add_plane(Wall& wall) {
  BodyModel ground;
  ground.geometry = PlaneGeometry{};
  ground.fixed = true;
  wall.bodies.push_back(ground);
  wall.motions.push_back({});
}

// A brick over the ground; height_m of its lowest point.
inline BrickScene dropped(const Eigen::Vector3d& edges_m, double density_kgpm3, double height_m,
                          const Start& start) {
  BrickScene scene{.name = "dropped"};
  add_plane(scene.wall);
  const double reach_m =
      (0.5 * edges_m).dot(start.attitude.toRotationMatrix().row(2).transpose().cwiseAbs());
  add_moving(scene.wall, edges_m, {0.0, 0.0, height_m + reach_m}, density_kgpm3, start);
  return scene;
}

// A block of bricks over the ground, driven apart by blows of the first step: each brick alone
// would leave with a velocity in proportion to its distance from the middle, all with work_j.
inline BrickScene blasted(const Eigen::Vector3d& edges_m, double density_kgpm3,
                          const std::array<int, 3>& counts, double gap_m, double clearance_m,
                          double work_j, double step_s) {
  BrickScene scene{.name = "blasted", .step_s = step_s};
  add_plane(scene.wall);
  scene.loads.push_back({});
  const Eigen::Vector3d pitch_m = edges_m.array() + gap_m;
  const Eigen::Vector3d middle_m(
      0.0, 0.0, clearance_m + 0.5 * (counts[2] * edges_m.z() + (counts[2] - 1) * gap_m));
  double twice_energy = 0.0;
  for (int k = 0; k < counts[2]; ++k) {
    for (int j = 0; j < counts[1]; ++j) {
      for (int i = 0; i < counts[0]; ++i) {
        const Eigen::Vector3d steps(i - 0.5 * (counts[0] - 1), j - 0.5 * (counts[1] - 1),
                                    k - 0.5 * (counts[2] - 1));
        const Eigen::Vector3d from_middle_m = pitch_m.cwiseProduct(steps);
        add_moving(scene.wall, edges_m, middle_m + from_middle_m, density_kgpm3, {});
        const double mass_kg = scene.wall.bodies.back().mass_kg;
        scene.loads.push_back({mass_kg / step_s * from_middle_m, {0.0, 0.0, 0.0}});
        twice_energy += mass_kg * from_middle_m.squaredNorm();
      }
    }
  }
  for (Load& load : scene.loads) load.force_n *= std::sqrt(2.0 * work_j / twice_energy);
  return scene;
}

// A brick flat on a large fixed box whose upper face falls by angle_rad along x.
inline BrickScene on_slope(const Eigen::Vector3d& edges_m, double density_kgpm3, double angle_rad,
                           double speed_mps, double heading_rad) {
  BrickScene scene{.name = "on a slope"};
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitY()));
  const Eigen::Vector3d slab_m(40.0, 40.0, 10.0);
  add_moving(scene.wall, slab_m, turn * Eigen::Vector3d(0.0, 0.0, -0.5 * slab_m.z()), 1.0,
             {.attitude = turn});
  scene.wall.bodies.back().fixed = true;
  const Eigen::Vector3d along(std::cos(heading_rad), std::sin(heading_rad), 0.0);
  add_moving(scene.wall, edges_m, turn * Eigen::Vector3d(0.0, 0.0, 0.5 * edges_m.z()),
             density_kgpm3, {.velocity_mps = turn * (speed_mps * along), .attitude = turn});
  return scene;
}

struct Thrown {
  Eigen::Vector3d edges_m;
  double density_kgpm3 = 2000.0;
  double speed_mps = 0.0;  // along x
  Eigen::Vector3d spin_radps = Eigen::Vector3d::Zero();
};

// Two bricks without gravity, gap_m apart along x; offset_m of b's centre, across.
inline BrickScene meeting(const Thrown& a, const Thrown& b, double gap_m, double offset_y_m,
                          double offset_z_m) {
  BrickScene scene{.name = "two bricks"};
  scene.gravity_mps2.setZero();
  add_moving(scene.wall, a.edges_m, {0.0, 0.0, 0.0}, a.density_kgpm3,
             {.velocity_mps = {a.speed_mps, 0.0, 0.0}, .spin_radps = a.spin_radps});
  add_moving(scene.wall, b.edges_m,
             {0.5 * (a.edges_m.x() + b.edges_m.x()) + gap_m, offset_y_m, offset_z_m},
             b.density_kgpm3,
             {.velocity_mps = {b.speed_mps, 0.0, 0.0}, .spin_radps = b.spin_radps});
  return scene;
}

// Bricks on each other.
inline BrickScene stacked(const Eigen::Vector3d& edges_m, double density_kgpm3, int count) {
  BrickScene scene{.name = "stacked"};
  add_plane(scene.wall);
  for (int i = 0; i < count; ++i) {
    add_moving(scene.wall, edges_m, {0.0, 0.0, (i + 0.5) * edges_m.z()}, density_kgpm3, {});
  }
  return scene;
}

// A running-bond wall, hit from the side of -y by a brick of `scale` times its bricks' size.
// at: where, as shares of width and height, and how far from the wall in its thicknesses (y).
inline BrickScene hit_wall(const Eigen::Vector3d& edges_m, double density_kgpm3, int columns,
                           int courses, double joint_m, double scale, double speed_mps,
                           const Eigen::Vector3d& at, const Eigen::Vector3d& spin_radps) {
  BrickScene scene{.name = "hit wall"};
  add_plane(scene.wall);
  const double module_m = edges_m.x() + joint_m;
  const Eigen::Vector3d half_brick_m(0.5 * edges_m.x(), edges_m.y(), edges_m.z());
  const double end_m = columns * module_m - joint_m;
  const double side_m = 0.25 * (edges_m.x() - joint_m);
  for (int k = 0; k < courses; ++k) {
    const double z_m = (k + 0.5) * edges_m.z();
    if (k % 2 == 0) {
      for (int i = 0; i < columns; ++i) {
        add_moving(scene.wall, edges_m, {module_m * i + 0.5 * edges_m.x(), 0.0, z_m}, density_kgpm3,
                   {});
      }
      continue;
    }
    add_moving(scene.wall, half_brick_m, {side_m, 0.0, z_m}, density_kgpm3, {});
    for (int i = 1; i < columns; ++i) {
      add_moving(scene.wall, edges_m, {module_m * i - 0.5 * joint_m, 0.0, z_m}, density_kgpm3, {});
    }
    add_moving(scene.wall, half_brick_m, {end_m - side_m, 0.0, z_m}, density_kgpm3, {});
  }
  const Eigen::Vector3d thrown_m = scale * edges_m;
  const double reach_m = 0.5 * thrown_m.norm();
  add_moving(scene.wall, thrown_m,
             {at.x() * end_m, -(0.5 * edges_m.y() + 1.01 * reach_m + at.y() * edges_m.y()),
              at.z() * courses * edges_m.z() + reach_m},
             density_kgpm3, {.velocity_mps = {0.0, speed_mps, 0.0}, .spin_radps = spin_radps});
  return scene;
}

// The same scene for the same seed everywhere: the standard prescribes the generator.
class Draws {
 public:
  explicit Draws(unsigned seed) : generator_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(generator_() >> 11) * 0x1p-53);
  }
  double log_uniform(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }
  int whole(int count) { return static_cast<int>(generator_() % static_cast<unsigned>(count)); }
  template <std::size_t n>
  double any(const std::array<double, n>& values) {
    return values[static_cast<std::size_t>(whole(static_cast<int>(n)))];
  }
  Eigen::Vector3d vector(double size) {
    const double x = uniform(-size, size), y = uniform(-size, size), z = uniform(-size, size);
    return {x, y, z};
  }

 private:
  std::mt19937_64 generator_;
};

inline BrickScene draw_bodies(Draws& draw, double step_s) {
  const double size_m = draw.log_uniform(1e-3, 10.0);
  const auto edge_m = [&] { return std::clamp(size_m * draw.log_uniform(0.3, 3.0), 1e-3, 10.0); };
  const auto edges_m = [&] {
    const double x = edge_m(), y = edge_m(), z = edge_m();
    return Eigen::Vector3d(x, y, z);
  };
  const auto spin_radps = [&] {
    return draw.vector(draw.any<7>({0.0, 0.0, 1.0, 10.0, 50.0, 100.0, 1000.0}));
  };
  const Eigen::Vector3d edges = edges_m();
  const double density = draw.log_uniform(5.0, 2e4);
  switch (draw.whole(6)) {
    case 0: {
      Start start{.velocity_mps = {0.0, 0.0, -draw.any<4>({0.0, 1.0, 10.0, 100.0})},
                  .spin_radps = spin_radps()};
      if (draw.whole(2) == 0) start.attitude = turned({1, 0, 0, 0}, draw.vector(3.0));
      return dropped(edges, density, size_m * draw.any<3>({0.0, 0.01, 2.0}), start);
    }
    case 1: {
      constexpr std::array<std::array<int, 3>, 3> k_counts = {{{2, 1, 1}, {2, 2, 1}, {2, 2, 2}}};
      const auto& counts = k_counts[static_cast<std::size_t>(draw.whole(3))];
      const double speed_mps = draw.log_uniform(0.1, 1000.0);
      const double mass_kg = density * edges.prod() * counts[0] * counts[1] * counts[2];
      return blasted(edges, density, counts, size_m * draw.any<2>({0.0, 0.05}),
                     draw.any<3>({0.0, 0.1 * size_m, 1.0}), 0.5 * mass_kg * speed_mps * speed_mps,
                     step_s);
    }
    case 2:
      return on_slope(edges, density, draw.any<4>({0.0, 0.3, 0.6, 1.2}),
                      draw.any<3>({0.0, 1.0, 20.0}), draw.uniform(0.0, 6.28));
    case 3: {
      const Thrown a{edges, density, draw.log_uniform(0.5, 200.0), spin_radps()};
      const Thrown b{edges_m(), draw.log_uniform(5.0, 2e4), 0.0, spin_radps()};
      const double gap_m = size_m * draw.any<3>({0.0, 0.01, 0.3});
      const double y_m = size_m * draw.uniform(-0.6, 0.6), z_m = size_m * draw.uniform(-0.6, 0.6);
      return meeting(a, b, gap_m, y_m, z_m);
    }
    case 4:
      return stacked(edges, density, 2 + draw.whole(5));
    default: {
      const int columns = 2 + draw.whole(2), courses = 2 + draw.whole(2);
      const double joint_m = size_m * draw.any<2>({0.0, 0.005});
      const double scale = draw.any<3>({1.0, 0.5, 2.0}), speed_mps = draw.log_uniform(0.5, 200.0);
      const double x = draw.uniform(0.1, 0.9), y = draw.uniform(0.01, 1.0),
                   z = draw.uniform(0.0, 0.8);
      return hit_wall(edges, density, columns, courses, joint_m, scale, speed_mps, {x, y, z},
                      spin_radps());
    }
  }
}

// Sizes 1 mm to 10 m, densities 5 to 20 000 kg/m3, speeds to 1000 m/s, spins to 1000 rad/s, steps
// 1e-5 to 1/60 s. Some start in each other: those are no scenes.
inline BrickScene random_scene(unsigned seed) {
  Draws draw(seed);
  const SurfaceLaw law = {draw.any<5>({0.0, 0.1, 0.5, 1.0, 3.0}),
                          draw.any<5>({0.0, 0.3, 0.7, 1.0, 1.0})};
  const double step_s =
      draw.any<8>({1.0 / 60, 1.0 / 60, 1.0 / 120, 1.0 / 240, 1e-3, 3e-4, 1e-4, 1e-5});
  BrickScene scene = draw_bodies(draw, step_s);
  scene.law = law;
  scene.step_s = step_s;
  scene.steps = 30;
  return scene;
}

}  // namespace ourengine::testing
