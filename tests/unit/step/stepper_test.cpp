// The one loop: blows act once and whole, what goes wrong in an engine becomes a value.
#include "experiments/step/stepper.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <stdexcept>

#include "tests/support/fake_engine.hpp"

namespace brickbench {
namespace {

using Eigen::Vector3d;
using testing::correct_fake;
using testing::Defect;

constexpr double k_step_s = 1.0 / 1024.0;

Scene two_bricks() {
  Scene scene;
  scene.world.gravity_mps2.setZero();
  for (const double x : {0.0, 10.0}) {
    State state;
    state.position_m.x() = x;
    scene.world.bodies.push_back(solid_body("brick", BoxShape{{0.1, 0.1, 0.1}}, 1000.0, state));
  }
  return scene;
}

Settings settings_of(const Adapter& adapter) {
  return {.step_s = k_step_s, .variant = adapter.variants.front().name, .knobs = {}};
}

// Whenever the blow falls, also at the border of two steps and in the first one: the brick moves
// from the step that contains it on, by the whole of the impulse; the other brick does not.
TEST(Stepper, AppliesEachBlowInTheStepThatContainsIt) {
  const Adapter adapter = correct_fake();
  for (const double steps : {0.0, 0.5, 1.0, 6.999999, 7.0, 7.0 + 1e-12, 7.0 - 1e-12}) {
    Scene scene = two_bricks();
    const Vector3d impulse(1.0, -2.0, 3.0), turn(0.0, 0.0, 0.01);
    scene.blows = {{.body = 1,
                    .time_s = steps * k_step_s,
                    .impulse_ns = impulse,
                    .angular_impulse_nms = turn}};
    auto stepper = Stepper::start(adapter, scene, settings_of(adapter));
    ASSERT_TRUE(stepper) << stepper.error().reason;
    const Body& body = scene.world.bodies[1];
    const auto expected_step = static_cast<std::size_t>(steps + 1e-9) + 1;
    while (stepper->done() < 10) {
      ASSERT_TRUE(stepper->advance());
      const bool after = stepper->done() >= expected_step;
      const State& struck = stepper->states()[1];
      EXPECT_NEAR((body.mass_kg * struck.velocity_mps - (after ? 1.0 : 0.0) * impulse).norm(), 0.0,
                  1e-12)
          << steps << " steps, after step " << stepper->done();
      EXPECT_EQ(struck.angular_velocity_radps.norm() > 0.0, after);
      EXPECT_EQ(stepper->states()[0].velocity_mps.norm(), 0.0);
      EXPECT_EQ(stepper->wrenches()[1].force_n.norm() > 0.0, stepper->done() == expected_step);
    }
  }
}

// Whatever its course and wherever its corners fall between steps, a force has given by the end
// what the course has below it: steps of any length give the same impulse.
TEST(Stepper, GivesAForceItsMeanOverEachStep) {
  const Adapter adapter = correct_fake();
  struct Course {
    std::vector<double> times_s;
    std::vector<double> shares;
    double integral_s;  // over 0 .. 0.1 s
  };
  const double inf = std::numeric_limits<double>::infinity();
  const Course courses[] = {{{0.0, inf}, {1.0, 1.0}, 0.1},
                            {{0.0173, 0.0631}, {1.0, 1.0}, 0.0458},
                            {{0.0, 0.05, 1e9}, {0.0, 1.0, 1.0}, 0.075},
                            {{0.013, 0.037, 0.037, 0.061}, {0.0, 2.0, -1.0, 0.0}, 0.012},
                            {{0.02, 0.02}, {1.0, 1.0}, 0.0},
                            {{0.5, 0.6}, {1.0, 1.0}, 0.0}};
  for (const Course& course : courses) {
    for (const double step_s : {0.001, 0.0025, 0.1}) {
      Scene scene = two_bricks();
      scene.pushes = {{.body = 1,
                       .force_n = {1.0, -2.0, 0.0},
                       .times_s = course.times_s,
                       .shares = course.shares}};
      Settings settings = settings_of(adapter);
      settings.step_s = step_s;
      auto stepper = Stepper::start(adapter, scene, settings).value();
      while (stepper.time_s() < 0.1 - 0.5 * step_s) ASSERT_TRUE(stepper.advance());
      const Vector3d momentum = scene.world.bodies[1].mass_kg * stepper.states()[1].velocity_mps;
      EXPECT_NEAR((momentum - course.integral_s * Vector3d(1.0, -2.0, 0.0)).norm(), 0.0, 1e-12)
          << course.times_s.front() << " s, step " << step_s;
      EXPECT_EQ(stepper.states()[0].velocity_mps.norm(), 0.0);
    }
  }
}

// A force at a point of the body has the lever arm of the attitude at the step's start.
TEST(OuterWrenches, TurnWithTheBody) {
  Scene scene = two_bricks();
  scene.pushes = {{.body = 1,
                   .force_n = {0.0, 3.0, 0.0},
                   .torque_nm = {0.5, 0.0, 0.0},
                   .point_m = {2.0, 0.0, 0.0},
                   .times_s = {0.0, 1.0},
                   .shares = {1.0, 1.0}}};
  std::vector<State> states(scene.world.bodies.size());
  std::vector<Wrench> wrenches(states.size());
  add_outer_wrenches(scene, 0.1, 3, states, wrenches);
  EXPECT_NEAR((wrenches[1].torque_nm - Vector3d(0.5, 0.0, 6.0)).norm(), 0.0, 1e-15);
  states[1].orientation = Eigen::AngleAxisd(std::numbers::pi / 2.0, Vector3d::UnitY());
  wrenches.assign(states.size(), Wrench{});
  add_outer_wrenches(scene, 0.1, 3, states, wrenches);
  EXPECT_NEAR((wrenches[1].torque_nm - Vector3d(6.5, 0.0, 0.0)).norm(), 0.0, 1e-14);
  EXPECT_EQ(wrenches[1].force_n, Vector3d(0.0, 3.0, 0.0));
  EXPECT_TRUE(wrenches[0].force_n.isZero());
}

TEST(Stepper, SaysWhenAndWhereAStateIsNotFinite) {
  const Adapter adapter = testing::fake_adapter(Defect::nan_at_step_7);
  const Scene scene = two_bricks();
  auto stepper = Stepper::start(adapter, scene.world, settings_of(adapter)).value();
  for (int step = 1; step < 7; ++step) ASSERT_TRUE(stepper.advance()) << step;
  const auto lost = stepper.advance();
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().fault, Fault::diverged);
  EXPECT_NE(lost.error().reason.find("'brick' is not finite"), std::string::npos)
      << lost.error().reason;
  EXPECT_TRUE(lost.error().reason.starts_with("step 7 (")) << lost.error().reason;
}

TEST(Stepper, TurnsWhatTheEngineThrowsIntoAValue) {
  const Adapter adapter = testing::fake_adapter(Defect::throws_at_step_5);
  const Scene scene = two_bricks();
  auto stepper = Stepper::start(adapter, scene.world, settings_of(adapter)).value();
  for (int step = 1; step < 5; ++step) ASSERT_TRUE(stepper.advance()) << step;
  const auto thrown = stepper.advance();
  ASSERT_FALSE(thrown);
  EXPECT_EQ(thrown.error().fault, Fault::crashed);
  EXPECT_NE(thrown.error().reason.find("step 5"), std::string::npos) << thrown.error().reason;
}

TEST(Stepper, PassesOnWhyNothingIsBuilt) {
  const Adapter adapter = testing::fake_adapter(Defect::refuses);
  const Scene scene = two_bricks();
  const auto stepper = Stepper::start(adapter, scene.world, settings_of(adapter));
  ASSERT_FALSE(stepper);
  EXPECT_EQ(stepper.error().fault, Fault::unsupported);
}

// Built and stepped at a stated price.
class Priced final : public Simulation, CostView {
 public:
  explicit Priced(std::unique_ptr<Simulation> inner) : inner_(std::move(inner)) {}
  void apply(std::span<const Wrench> wrenches) override { inner_->apply(wrenches); }
  Expected<void> step() override { return inner_->step(); }
  void read(std::span<State> states) const override { inner_->read(states); }
  const CostView* cost_view() const override { return this; }

