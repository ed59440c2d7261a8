// The judge's own tools: audit, order fit, images of scenes, selection of cases.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "experiments/exact/cases/builders.hpp"
#include "experiments/exact/validation/audit.hpp"
#include "experiments/exact/validation/metamorphic.hpp"
#include "experiments/exact/validation/order.hpp"
#include "experiments/exact/validation/stable_step.hpp"
#include "experiments/step/stepper.hpp"
#include "tests/exact/random_parameters.hpp"
#include "tests/support/tolerance.hpp"

namespace brickbench::exact {
namespace {

using brickbench::testing::Tolerance;
using brickbench::testing::Worst;
using Eigen::Vector3d;

constexpr Tolerance k_back = {"state taken to the image and back", 1e-15, 7.5e-17,
                              "rounding of two rotations of coordinates of size ten"};

// An audit that holds exactly what the World says, to be spoiled.
class Honest final : public AuditView {
 public:
  explicit Honest(const World& world) : world_(world) {
    view.gravity_mps2 = world.gravity_mps2;
    for (const Body& body : world.bodies) {
      BodyAudit live;
      live.fixed = body.fixed;
      live.shape = body.shape;
      if (!body.fixed) {
        live.mass_kg = body.mass_kg;
        live.inertia_kgm2 = body.inertia_kgm2;
      }
      view.bodies.push_back(live);
    }
  }
  Audit audit() const override { return view; }
  ContactLaw pair_law(std::size_t a, std::size_t b) const override {
    ContactLaw law = contact_law(world_, a, b);
    law.friction += extra_friction;
    return law;
  }
  Audit view;
  double extra_friction = 0.0;

 private:
  World world_;
};

TEST(Audit, NamesEachFactThatDidNotArrive) {
  const World world = build(testing::find_case("friction.pull_apart")).value().world;
  EXPECT_TRUE(audit_differences(world, Honest(world)).empty());
  const auto spoiled = [&](auto edit) {
    Honest view(world);
    edit(view);
    return audit_differences(world, view).size();
  };
  EXPECT_EQ(spoiled([](Honest& h) { h.view.gravity_mps2 *= 1.0 + 1e-9; }), 1u);
  EXPECT_EQ(spoiled([](Honest& h) { h.view.bodies[1].mass_kg *= 1.0 + 1e-9; }), 1u);
  EXPECT_EQ(spoiled([](Honest& h) { h.view.bodies[1].inertia_kgm2.x() *= 1.0 + 1e-9; }), 1u);
  EXPECT_EQ(spoiled([](Honest& h) { h.view.bodies[2].linear_damping_hz = 1e-9; }), 1u);
  EXPECT_EQ(spoiled([](Honest& h) { h.view.bodies[2].can_sleep = true; }), 1u);
  EXPECT_EQ(spoiled([](Honest& h) { h.view.bodies[0].fixed = false; }), 1u);
  EXPECT_EQ(spoiled([](Honest& h) { h.view.bodies[2].shape = SphereShape{0.1}; }), 1u);
  EXPECT_EQ(spoiled([](Honest& h) { h.extra_friction = 1e-9; }), 3u) << "three pairs";
  EXPECT_EQ(spoiled([](Honest& h) { h.view.bodies.pop_back(); }), 1u);
}

TEST(OrderFit, FindsTheSlopeAndItsBand) {
  std::vector<LadderRung> ladder;
  for (const double h : {0.004, 0.002, 0.001, 0.0005}) ladder.push_back({h, 3.0 * h * h, 0.0});
  const OrderFit clean = fit_order(ladder);
  EXPECT_NEAR(clean.order, 2.0, 1e-12);
  EXPECT_LT(clean.half_width, 1e-6);
  ladder[1].error *= 1.3;
  ladder[2].error *= 0.8;
  const OrderFit noisy = fit_order(ladder);
  EXPECT_GT(noisy.half_width, 0.1);
  EXPECT_LT(std::abs(noisy.order - 2.0), noisy.half_width);
  ladder[3].error = 1e-15;
  EXPECT_TRUE(fit_order(ladder).at_rounding);
}

TEST(Images, AreTakenBackToTheScene) {
  Worst worst;
  const World world = build(testing::find_case("impact.corner")).value().world;
  for (const Symmetry& symmetry : symmetries()) {
    const World other = image(world, symmetry);
    ASSERT_TRUE(validate(other).has_value()) << symmetry.name;
    const State back = taken_back(other.bodies[1].initial, symmetry);
    const State& there = world.bodies[1].initial;
    worst.see((back.position_m - there.position_m).norm(), symmetry.name + " position");
    worst.see((back.velocity_mps - there.velocity_mps).norm(), symmetry.name + " velocity");
    worst.see(angle_between_rad(back.orientation, there.orientation), symmetry.name + " attitude");
  }
  EXPECT_TRUE(worst.within(k_back));
}

// A body keeps its height above a tilted plane, in units of the image.
TEST(Images, TakeTiltedPlanesAlong) {
  World world;
  State tilted;
  tilted.position_m = {1.0, 2.0, 0.5};
  tilted.orientation = Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Vector3d::UnitY()));
  world.bodies.push_back(fixed_body("slope", PlaneShape{}, tilted));
  State above = tilted;
  above.position_m += 0.3 * (tilted.orientation * Vector3d::UnitZ());
  world.bodies.push_back(solid_body("brick", BoxShape{{0.1, 0.05, 0.05}}, 2000.0, above));
  Worst worst;
  for (const Symmetry& symmetry : symmetries()) {
    const World other = image(world, symmetry);
    const State& plane = other.bodies[0].initial;
    const Vector3d up = plane.orientation * Vector3d::UnitZ();
    const double height_m = up.dot(other.bodies[1].initial.position_m - plane.position_m);
    worst.see(height_m / symmetry.length - 0.3, symmetry.name);
  }
  EXPECT_TRUE(worst.within(k_back));
}

