// The guard that build() puts around every engine.
#include "adapters/seam/guard.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>

namespace brickbench {
namespace {

enum class Where { nowhere, build, apply, step, read };
enum class What { message, memory, number };

struct Trouble {
  Where where = Where::nowhere;
  What what = What::message;
  bool own_state_view = false;
};

void throw_one(What what) {
  if (what == What::message) throw std::runtime_error("lost");
  if (what == What::memory) throw std::bad_alloc();
  throw 7;
}

// Bodies that fly straight on. The first step after the start or a set_state goes well.
class Flight final : public Simulation, StateView {
 public:
  Flight(const World& world, const Settings& settings, const Trouble& trouble, int& made)
      : step_s_(settings.step_s), trouble_(trouble) {
    if (trouble.where == Where::build) throw_one(trouble.what);
    for (const Body& body : world.bodies) states_.push_back(body.initial);
    ++made;
  }
  void apply(std::span<const Wrench>) override { befall(Where::apply); }
  Expected<void> step() override {
    befall(Where::step);
    ++steps_;
    for (State& state : states_) state.position_m += step_s_ * state.velocity_mps;
    return {};
  }
  void read(std::span<State> states) const override {
    befall(Where::read);
    std::ranges::copy(states_, states.begin());
  }
  StateView* state_view() override { return trouble_.own_state_view ? this : nullptr; }
  Expected<void> set_state(std::span<const State> states) override {
    states_.assign(states.begin(), states.end());
    steps_ = 0;
    return {};
  }

 private:
  void befall(Where where) const {
    if (steps_ > 0 && trouble_.where == where) throw_one(trouble_.what);
  }
  double step_s_;
  Trouble trouble_;
  std::vector<State> states_;
  int steps_ = 0;
};

struct Engine {
  Trouble trouble;
  int made = 0;  // simulations

