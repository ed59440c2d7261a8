#include "tests/hunt/spoiled_engine.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "adapters/seam/shape.hpp"
#include "tests/faults/seeded_faults.hpp"

namespace brickbench::testing {
namespace {

double reach_of(const Body& body) {
  return is_half_space(body.shape) ? 0.0 : bounding_radius_m(body.shape);
}

template <typename Edit>
void each_free(SpoiledStep& s, const Edit& edit) {
  for (std::size_t i = 0; i < s.world.bodies.size(); ++i) {
    if (!s.world.bodies[i].fixed) edit(i, s.after[i]);
  }
}

bool plastic_is_elastic_once(SpoiledStep& s) {
  if (s.world.law.restitution > 0.0 || s.memory > 0 || !s.is_hit()) return false;
  s.memory = 1;
  each_free(s, [&](std::size_t i, State& state) {
    state.velocity_mps += state.velocity_mps - s.before[i].velocity_mps;
  });
  return true;
}

bool restitution_adds_energy(SpoiledStep& s) {
  if (s.world.law.restitution == 0.0 || !s.is_hit()) return false;
  each_free(s, [](std::size_t, State& state) { state.velocity_mps *= 1.3; });
  return true;
}

bool falls_through_after_a_blow(SpoiledStep& s) {
  for (const Wrench& wrench : s.wrenches) {
    if (wrench.force_n.norm() > 0.0) s.memory = 1;
  }
  bool any = false;
  each_free(s, [&](std::size_t i, State& state) {
    const double reach_m = reach_of(s.world.bodies[i]);
    if (s.memory == 0 || !s.world.bodies.front().fixed || state.position_m.z() > reach_m) return;
    state.position_m.z() = -3.0 * reach_m;
    any = true;
  });
  return any;
}

// The solver yields NaN, and the state of before is kept as if nothing were.
bool nan_is_hidden(SpoiledStep& s) {
  if (s.is_hit()) s.memory = 1;
  if (s.memory == 0) return false;
  std::ranges::copy(s.before, s.after.begin());
  return true;
}

bool creeps(SpoiledStep& s) {
  bool any = false;
  each_free(s, [&](std::size_t i, State& state) {
    if (state.velocity_mps.norm() > 0.005 || s.struck_mps(i) == 0.0) return;
    state.velocity_mps.x() += 0.02;
    any = true;
  });
  return any;
}

bool light_bricks_explode(SpoiledStep& s) {
  bool any = false;
  each_free(s, [&](std::size_t i, State& state) {
    if (s.world.bodies[i].mass_kg > 0.6 || s.struck_mps(i) < 1e-6) return;
    state.velocity_mps *= 3.0;
    any = true;
  });
  return any;
}

bool passes_at_a_hit(SpoiledStep& s) {
  if (!s.is_hit() || s.world.bodies.size() != 2) return false;
  each_free(s, [&](std::size_t i, State& state) {
    const Eigen::Vector3d way = s.before[i].velocity_mps.normalized();
    state = s.before[i];
    state.position_m += 2.0 * (reach_of(s.world.bodies[0]) + reach_of(s.world.bodies[1])) * way;
  });
  return true;
}

bool leaks_momentum(SpoiledStep& s) {
  each_free(s, [](std::size_t, State& state) { state.velocity_mps *= 1.0 - 1e-6; });
  return true;
}

bool pulls_to_the_left(SpoiledStep& s) {
  if (!s.is_hit()) return false;
  each_free(s,
            [&](std::size_t i, State& state) { state.velocity_mps.y() -= 0.2 * s.struck_mps(i); });
  return true;
}

bool differs_from_run_to_run(SpoiledStep& s) {
  static int runs = 0;
  if (s.memory == 0) s.memory = ++runs;
  each_free(s, [&](std::size_t, State& state) { state.position_m.x() += 1e-13 * s.memory; });
  return true;
}

const std::array k_spoilings = {Spoiling{"plastic_is_elastic_once",
                                         "the first plastic hit bounces",
                                         plastic_is_elastic_once,
                                         {"impact"},
                                         {}},
                                Spoiling{"restitution_adds_energy",
                                         "a bounce comes back 1.3 times as fast",
                                         restitution_adds_energy,
                                         {"energy", "impact"},
                                         {}},
                                Spoiling{"falls_through_after_a_blow",
                                         "what a blow has hit falls through the ground",
                                         falls_through_after_a_blow,
                                         {"passage", "overlap"},
                                         {"explosion"}},
                                Spoiling{"nan_is_hidden",
                                         "from the first hit on the old state is told",
                                         nan_is_hidden,
                                         {"kinematics", "push"},
                                         {}},
                                Spoiling{"creeps",
                                         "what rests on the ground moves at 2 cm/s",
                                         creeps,
                                         {"friction"},
                                         {"brick_drop", "incline", "tower"}},
                                Spoiling{"light_bricks_explode",
                                         "bricks below 0.6 kg triple their speed at contacts",
                                         light_bricks_explode,
                                         {"energy", "impact"},
                                         {}},
                                Spoiling{"passes_at_a_hit",
                                         "a hit puts the bodies on the other side",
                                         passes_at_a_hit,
                                         {"passage", "kinematics"},
                                         {"two_bricks", "brick_drop"}},
                                Spoiling{"leaks_momentum",
                                         "a millionth of all velocities is lost in every step",
                                         leaks_momentum,
                                         {"momentum"},
                                         {"two_bricks", "free_brick", "assembly"}},
                                Spoiling{"pulls_to_the_left",
                                         "every hit gives a velocity along -y",
                                         pulls_to_the_left,
                                         {"momentum", "push", "image", "cone"},
                                         {"two_bricks", "brick_drop"}},
                                Spoiling{"differs_from_run_to_run",
                                         "every run starts a little elsewhere",
                                         differs_from_run_to_run,
                                         {"repetition"},
                                         {}}};

class SpoiledSimulation final : public Simulation {
 public:
  SpoiledSimulation(std::unique_ptr<Simulation> inner, const World& world, double step_s,
                    const Spoiling& spoiling)
      : inner_(std::move(inner)),
        world_(world),
        step_s_(step_s),
        spoiling_(spoiling),
        states_(world.bodies.size()),
        wrenches_(world.bodies.size()) {
    inner_->read(states_);
  }

