// Synthetic runs: trajectories known in closed form, fed to a metric as an engine would.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/metrics/metric.hpp"

namespace brickbench::testing {

// States of all bodies after `step` steps.
using Trajectory = std::function<std::vector<State>(std::size_t step)>;

struct SyntheticRun {
  Scene scene;
  double step_s = 0.001;
  std::size_t steps = 100;
  Trajectory states = {};
  std::function<std::vector<Wrench>(std::size_t step)> wrenches = {};
  std::function<std::vector<Contact>(std::size_t step)> contacts = {};  // empty: not told
  std::vector<Diagnostic> diagnostics = {};
};

const MetricInfo& metric_named(const std::string& name);
// What the named metric reports after the whole run.
std::vector<Measurement> measure(const std::string& metric, const SyntheticRun& run);
const Measurement& find(const std::vector<Measurement>& all, const std::string& name);
double value(const std::vector<Measurement>& all, const std::string& name);

// Brick of 2 kg with edges 0.2, 0.1, 0.1 m.
Body test_brick(const std::string& name, const Eigen::Vector3d& position_m = {0, 0, 0},
                const Eigen::Vector3d& velocity_mps = {0, 0, 0});
Scene scene_of(std::vector<Body> bodies, const Eigen::Vector3d& gravity_mps2);
std::vector<State> initial_states(const Scene& scene);

// Two unequal bricks thrown up, spinning; exact parabolas. `gravity_share` other than 1 is a wrong
// engine.
SyntheticRun free_flight(double gravity_share = 1.0);

}  // namespace brickbench::testing
