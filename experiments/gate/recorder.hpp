// Recorder: runs a scene in an engine and keeps every state, for oracles that look at steps in
// pairs.
#pragma once

#include <vector>

#include "adapters/seam/adapter.hpp"
#include "experiments/scenarios/scenario.hpp"

namespace brickbench::gate {

struct Recording {
  double step_s = 0.0;
  std::vector<std::vector<State>> states;     // (steps + 1, bodies)
  std::vector<std::vector<Wrench>> wrenches;  // (steps, bodies), held during the step
};

// What the blows of the scene apply during step number `step` (from 1), as a run of a cell does.
std::vector<Wrench> wrenches_at(const Scene& scene, double step_s, std::size_t step);

// Fails as the engine fails, or with Fault::diverged.
Expected<Recording> record(const Adapter& adapter, const Settings& settings, const Scene& scene,
                           std::size_t steps);

}  // namespace brickbench::gate