// The truths themselves are invariant: kinetic energy scales with m l^2/t^2, gravity with l/t^2.
TEST(Images, ScaleEnergyAndGravity) {
  const World world = build(testing::find_case("conservation.elastic_heap")).value().world;
  const auto energy = [](const World& w) {
    std::vector<State> states;
    for (const Body& body : w.bodies) states.push_back(body.initial);
    return kinetic_energy_j(w, states);
  };
  for (const Symmetry& s : symmetries()) {
    const double factor = s.mass * s.length * s.length / (s.time * s.time);
    EXPECT_NEAR(energy(image(world, s)) / (factor * energy(world)), 1.0, 1e-13) << s.name;
    const World falling = build(testing::find_case("impact.flat_drop")).value().world;
    EXPECT_NEAR(image(falling, s).gravity_mps2.norm(),
                s.length / (s.time * s.time) * k_gravity_mps2, 1e-13)
        << s.name;
  }
}

// A force that lasts gives the image of the velocity and spin that it gives here.
TEST(Images, CarryForcesAlong) {
  constexpr double k_push_step_s = 0.25;
  State at;
  at.orientation = Eigen::Quaterniond(Eigen::AngleAxisd(0.8, Vector3d(1.0, 2.0, 3.0).normalized()));
  Scene scene;
  scene.world.bodies = {solid_body("ball", SphereShape{0.5}, 2.0, at)};
  scene.pushes = {{.body = 0,
                   .force_n = {1.0, 2.0, -3.0},
                   .torque_nm = {0.5, -0.25, 1.0},
                   .point_m = {0.3, -0.2, 0.1},
                   .times_s = {0.1, 0.6},
                   .shares = {1.0, 0.5}}};
  const auto gained = [](const Scene& of, double step_s) {
    const Body& body = of.world.bodies[0];
    std::vector<Wrench> wrenches(1);
    add_outer_wrenches(of, step_s, 1, std::vector<State>{body.initial}, wrenches);
    State state = body.initial;
    state.velocity_mps = step_s / body.mass_kg * wrenches[0].force_n;
    state.angular_velocity_radps = step_s / body.inertia_kgm2.x() * wrenches[0].torque_nm;
    return state;
  };
  const State here = gained(scene, k_push_step_s);
  EXPECT_GT(here.velocity_mps.norm(), 0.1);
  for (const Symmetry& s : symmetries()) {
    const State back = taken_back(gained(image(scene, s), s.time * k_push_step_s), s);
    EXPECT_NEAR((back.velocity_mps - here.velocity_mps).norm(), 0.0, 1e-14) << s.name;
    EXPECT_NEAR((back.angular_velocity_radps - here.angular_velocity_radps).norm(), 0.0, 1e-13)
        << s.name;
  }
}

