#include "tests/unit/metrics/metric_runs.hpp"

#include <algorithm>
#include <stdexcept>

namespace brickbench::testing {

const MetricInfo& metric_named(const std::string& name) {
  static const std::vector<MetricInfo> all = metrics();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const auto& info) { return info.name == name; });
  if (found == all.end()) throw std::runtime_error("no metric " + name);
  return *found;
}

std::vector<Measurement> measure(const std::string& metric, const SyntheticRun& run) {
  const auto watcher = metric_named(metric).make(run.scene, run.step_s);
  for (std::size_t step = 0; step <= run.steps; ++step) {
    const std::vector<State> states = run.states(step);
    std::vector<Wrench> wrenches(states.size());
    if (run.wrenches && step > 0) wrenches = run.wrenches(step);
    std::vector<Contact> contacts;
    if (run.contacts && step > 0) contacts = run.contacts(step);
    watcher->observe({.step = step,
                      .time_s = run.step_s * static_cast<double>(step),
                      .states = states,
                      .wrenches = wrenches,
                      .contacts = run.contacts ? &contacts : nullptr,
                      .diagnostics = run.diagnostics});
  }
  std::vector<Measurement> out;
  watcher->report(out);
  return out;
}

const Measurement& find(const std::vector<Measurement>& all, const std::string& name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name == name; });
  if (found == all.end()) throw std::runtime_error("no measurement " + name);
  return *found;
}

double value(const std::vector<Measurement>& all, const std::string& name) {
  return find(all, name).value;
}

Body test_brick(const std::string& name, const Eigen::Vector3d& position_m,
                const Eigen::Vector3d& velocity_mps) {
  State state;
  state.position_m = position_m;
  state.velocity_mps = velocity_mps;
  return solid_body(name, BoxShape{{0.1, 0.05, 0.05}}, 1000.0, state);
}

Scene scene_of(std::vector<Body> bodies, const Eigen::Vector3d& gravity_mps2) {
  Scene scene;
  scene.world.gravity_mps2 = gravity_mps2;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i].fixed) scene.bricks.push_back(i);
  }
  scene.world.bodies = std::move(bodies);
  return scene;
}

std::vector<State> initial_states(const Scene& scene) {
  std::vector<State> states;
  for (const Body& body : scene.world.bodies) states.push_back(body.initial);
  return states;
}

SyntheticRun free_flight(double gravity_share) {
  Body light = test_brick("light", {0, 0, 10}, {3, 0, 4});
  light.initial.angular_velocity_radps = {5, 0, 0};
  Body heavy = test_brick("heavy", {1, 2, 10}, {0, -2, 1});
  heavy.mass_kg *= 3.0;
  heavy.inertia_kgm2 *= 3.0;
  heavy.initial.angular_velocity_radps = {0, 0, 7};
  SyntheticRun run{.scene = scene_of({light, heavy}, {0, 0, -9.81})};
  run.scene.projectiles = {0};
  run.states = [start = initial_states(run.scene), gravity_share,
                h = run.step_s](std::size_t step) {
    std::vector<State> states = start;
    const double t = h * static_cast<double>(step);
    const Eigen::Vector3d g = gravity_share * Eigen::Vector3d(0, 0, -9.81);
    for (State& state : states) {
      state.position_m += t * state.velocity_mps + 0.5 * t * t * g;
      state.velocity_mps += t * g;
      const double rate = state.angular_velocity_radps.norm();
      state.orientation = Eigen::AngleAxisd(rate * t, state.angular_velocity_radps / rate);
    }
    return states;
  };
  return run;
}

}  // namespace brickbench::testing
