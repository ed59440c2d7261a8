#include "experiments/gate/confusion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <vector>

#include "adapters/seam/shape.hpp"

namespace brickbench::gate {
namespace {

constexpr double k_moved_share = 0.2;  // of a brick's smallest edge

Expected<bool> has_moved(const World& world, std::span<const State> states) {
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!is_finite(states[i])) return fail(Fault::diverged, "a state is not finite");
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
                     std::size_t steps) try {
  const std::size_t pause = std::max<std::size_t>(1, steps / 20);
  auto simulation = build(adapter, world, settings);
  if (!simulation) return tl::unexpected(simulation.error());
  std::vector<State> states(world.bodies.size());
  for (std::size_t step = 1; step <= steps; ++step) {
    if (auto ok = (*simulation)->step(); !ok) return tl::unexpected(ok.error());
    if (step % pause != 0 && step != steps) continue;
    (*simulation)->read(states);
    const auto moved = has_moved(world, states);
    if (!moved || *moved) return moved;
  }
  return false;
} catch (const std::exception& error) {
  return fail(Fault::crashed, fmt::format("an exception left the engine: {}", error.what()));
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
