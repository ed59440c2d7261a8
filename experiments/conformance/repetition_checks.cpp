// Rules about repeating a run, and about starting from a given state.
#include <fmt/core.h>

#include "experiments/conformance/check.hpp"

namespace brickbench::conformance {
namespace {

constexpr int k_steps = 120;

// A ball, or a small box, hits the upper of two stacked bricks; `friction` as given. Without floor
// and gravity where `flying`: for engines without contact.
World busy_world(double friction, bool flying, bool ball) {
  World world;
  world.law.friction = friction;
  const BoxShape half_brick{{0.1, 0.05, 0.05}};
  const double spread = flying ? 5.0 : 1.0;
  if (flying) world.gravity_mps2.setZero();
  if (!flying) world.bodies.push_back(fixed_body("floor", BoxShape{{5, 5, 1}}, at(0, 0, -1)));
  world.bodies.push_back(solid_body("lower", half_brick, 2000.0, at(0, 0, spread * 0.05)));
  world.bodies.push_back(solid_body("upper", half_brick, 2000.0, at(0.02, 0, spread * 0.15)));
  const Shape thrown = ball ? Shape{SphereShape{0.05}} : Shape{BoxShape{{0.05, 0.04, 0.03}}};
  world.bodies.push_back(solid_body("thrown", thrown, 4000.0, at(-0.3 * spread, 0, 0.17)));
  world.bodies.back().initial.velocity_mps = {5.0, 0.1, 0.0};
  world.bodies.back().initial.angular_velocity_radps = {1.0, 2.0, 3.0};
  return world;
}

// The busiest of these worlds that the engine can step.
World possible_world(const Subject& subject) {
  for (const bool ball : {true, false}) {
    for (const double friction : {0.5, 0.0}) {
      World world = busy_world(friction, false, ball);
      const auto simulation = subject.build(world, k_step_s);
      if (simulation && (*simulation)->step()) return world;
    }
  }
  return busy_world(0.0, true, false);
}

std::vector<std::uint64_t> hashes(const Subject& subject, const World& world) {
  std::vector<std::uint64_t> result;
  run(subject, world, k_step_s, k_steps, false,
      [&](int, const States& states) { result.push_back(hash_states(states)); });
  return result;
}

Verdict equal(const std::vector<std::uint64_t>& a, const std::vector<std::uint64_t>& b) {
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (a[k] != b[k]) return failed(fmt::format("the states differ from step {} on", k + 1));
  }
  return a.size() == b.size() && !a.empty() ? passed() : failed("runs of different length");
}

Verdict rebuilt_check(const Subject& subject) {
  return guarded([&] {
    const World world = possible_world(subject);
    return equal(hashes(subject, world), hashes(subject, world));
  });
}

Verdict interleaved_check(const Subject& subject) {
  return guarded([&] {
    const World world = possible_world(subject);
    const auto alone = hashes(subject, world);
    World other_world = world;
    other_world.bodies.back().initial.velocity_mps *= 0.7;
    const auto one = must_build(subject, world, k_step_s, false);
    const auto other = must_build(subject, other_world, k_step_s, false);
    std::vector<std::uint64_t> interleaved;
    for (int k = 0; k < k_steps; ++k) {
      interleaved.push_back(hash_states(step_and_read(*one, world, false)));
      step_and_read(*other, other_world, false);
    }
    return equal(alone, interleaved);
  });
}

constexpr Tolerance k_round_trip = {"state set and read", 2e-15, 1.35e-16,
                                    "relative to 1; one turn to the body frame and back"};

Verdict set_state_check(const Subject& subject) {
  return guarded([&] {
    World world = possible_world(subject);
    const auto simulation = must_build(subject, world, k_step_s, false);
    StateView* view = simulation->state_view();
    if (view == nullptr) return Verdict{Outcome::no_view, "no state view"};
    States states = read(*simulation, world);
    for (int k = 0; k < 30; ++k) states = step_and_read(*simulation, world, false);
    State& last = states.back();
    last.velocity_mps += Eigen::Vector3d(0.1, 0.2, 0.3);
    last.orientation =
        Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX())) * last.orientation;
    if (auto set = view->set_state(states); !set) return failed(set.error().reason);
    const States back = read(*simulation, world);
    Worst worst;
    for (std::size_t i = 0; i < back.size(); ++i) {
      const std::string where = fmt::format("body {}", i);
      worst.see((back[i].position_m - states[i].position_m).norm(), where);
      worst.see((back[i].orientation.coeffs() - states[i].orientation.coeffs()).norm(), where);
      worst.see((back[i].velocity_mps - states[i].velocity_mps).norm(), where);
      worst.see((back[i].angular_velocity_radps - states[i].angular_velocity_radps).norm() /
                    (1.0 + states[i].angular_velocity_radps.norm()),
                where);
    }
    return within(worst, k_round_trip);
  });
}

// The future depends on the states that were set alone: as if the world had been built with them.
Verdict set_state_forgets_check(const Subject& subject) {
  return guarded([&] {
    World world = possible_world(subject);
    const auto used = must_build(subject, world, k_step_s, false);
    StateView* view = used->state_view();
    if (view == nullptr) return Verdict{Outcome::no_view, "no state view"};
    for (int k = 0; k < 60; ++k) step_and_read(*used, world, false);
    for (Body& body : world.bodies) {
      if (!body.fixed) body.initial.velocity_mps += Eigen::Vector3d(0.01, 0.02, 0.0);
    }
    States states;
    for (const Body& body : world.bodies) states.push_back(body.initial);
    if (auto set = view->set_state(states); !set) return failed(set.error().reason);
    const auto fresh = must_build(subject, world, k_step_s, false);
    for (int k = 1; k <= k_steps; ++k) {
      const States a = step_and_read(*used, world, false);
      const States b = step_and_read(*fresh, world, false);
      if (hash_states(a) != hash_states(b)) {
        return failed(fmt::format("differs from a fresh simulation from step {} on", k));
      }
    }
    return passed();
  });
}

}  // namespace

std::vector<Check> repetition_checks() {
  return {
      {"rebuilt", "a rebuilt simulation repeats every bit", rebuilt_check},
      {"interleaved", "two simulations do not disturb each other", interleaved_check},
      {"set_state", "a state that is set is read back", set_state_check},
      {"set_state_forgets", "set-state forgets the past", set_state_forgets_check},
  };
}

}  // namespace brickbench::conformance