  Adapter adapter() {
    return {.name = "flight",
            .version = "1",
            .variants = {{"plain", "none", "f64", {{"speed", 1.0}}}},
            .knobs = {{"speed", "1", 1.0, "none"}},
            .build = [this](const World& world,
                            const Settings& settings) -> Expected<std::unique_ptr<Simulation>> {
              return std::make_unique<Flight>(world, settings, trouble, made);
            }};
  }
};

World moving(double speed_mps) {
  World world;
  State state;
  state.velocity_mps.x() = speed_mps;
  world.bodies = {ground_plane(), solid_body("brick", BoxShape{{0.1, 0.1, 0.1}}, 1.0, state)};
  return world;
}

std::vector<State> states_of(const Simulation& simulation) {
  std::vector<State> states(2);
  simulation.read(states);
  return states;
}

TEST(Guard, LetsNoExceptionOut) {
  const std::vector<std::pair<What, Fault>> kinds = {{What::message, Fault::crashed},
                                                     {What::memory, Fault::out_of_memory},
                                                     {What::number, Fault::crashed}};
  for (const auto& [what, fault] : kinds) {
    for (const Where where : {Where::apply, Where::step, Where::read}) {
      Engine engine{{where, what}};
      auto simulation = build(engine.adapter(), moving(1.0), {.step_s = 0.1});
      ASSERT_TRUE(simulation);
      const std::vector<Wrench> none(2);
      (*simulation)->apply(none);
      // What reads badly after the first step has failed that step already.
      if (where != Where::read) {
        EXPECT_TRUE((*simulation)->step());
      }
      (*simulation)->apply(none);
      const auto second = (*simulation)->step();
      ASSERT_FALSE(second);
      EXPECT_EQ(second.error().fault, fault);
      const bool told = what != What::message || second.error().reason == "the engine threw: lost";
      EXPECT_TRUE(told) << second.error().reason;
    }
    Engine engine{{Where::build, what}};
    const auto simulation = build(engine.adapter(), moving(1.0), {});
    ASSERT_FALSE(simulation);
    EXPECT_EQ(simulation.error().fault, fault);
  }
}

TEST(Guard, FailsTheStepAfterWhichAStateIsNotFinite) {
  Engine engine;
  auto simulation = build(engine.adapter(), moving(1e308), {.step_s = 1.0});
  ASSERT_TRUE(simulation);
  EXPECT_TRUE((*simulation)->step());
  const auto second = (*simulation)->step();
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().fault, Fault::diverged);
  EXPECT_EQ(second.error().reason, "the state of body 'brick' is not finite");
}

TEST(Guard, SetsTheStateOfEveryEngineWithTheSameFuture) {
  for (const bool own : {false, true}) {
    Engine engine{{.own_state_view = own}};
    auto simulation = build(engine.adapter(), moving(1.0), {.step_s = 0.1});
    ASSERT_TRUE(simulation);
    std::vector<State> wanted = states_of(**simulation);
    ASSERT_TRUE((*simulation)->step());
    wanted[0].position_m.z() = 5.0;  // the ground keeps its place
    wanted[1].velocity_mps = {0.0, 2.0, 0.0};
    ASSERT_TRUE((*simulation)->state_view()->set_state(wanted));
    EXPECT_EQ(engine.made, own ? 1 : 2);
    EXPECT_EQ(states_of(**simulation)[0].position_m.z(), 0.0);
    EXPECT_EQ(states_of(**simulation)[1].velocity_mps.y(), 2.0);
    ASSERT_TRUE((*simulation)->step());
    EXPECT_EQ(states_of(**simulation)[1].position_m.y(), 0.2);
  }
}

TEST(Guard, RefusesStatesThatNoBodyHasAndKeepsItsOwn) {
  for (const bool own : {false, true}) {
    Engine engine{{.own_state_view = own}};
    auto simulation = build(engine.adapter(), moving(1.0), {.step_s = 0.1});
    ASSERT_TRUE(simulation);
    const std::vector<State> good = states_of(**simulation);
    for (const double bad : {std::nan(""), HUGE_VAL}) {
      std::vector<State> states = good;
      states[1].velocity_mps.x() = bad;
      EXPECT_FALSE((*simulation)->state_view()->set_state(states));
    }
    std::vector<State> long_turn = good;
    long_turn[1].orientation.w() = 1.1;
    EXPECT_FALSE((*simulation)->state_view()->set_state(long_turn));
    EXPECT_EQ(hash_states(states_of(**simulation)), hash_states(good));
  }
}

TEST(Settings, AreSettledWithTheKnobsOfTheirVariant) {
  Adapter adapter;
  adapter.name = "engine";
  adapter.knobs = {{"size", "1", 1.0, "none", 0.0, 9.0}, {"depth", "1", 2.0, "none", 0.0, 9.0}};
  adapter.variants = {{"a", "first", "f64", {{"size", 1.0}, {"depth", 2.0}}, 1},
                      {"b", "second", "f64", {{"size", 5.0}}, 4}};
  const Settings plain = settled(adapter, {});
  EXPECT_EQ(plain.variant, "a");
  EXPECT_EQ(knob(plain, "depth"), 2.0);
  const Settings turned = settled(adapter, {.variant = "b", .knobs = {{"size", 7.0}}});
  EXPECT_EQ(turned.knobs, (KnobValues{{"size", 7.0}}));
  EXPECT_EQ(settled(adapter, {.variant = "b"}).knobs, (KnobValues{{"size", 5.0}}));

  const auto refused = validate(adapter, {.variant = "b", .knobs = {{"depth", 1.0}}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().reason, "variant 'b' has no knob 'depth'; other variants do");
  EXPECT_TRUE(validate(adapter, {.variant = "b", .threads = 4}));
  for (const Settings& many : {Settings{.variant = "b", .threads = 5}, Settings{.threads = 2}}) {
    const auto threads = validate(adapter, many);
    ASSERT_FALSE(threads);
    EXPECT_EQ(threads.error().fault, Fault::unsupported);
  }
}

}  // namespace
}  // namespace brickbench
