#include "experiments/oracle/recorder.hpp"

#include "experiments/step/stepper.hpp"

namespace brickbench::gate {

Expected<Recording> record(const Adapter& adapter, const Settings& settings, const Scene& scene,
                           std::size_t steps) {
  auto stepper = Stepper::start(adapter, scene, settings);
  if (!stepper) return tl::unexpected(stepper.error());
  Recording recording;
  recording.step_s = settings.step_s;
  const auto states = [&] {
    return std::vector<State>(stepper->states().begin(), stepper->states().end());
  };
  recording.states.push_back(states());
  while (stepper->done() < steps) {
    if (auto ok = stepper->advance(); !ok) return tl::unexpected(ok.error());
    recording.wrenches.emplace_back(stepper->wrenches().begin(), stepper->wrenches().end());
    recording.states.push_back(states());
  }
  return recording;
}

}  // namespace brickbench::gate
