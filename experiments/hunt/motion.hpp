// Motion: what an engine made of a trial, step by step, and what it said about it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adapters/seam/adapter.hpp"
#include "experiments/oracle/step_laws.hpp"
#include "experiments/scenarios/scenario.hpp"

namespace brickbench::hunt {

struct Motion {
  Scene scene;
  double step_s = 0.0;
  std::optional<Scheme> scheme;               // that the engine states
  bool single = false;                        // whether the engine counts in single precision
  std::vector<std::vector<State>> states;     // (steps done + 1, bodies), all finite
  std::vector<std::vector<Wrench>> wrenches;  // (steps done, bodies), held during the step
  std::string outcome = "ok";                 // or a word of to_outcome()
  std::string reason;
  // What the engine's own flags say first: that a step is not to be trusted, and which (from 1).
  std::optional<Flag> flag;
  std::size_t flagged_step = 0;

  std::size_t steps() const { return wrenches.size(); }
  // Step `step`, from 0.
  gate::StepRecord record(std::size_t step) const {
    return {states[step], states[step + 1], wrenches[step], step_s};
  }
};

// Runs the scene for `steps` steps, or until the engine fails or a state is not finite: the outcome
// says so, and what was recorded before stays.
Motion run_motion(const Adapter& adapter, const Settings& settings, const Scene& scene,
                  std::size_t steps);

// Hash of all states of all steps.
std::uint64_t fingerprint(const Motion& motion);

}  // namespace brickbench::hunt