  void apply(std::span<const Wrench> wrenches) override {
    wrenches_.assign(wrenches.begin(), wrenches.end());
    inner_->apply(wrenches);
  }

  Expected<void> step() override {
    const std::vector<State> before = states_;
    if (auto ok = inner_->step(); !ok) return ok;
    inner_->read(states_);
    SpoiledStep spoiled{world_, before, states_, wrenches_, step_s_, memory_};
    if (!spoiling_.spoil(spoiled)) return {};
    return inner_->state_view()->set_state(states_);
  }

  void read(std::span<State> states) const override { std::ranges::copy(states_, states.begin()); }

 private:
  std::unique_ptr<Simulation> inner_;
  World world_;
  double step_s_;
  const Spoiling& spoiling_;
  std::vector<State> states_;
  std::vector<Wrench> wrenches_;
  int memory_ = 0;
};

template <std::size_t index>
Expected<std::unique_ptr<Simulation>> build_spoiled(const World& world, const Settings& settings) {
  auto inner = build(correct_adapter(), world, settings);
  if (!inner) return inner;
  return std::make_unique<SpoiledSimulation>(std::move(*inner), world, settings.step_s,
                                             k_spoilings[index]);
}

using Build = Expected<std::unique_ptr<Simulation>> (*)(const World&, const Settings&);

template <std::size_t... index>
std::array<Build, sizeof...(index)> spoiled_builds(std::index_sequence<index...>) {
  return {&build_spoiled<index>...};
}

}  // namespace

double SpoiledStep::struck_mps(std::size_t i) const {
  if (world.bodies[i].fixed) return 0.0;
  return (after[i].velocity_mps - before[i].velocity_mps -
          step_s * (world.gravity_mps2 + wrenches[i].force_n / world.bodies[i].mass_kg))
      .norm();
}

bool SpoiledStep::is_hit() const {
  constexpr double k_least_mps = 0.5;
  const double fall_mps = 3.0 * step_s * world.gravity_mps2.norm();
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    if (struck_mps(i) > k_least_mps + fall_mps) return true;
  }
  return false;
}

std::span<const Spoiling> spoilings() { return k_spoilings; }

Adapter spoiled_adapter(std::size_t index) {
  static const auto builds = spoiled_builds(std::make_index_sequence<k_spoilings.size()>());
  Adapter adapter = correct_adapter();
  if (adapter.name.empty()) return adapter;
  adapter.name = k_spoilings[index].name;
  adapter.build = builds[index];
  return adapter;
}

}  // namespace brickbench::testing
