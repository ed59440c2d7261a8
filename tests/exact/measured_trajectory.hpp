// What the exact trajectory of a case would measure.
#pragma once

#include "experiments/exact/cases/exact_case.hpp"

namespace brickbench::exact::testing {

// The observables of the exact trajectory sampled at the steps; empty if the case has none.
inline std::vector<double> measured_trajectory(const ExactRun& run, std::size_t observables) {
  if (!run.trajectory) return {};
  Recorder recorder(run, observables);
  std::vector<State> states(run.world.bodies.size());
  std::vector<Wrench> wrenches(states.size());
  for (std::size_t step = 0; step <= run.steps; ++step) {
    const double time_s = static_cast<double>(step) * run.step_s;
    for (std::size_t i = 0; i < states.size(); ++i) states[i] = run.world.bodies[i].initial;
    run.trajectory(time_s, states);
    recorder.see({.step = step,
                  .time_s = time_s,
                  .states = states,
                  .wrenches = wrenches,
                  .contacts = nullptr,
                  .diagnostics = {}});
  }
  return recorder.values();
}

}  // namespace brickbench::exact::testing
