// A wall under its own weight: does it stand, and what creeps?
#include "experiments/scenarios/parts.hpp"
#include "experiments/scenarios/wall.hpp"

namespace brickbench {
namespace {

Expected<Scene> make(const ParameterValues& values) {
  const WallPlan plan = wall_plan(values);
  auto bricks = wall_bricks(plan);
  if (!bricks) return tl::unexpected(bricks.error());
  Scene scene;
  scene.world.law = contact_law(values);
  scene.world.bodies.push_back(ground_plane());
  for (Body& body : *bricks) add_brick(scene, std::move(body));
  scene.length_scale_m = plan.brick_m.minCoeff();
  return scene;
}

}  // namespace

Scenario standing_wall() {
  return {.name = "standing_wall",
          .meaning = "A dry wall that nothing hits. It must stand: every motion is the engine's.",
          .duration_s = 5.0,
          .parameters = joined({wall_parameters(5, 5), contact_parameters(0.5, 0.0)}),
          .make = make};
}

}  // namespace brickbench
