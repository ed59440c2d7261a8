// The Kapla tower of SimBenchmark (Jongwoo Lee, Dongho Kang, Jemin Hwangbo and others:
// "SimBenchmark: physics engine benchmark for robotics applications", 2018): 17 blocks per floor,
// 102 in six.
#include <fmt/core.h>

#include "experiments/scenarios/parts.hpp"

namespace brickbench {
namespace {

struct Block {
  Eigen::Vector3d edges_m;
  Eigen::Vector3d centre_m;
};

// The blocks of the floor whose foot is at z = 0: eight joists across, then a front wall of four
// blocks, and a back wall of three with one at each end. Two layers of 0.1 m each.
std::vector<Block> floor_blocks() {
  const Eigen::Vector3d joist_m(0.05, 0.25, 0.1);
  const Eigen::Vector3d wall_m(0.2, 0.05, 0.1);
  std::vector<Block> blocks;
  for (int j = 0; j < 8; ++j) blocks.push_back({joist_m, {0.2 * j, 0.0, 0.05}});
  for (int j = 0; j < 4; ++j) blocks.push_back({wall_m, {0.4 * j + 0.1, -0.1, 0.15}});
  for (int j = 0; j < 3; ++j) blocks.push_back({wall_m, {0.4 * j + 0.3, 0.1, 0.15}});
  blocks.push_back({wall_m, {0.1, 0.1, 0.15}});
  blocks.push_back({wall_m, {1.3, 0.1, 0.15}});
  return blocks;
}

Expected<Scene> make(const ParameterValues& values) {
  constexpr double k_floor_height_m = 0.2;
  const double mass_kg = number(values, "block_mass_kg");
  Scene scene;
  scene.world.law = contact_law(values);
  scene.world.bodies.push_back(ground_plane());
  for (int floor = 0; floor < count(values, "floors"); ++floor) {
    int index = 0;
    for (const Block& block : floor_blocks()) {
      const Eigen::Vector3d centre_m =
          block.centre_m + Eigen::Vector3d(0.0, 0.0, k_floor_height_m * floor);
      add_brick(scene, brick(fmt::format("block_f{}_n{}", floor, index++), block.edges_m,
                             mass_kg / block.edges_m.prod(), at(centre_m)));
    }
  }
  scene.length_scale_m = 0.05;
  return scene;
}

}  // namespace

Scenario kapla_tower() {
  return {.name = "kapla_tower",
          .meaning =
              "Six floors of joists and walls after SimBenchmark, who ask how long it "
              "stands; collapsed when the last block lies below 0.2 m times floors - 1.",
          .duration_s = 10.0,
          .parameters = joined(
              {{count_parameter("floors", 6, 1, 50, "floors of 17 blocks"),
                number_parameter("block_mass_kg", "kg", 10.0, 1e-3, 1e5, "mass of every block")},
               contact_parameters(0.64, 0.0)}),
          .make = make};
}

}  // namespace brickbench
