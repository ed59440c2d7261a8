// Stepper: the one way in which an engine is stepped. What acts from outside is applied, the step
// is timed, the states are read, and a failure says in which step it happened.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "adapters/seam/adapter.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/metrics/step_clock.hpp"
#include "experiments/scenarios/scenario.hpp"

namespace brickbench {

// Adds what acts on the bodies during step `step` (0-based), which starts at time_s, to `wrenches`
// (bodies), which are zero.
using Load = std::function<void(std::size_t step, double time_s, std::span<Wrench> wrenches)>;

// Adds what acts on the scene from outside during step `step` (0-based) of length step_s, which
// begins with these states (bodies), to `wrenches` (bodies). A blow is spread evenly over the step
// that contains its time; one at the instant between two steps belongs to the later one. A push is
// the mean of its course over the step.
void add_outer_wrenches(const Scene& scene, double step_s, std::size_t step,
                        std::span<const State> states, std::span<Wrench> wrenches);

class Stepper {
 public:
  // Builds the simulation. The world must outlive the stepper; an empty load is none. Fails as the
  // engine fails.
  static Expected<Stepper> start(const Adapter& adapter, const World& world,
                                 const Settings& settings, Load load = {});
  // The same with what acts on the scene, which must outlive the stepper.
  static Expected<Stepper> start(const Adapter& adapter, const Scene& scene,
                                 const Settings& settings);

  // One step. Fails as build() of the seam says of steps, with step and time in the reason.
  Expected<void> advance();
  // The next step is number `done` (0-based) and begins with these states (bodies). Fails as the
  // engine fails to take them.
  Expected<void> resume(std::span<const State> states, std::size_t done);

  std::size_t done() const { return done_; }  // steps
  double time_s() const { return static_cast<double>(done_) * step_s_; }
  std::span<const State> states() const { return states_; }
  std::span<const Wrench> wrenches() const { return wrenches_; }  // held during the last step
  // What there is to see after the last step: states and wrenches, and what the engine tells of
  // contacts (where wanted) and of itself. Valid until the next step.
  Sample sample(bool with_contacts = true);

  const Simulation& simulation() const { return *simulation_; }
  double build_cpu_s() const { return build_cpu_s_; }
  const StepClock& clock() const { return clock_; }

 private:
  Stepper(const World& world, const Settings& settings, Load load);

  const World* world_;
  const Scene* scene_ = nullptr;
  double step_s_;
  Load load_;
  std::unique_ptr<Simulation> simulation_;
  std::size_t done_ = 0;
  std::vector<State> states_;
  std::vector<Wrench> wrenches_;
  std::vector<Contact> contacts_;
  double build_cpu_s_ = 0.0;
  StepClock clock_;
};

}  // namespace brickbench