 private:
  double build_cpu_s() const override { return 7.0; }
  double step_cpu_s() const override { return 2.0; }
  std::unique_ptr<Simulation> inner_;
};

// An engine that says what it took is billed that, and not what the way to it costs here.
TEST(Stepper, BillsWhatTheEngineSaysOfItsCost) {
  Adapter adapter = correct_fake();
  adapter.build = [inner = adapter.build](
                      const World& world,
                      const Settings& settings) -> Expected<std::unique_ptr<Simulation>> {
    return std::make_unique<Priced>(inner(world, settings).value());
  };
  const Scene scene = two_bricks();
  auto stepper = Stepper::start(adapter, scene.world, settings_of(adapter)).value();
  EXPECT_EQ(stepper.build_cpu_s(), 7.0);
  for (int step = 0; step < 5; ++step) ASSERT_TRUE(stepper.advance());
  EXPECT_EQ(stepper.clock().steps(), 5u);
  EXPECT_EQ(stepper.clock().total_s(), 10.0);
}

// Continued from given states at a given step: the load is that of the step, not of the count.
TEST(Stepper, ResumesFromStates) {
  const Adapter adapter = correct_fake();
  Scene scene = two_bricks();
  scene.blows = {{.body = 0, .time_s = 5.5 * k_step_s, .impulse_ns = {8.0, 0.0, 0.0}}};
  auto stepper = Stepper::start(adapter, scene, settings_of(adapter)).value();
  std::vector<State> states(stepper.states().begin(), stepper.states().end());
  states[0].position_m.x() = -3.0;
  ASSERT_TRUE(stepper.resume(states, 5));
  EXPECT_EQ(stepper.states()[0].position_m.x(), -3.0);
  ASSERT_TRUE(stepper.advance());
  EXPECT_EQ(stepper.done(), 6u);
  EXPECT_DOUBLE_EQ(stepper.time_s(), 6.0 * k_step_s);
  EXPECT_NEAR(stepper.states()[0].velocity_mps.x(), 1.0, 1e-12);
  EXPECT_NEAR(stepper.states()[0].position_m.x(), -3.0 + k_step_s, 1e-12);
  EXPECT_EQ(stepper.clock().steps(), 1u);
}

}  // namespace
}  // namespace brickbench
