#include "experiments/gate/recorder.hpp"

#include <fmt/format.h>

#include <cmath>
#include <exception>

namespace brickbench::gate {

std::vector<Wrench> wrenches_at(const Scene& scene, double step_s, std::size_t step) {
  constexpr double rounding = 1e-9;  // of a step: a blow at a step's border belongs to the next one
  std::vector<Wrench> wrenches(scene.world.bodies.size());
  for (const Blow& blow : scene.blows) {
    if (std::floor(blow.time_s / step_s + rounding) + 1.0 != static_cast<double>(step)) continue;
    wrenches[blow.body].force_n += blow.impulse_ns / step_s;
    wrenches[blow.body].torque_nm += blow.angular_impulse_nms / step_s;
  }
  return wrenches;
}

Expected<Recording> record(const Adapter& adapter, const Settings& settings, const Scene& scene,
                           std::size_t steps) try {
  auto simulation = build(adapter, scene.world, settings);
  if (!simulation) return tl::unexpected(simulation.error());
  Recording recording;
  recording.step_s = settings.step_s;
  std::vector<State> states(scene.world.bodies.size());
  (*simulation)->read(states);
  recording.states.push_back(states);
  for (std::size_t step = 1; step <= steps; ++step) {
    recording.wrenches.push_back(wrenches_at(scene, settings.step_s, step));
    (*simulation)->apply(recording.wrenches.back());
    if (auto ok = (*simulation)->step(); !ok) return tl::unexpected(ok.error());
    (*simulation)->read(states);
    for (std::size_t i = 0; i < states.size(); ++i) {
      if (is_finite(states[i])) continue;
      return fail(Fault::diverged, fmt::format("body '{}' is not finite after step {}",
                                               scene.world.bodies[i].name, step));
    }
    recording.states.push_back(states);
  }
  return recording;
} catch (const std::exception& error) {
  return fail(Fault::crashed, fmt::format("an exception left the engine: {}", error.what()));
}

}  // namespace brickbench::gate
