#include "experiments/hunt/motion.hpp"

#include <fmt/format.h>

#include <exception>
#include <new>

#include "experiments/gate/recorder.hpp"

namespace brickbench::hunt {
namespace {

Expected<void> advance(Simulation& simulation, Motion& motion) {
  const std::size_t step = motion.steps() + 1;
  std::vector<Wrench> wrenches = gate::wrenches_at(motion.scene, motion.step_s, step);
  simulation.apply(wrenches);
  if (auto ok = simulation.step(); !ok) return ok;
  std::vector<State> states(motion.scene.world.bodies.size());
  simulation.read(states);
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (is_finite(states[i])) continue;
    return fail(Fault::diverged, fmt::format("body '{}' is not finite after step {}",
                                             motion.scene.world.bodies[i].name, step));
  }
  motion.wrenches.push_back(std::move(wrenches));
  motion.states.push_back(std::move(states));
  return {};
}

Expected<void> play(const Adapter& adapter, const Settings& settings, std::size_t steps,
                    Motion& motion) try {
  auto simulation = build(adapter, motion.scene.world, settings);
  if (!simulation) return tl::unexpected(simulation.error());
  std::vector<State> states(motion.scene.world.bodies.size());
  (*simulation)->read(states);
  motion.states.push_back(states);
  for (std::size_t step = 0; step < steps; ++step) {
    if (auto ok = advance(**simulation, motion); !ok) return ok;
  }
  return {};
} catch (const std::bad_alloc&) {
  return fail(Fault::out_of_memory, "the engine ran out of memory");
} catch (const std::exception& error) {
  return fail(Fault::crashed, fmt::format("an exception left the engine: {}", error.what()));
} catch (...) {
  return fail(Fault::crashed, "an exception of unknown type left the engine");
}

}  // namespace

Motion run_motion(const Adapter& adapter, const Settings& settings, const Scene& scene,
                  std::size_t steps) {
  Motion motion;
  motion.scene = scene;
  motion.step_s = settings.step_s;
  motion.single = variant_of(adapter, settings.variant).precision != "f64";
  if (adapter.scheme != nullptr) motion.scheme = adapter.scheme(settings);
  if (const auto ok = play(adapter, settings, steps, motion); !ok) {
    motion.outcome = to_outcome(ok.error().fault);
    motion.reason = ok.error().reason;
  }
  return motion;
}

std::uint64_t fingerprint(const Motion& motion) {
  std::uint64_t hash = 0;
  for (const auto& states : motion.states) hash = hash_states(states, hash);
  return hash;
}

}  // namespace brickbench::hunt
