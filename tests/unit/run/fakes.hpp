// A tiny world of scenarios, metrics and engines, right and wrong, to test the harness with.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "experiments/run/catalogues.hpp"

namespace brickbench::testing {

enum class Mishap { none, nan_at_7, throws_at_3, fails_at_2, not_an_exception };

// Bodies that fall freely, by symplectic Euler, until the fault strikes.
template <Mishap fault>
class FakeSimulation : public Simulation {
 public:
  FakeSimulation(const World& world, const Settings& settings)
      : world_(world), step_s_(settings.step_s), wrenches_(world.bodies.size()) {
    for (const Body& body : world.bodies) states_.push_back(body.initial);
  }
  void apply(std::span<const Wrench> wrenches) override {
    wrenches_.assign(wrenches.begin(), wrenches.end());
  }
  Expected<void> step() override {
    ++steps_;
    if (fault == Mishap::throws_at_3 && steps_ == 3)
      throw std::runtime_error("solver, \"lost\"\nit");
    if (fault == Mishap::not_an_exception && steps_ == 3) throw 7;
    if (fault == Mishap::fails_at_2 && steps_ == 2)
      return fail(Fault::crashed, "LCP error, s <= 0");
    for (std::size_t i = 0; i < states_.size(); ++i) {
      if (world_.bodies[i].fixed) continue;
      const Eigen::Vector3d push_mps2 = wrenches_[i].force_n / world_.bodies[i].mass_kg;
      states_[i].velocity_mps += step_s_ * (world_.gravity_mps2 + push_mps2);
      states_[i].position_m += step_s_ * states_[i].velocity_mps;
    }
    if (fault == Mishap::nan_at_7 && steps_ == 7) {
      states_.back().position_m.x() = std::numeric_limits<double>::quiet_NaN();
    }
    return {};
  }
  void read(std::span<State> states) const override { std::ranges::copy(states_, states.begin()); }

 private:
  World world_;
  double step_s_;
  std::vector<State> states_;
  std::vector<Wrench> wrenches_;
  int steps_ = 0;
};

template <Mishap fault>
Adapter fake_adapter(std::string name) {
  Adapter adapter;
  adapter.name = std::move(name);
  adapter.version = "1.0";
  adapter.variants = {{"plain", "the default", "f64", {{"iterations", 10.0}}},
                      {"fancy", "another one", "f32", {{"iterations", 10.0}}}};
  adapter.knobs = {{"iterations", "1", 10.0, "how often", 1.0, 1000.0, true}};
  adapter.build = [](const World& world,
                     const Settings& settings) -> Expected<std::unique_ptr<Simulation>> {
    return std::make_unique<FakeSimulation<fault>>(world, settings);
  };
  return adapter;
}

inline Adapter refusing_adapter() {
  Adapter adapter = fake_adapter<Mishap::none>("refuser");
  adapter.build = [](const World&, const Settings&) -> Expected<std::unique_ptr<Simulation>> {
    return fail(Fault::unsupported, "friction 0.5 must be 0");
  };
  return adapter;
}

inline Scenario fake_scenario() {
  Scenario scenario;
  scenario.name = "fall";
  scenario.meaning = "Balls that fall.";
  scenario.duration_s = 0.1;
  scenario.parameters = {
      {"balls", "1", ParameterKind::integer, 1.0, 1.0, 9.0, {}, "how many"},
      {"mass_kg", "kg", ParameterKind::number, 1.0, 1e-3, 1e3, {}, "of each ball"},
      {"push_ns", "N s", ParameterKind::number, 0.0, 0.0, 10.0, {}, "blow along x at 0.05 s"},
      {"kind", "1", ParameterKind::choice, std::string("sphere"), 0, 0, {"sphere", "box"}, "shape"},
      {"sticky", "1", ParameterKind::boolean, 0.0, 0.0, 1.0, {}, "no scene if true"}};
  scenario.make = [](const ParameterValues& values) -> Expected<Scene> {
    if (number(values, "sticky") != 0.0) return fail(Fault::invalid, "sticky balls make no scene");
    Scene scene;
    for (double i = 0; i < number(values, "balls"); ++i) {
      Body ball = solid_body("ball", SphereShape{0.1}, 1.0);
      ball.mass_kg = number(values, "mass_kg");
      ball.initial.position_m.x() = i;
      scene.bricks.push_back(scene.world.bodies.size());
      scene.world.bodies.push_back(ball);
    }
    const Eigen::Vector3d push_ns = {number(values, "push_ns"), 0.0, 0.0};
    if (push_ns.x() > 0.0) scene.blows.push_back({0, 0.05, push_ns, Eigen::Vector3d::Zero()});
    return scene;
  };
  return scenario;
}

// height_m: z of the first body; speed_mps: its speed along x; never: not applicable; forgotten:
// declared but not reported.
class FallMetric : public Metric {
 public:
  void observe(const Sample& sample) override { last_ = sample.states.front(); }
  void report(std::vector<Measurement>& out) const override {
    trace(out);
    out.push_back({"speed_mps", "m/s", last_.velocity_mps.x(), ""});
    out.push_back({"never", "1", std::nan(""), "not applicable: nothing here"});
  }
  void trace(std::vector<Measurement>& out) const override {
    out.push_back({"height_m", "m", last_.position_m.z(), "at the end"});
  }

 private:
  State last_;
};

inline MetricInfo fake_metric() {
  MetricInfo info;
  info.name = "fall";
  info.meaning = "How far.";
  info.outputs = {{"height_m", "m", Better::higher, "height", "high"},
                  {"speed_mps", "m/s", Better::neither, "speed", "any"},
                  {"never", "1", Better::lower, "nothing", "none"},
                  {"forgotten", "1", Better::lower, "nothing", "none"}};
  info.curves = {{"height_m", "m", Better::higher, "height", "high"}};
  info.make = [](const Scene&, double) -> std::unique_ptr<Metric> {
    return std::make_unique<FallMetric>();
  };
  return info;
}

inline Catalogues fake_catalogues() {
  return {.scenarios = {fake_scenario()},
          .metrics = {fake_metric()},
          .adapters = {fake_adapter<Mishap::none>("good"), fake_adapter<Mishap::nan_at_7>("nan"),
                       fake_adapter<Mishap::throws_at_3>("thrower"),
                       fake_adapter<Mishap::fails_at_2>("failer"),
                       fake_adapter<Mishap::not_an_exception>("odd"), refusing_adapter()},
          .known_engines = {"good", "nan", "thrower", "failer", "odd", "refuser", "absent"}};
}

}  // namespace brickbench::testing
