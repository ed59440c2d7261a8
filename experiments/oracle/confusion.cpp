#include "experiments/oracle/confusion.hpp"

#include <algorithm>
#include <vector>

#include "adapters/seam/shape.hpp"
#include "experiments/step/stepper.hpp"

namespace brickbench::gate {
namespace {

constexpr double k_moved_share = 0.2;  // of a brick's smallest edge

bool has_moved(const World& world, std::span<const State> states) {
  for (std::size_t i = 0; i < states.size(); ++i) {
    const Shape& shape = world.bodies[i].shape;
    if (is_round(shape)) continue;  // what is thrown at the bricks
    const double limit_m = k_moved_share * thickness_m(shape);
    const Eigen::Vector3d way = states[i].position_m - world.bodies[i].initial.position_m;
    if (way.norm() > limit_m) return true;
  }
  return false;
}

}  // namespace

Expected<bool> moves(const Adapter& adapter, const Settings& settings, const World& world,
                     std::size_t steps) {
  const std::size_t pause = std::max<std::size_t>(1, steps / 20);
  auto stepper = Stepper::start(adapter, world, settings);
  if (!stepper) return tl::unexpected(stepper.error());
  while (stepper->done() < steps) {
    if (auto ok = stepper->advance(); !ok) return tl::unexpected(ok.error());
    if (stepper->done() % pause != 0 && stepper->done() != steps) continue;
    if (has_moved(world, stepper->states())) return true;
  }
  return false;
}

Confusion confusion(const Adapter& adapter, const Settings& settings,
                    std::span<const LabelledAssembly> assemblies, std::size_t steps) {
  Confusion result;
  for (const LabelledAssembly& item : assemblies) {
    const auto moved = moves(adapter, settings, item.world, steps);
    if (!moved) {
      ++result.failed[std::string(to_outcome(moved.error().fault))];
      result.reason = moved.error().reason;
      continue;
    }
    const bool stands = item.verdict.label == StaticLabel::stands;
    ++(stands ? (*moved ? result.stands_moved : result.stands_stood)
              : (*moved ? result.falls_moved : result.falls_stood));
    if (stands != *moved) continue;
    ++result.wrong[(stands ? "stands but moved, " : "falls but stood, ") + item.family];
  }
  return result;
}

}  // namespace brickbench::gate
