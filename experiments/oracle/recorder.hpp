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

// With the blows of the scene, as a run of a cell. Fails as Stepper does.
Expected<Recording> record(const Adapter& adapter, const Settings& settings, const Scene& scene,
                           std::size_t steps);

}  // namespace brickbench::gate
