// Bricks one upon the other.
#include <fmt/core.h>

#include <cmath>

#include "experiments/scenarios/parts.hpp"

namespace brickbench {
namespace {

Expected<Scene> make(const ParameterValues& values) {
  const Eigen::Vector3d edges_m = size_m(values, "brick");
  const int bricks = count(values, "count");
  const double offset_m = number(values, "offset_m");
  const double gap_m = number(values, "gap_m");
  if (bricks > 1 && std::abs(offset_m) >= edges_m.x()) {
    return fail(Fault::invalid,
                fmt::format("offset_m = {} m: a brick of {} m would not lie on the one below",
                            offset_m, edges_m.x()));
  }
  Scene scene;
  scene.world.law = contact_law(values);
  scene.world.bodies.push_back(ground_plane());
  for (int i = 0; i < bricks; ++i) {
    const Eigen::Vector3d centre_m(offset_m * i, 0.0, (i + 0.5) * edges_m.z() + i * gap_m);
    add_brick(scene, brick(fmt::format("brick_{}", i), edges_m, number(values, "density_kgpm3"),
                           at(centre_m)));
  }
  scene.length_scale_m = edges_m.minCoeff();
  return scene;
}

}  // namespace

Scenario tower() {
  return {.name = "tower",
          .meaning =
              "A stack of single bricks: joint i carries the weight of all above it, so "
              "the forces are known exactly; a lean finds the tipping point.",
          .duration_s = 5.0,
          .parameters = joined(
              {{count_parameter("count", 10, 1, 1000, "bricks in the tower")},
               size_parameters("brick", {0.2, 0.1, 0.1}),
               {density_parameter(),
                number_parameter("offset_m", "m", 0.0, -10.0, 10.0,
                                 "each brick lies this much further along x than the one below"),
                number_parameter("gap_m", "m", 0.0, 0.0, 1.0,
                                 "open joint below each brick but "
                                 "the lowest")},
               contact_parameters(0.5, 0.0)}),
          .make = make};
}

}  // namespace brickbench