TEST(Selection, KnowsAllFamiliesAndIds) {
  const auto cases = exact_cases();
  EXPECT_EQ(select_cases(cases, "all").size(), cases.size());
  EXPECT_EQ(select_cases(cases, "rolling.*").size(), 4u);
  EXPECT_EQ(select_cases(cases, "impact.cradle").size(), 1u);
  EXPECT_TRUE(select_cases(cases, "impact").empty());
}

// Keeps its bodies where they are with steps up to `limit_s`, and moves them by 1 m otherwise.
constexpr double k_limit_s = 0.0123;
class Holder final : public Simulation {
 public:
  Holder(const World& world, double step_s) : step_s_(step_s) {
    for (const Body& body : world.bodies) states_.push_back(body.initial);
  }
  void apply(std::span<const Wrench>) override {}
  Expected<void> step() override {
    if (step_s_ > k_limit_s) states_[0].position_m.x() += 1.0;
    return {};
  }
  void read(std::span<State> states) const override { std::ranges::copy(states_, states.begin()); }

 private:
  double step_s_ = 0.0;
  std::vector<State> states_;
};

// The bracket holds the limit and is as narrow as asked, from below and from above.
TEST(StableStep, BracketHoldsTheLimit) {
  Adapter adapter;
  adapter.name = "holder";
  adapter.variants = {{.name = "holder", .meaning = ""}};
  adapter.build = [](const World& world,
                     const Settings& settings) -> Expected<std::unique_ptr<Simulation>> {
    return std::make_unique<Holder>(world, settings.step_s);
  };
  Scene scene;
  World& world = scene.world;
  world.bodies.push_back(solid_body("brick", BoxShape{{0.1, 0.05, 0.05}}, 2000.0, State{}));
  StableStepSearch search;
  search.drift_limit_m = quarter_of_smallest_m(world);
  EXPECT_EQ(search.drift_limit_m, 0.025);
  Settings settings;
  settings.variant = "holder";
  for (const double first_s : {1e-3, 0.1}) {
    search.first_s = first_s;
    const StableStep found = largest_stable_step(adapter, settings, scene, search);
    EXPECT_EQ(found.outcome, "ok") << found.reason;
    EXPECT_LE(found.stable_s, k_limit_s);
    EXPECT_GT(found.unstable_s, k_limit_s);
    EXPECT_LE(found.unstable_s, 1.02 * found.stable_s);
    EXPECT_NE(found.failure.find("'brick' is 1 m"), std::string::npos) << found.failure;
  }
  world.bodies[0].initial.velocity_mps.x() = 1.0;
  EXPECT_NE(largest_stable_step(adapter, settings, scene, search).outcome, "ok");
  world.bodies[0].initial.velocity_mps.x() = 0.0;
  scene.blows.push_back({.body = 0, .impulse_ns = {1.0, 0.0, 0.0}});
  EXPECT_NE(largest_stable_step(adapter, settings, scene, search).outcome, "ok");
  scene.blows.clear();
  EXPECT_EQ(largest_stable_step(adapter, settings, scene, search).outcome, "ok");
  scene.pushes.push_back(
      {.body = 0, .force_n = {1.0, 0.0, 0.0}, .times_s = {0, 1}, .shares = {1, 1}});
  EXPECT_NE(largest_stable_step(adapter, settings, scene, search).outcome, "ok");
}

}  // namespace
}  // namespace brickbench::exact
