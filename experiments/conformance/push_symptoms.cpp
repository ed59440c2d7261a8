// Symptoms of forces and torques: what a push does to a body at rest.
#include <fmt/format.h>

#include <cmath>

#include "experiments/conformance/diagnosis.hpp"

namespace brickbench::conformance {
namespace {

using Eigen::Vector3d;

// A body that barely turns in a step; the inertia may be that of either end (motion_checks.cpp).
constexpr double k_push_tolerance = 1e-3;

struct Pushed {
  Vector3d first, second, again;  // change of velocity in the steps 1, 2 and 4
};

// At rest without gravity; the wrench acts in the steps 1 and 4.
Pushed push(const Subject& subject, const Wrench& wrench, bool angular) {
  World world;
  world.gravity_mps2.setZero();
  world.bodies.push_back(turned_box({0, 0, 0}));
  const auto simulation = must_build(subject, world, k_step_s, false);
  std::vector<Vector3d> seen = {Vector3d::Zero()};
  for (int step = 1; step <= 4; ++step) {
    const std::vector<Wrench> wrenches = {step == 1 || step == 4 ? wrench : Wrench{}};
    simulation->apply(wrenches);
    const State state = step_and_read(*simulation, world, false)[0];
    seen.push_back(angular ? state.angular_velocity_radps : state.velocity_mps);
  }
  return {seen[1] - seen[0], seen[2] - seen[1], seen[4] - seen[3]};
}

// When it acts; empty where it acts in its step and only there.
std::string time_symptom(const Pushed& pushed, double right, const char* what) {
  const auto acts = [&](const Vector3d& change) { return change.norm() > 1e-3 * right; };
  if (!acts(pushed.first) && acts(pushed.second)) {
    return fmt::format("applied {} act one step late", what);
  }
  if (!acts(pushed.first) && acts(pushed.again)) {
    return fmt::format("{} applied in the first step are lost", what);
  }
  if (!acts(pushed.first)) return fmt::format("applied {} do not act", what);
  if (acts(pushed.second)) return fmt::format("applied {} go on acting after their step", what);
  return {};
}

std::string force_symptom(const Subject& subject) {
  const Body body = turned_box({0, 0, 0});
  const Vector3d force_n(3, -5, 7);
  const Pushed pushed = push(subject, {.force_n = force_n, .torque_nm = {0, 0, 0}}, false);
  const Vector3d right = k_step_s / body.mass_kg * force_n;
  if (auto when = time_symptom(pushed, right.norm(), "forces"); !when.empty()) return when;
  const std::vector<Model<Vector3d>> models = {
      {"forces act with the wrong sign", -right},
      {"forces look body-framed; asked is the world frame", body.initial.orientation * right},
      {"forces look like impulses: they act without step_s", right / k_step_s}};
  const auto distance = [&](const Vector3d& a, const Vector3d& b) {
    return (a - b).norm() / b.norm();
  };
  const double factor = pushed.first.dot(right) / right.squaredNorm();
  const std::string otherwise =
      (pushed.first - factor * right).norm() < 1e-9 * right.norm()
          ? fmt::format(
                "mass looks {:.7g} times what it should be: forces do too little or too much",
                1.0 / factor)
          : "forces act in another direction than asked";
  return nearest_model(pushed.first, right, models, 1e-9, distance, otherwise);
}

std::string torque_symptom(const Subject& subject) {
  Body body = turned_box({0, 0, 0});
  const Vector3d torque_nm(0.2, 0.5, -0.3);
  const Pushed pushed = push(subject, {.force_n = {0, 0, 0}, .torque_nm = torque_nm}, true);
  const auto spin_of = [&](const Vector3d& moments, const Vector3d& torque) -> Vector3d {
    body.inertia_kgm2 = moments;
    return k_step_s * world_inertia_of(body, body.initial.orientation).inverse() * torque;
  };
  const Vector3d moments = body.inertia_kgm2;
  const Vector3d right = spin_of(moments, torque_nm);
  if (auto when = time_symptom(pushed, right.norm(), "torques"); !when.empty()) return when;
  const Vector3d of_body = body.initial.orientation * torque_nm;
  const std::vector<Model<Vector3d>> models = {
      {"torques act with the wrong sign", -right},
      {"torques look body-framed; asked is the world frame", spin_of(moments, of_body)},
      {"moments of inertia look in the order y, z, x; asked is x, y, z",
       spin_of({moments.y(), moments.z(), moments.x()}, torque_nm)},
      {"moments of inertia look in the order z, x, y; asked is x, y, z",
       spin_of({moments.z(), moments.x(), moments.y()}, torque_nm)},
      {"moments of inertia look in reversed order",
       spin_of({moments.z(), moments.y(), moments.x()}, torque_nm)},
      {"inertia looks like that of a ball: the same about all axes",
       spin_of(Vector3d::Constant(moments.mean()), torque_nm)},
      {"inertia looks as if it did not turn with the body",
       k_step_s * torque_nm.cwiseQuotient(moments)}};
  const auto distance = [](const Vector3d& a, const Vector3d& b) {
    return (a - b).norm() / b.norm();
  };
  const double factor = pushed.first.dot(right) / right.squaredNorm();
  const std::string otherwise =
      (pushed.first - factor * right).norm() < k_push_tolerance * right.norm()
          ? fmt::format("inertia looks {:.4g} times what it should be", 1.0 / factor)
          : "torques turn about another axis than asked";
  return nearest_model(pushed.first, right, models, k_push_tolerance, distance, otherwise);
}

// A torque-free body: how its spin changes in a step.
std::string gyroscopic_symptom(const Subject& subject) {
  World world;
  world.gravity_mps2.setZero();
  world.bodies.push_back(turned_box({0, 0, 0}));
  const Vector3d spin(0.3, -0.2, 0.8);
  world.bodies[0].initial.angular_velocity_radps = spin;
  const States states = run(subject, world, k_step_s, 1, false);
  const Eigen::Matrix3d inertia =
      world_inertia_of(world.bodies[0], world.bodies[0].initial.orientation);
  const Vector3d rate = -inertia.inverse() * spin.cross(inertia * spin);
  const Vector3d seen = (states[0].angular_velocity_radps - spin) / k_step_s;
  const auto distance = [&](const Vector3d& a, const Vector3d& b) {
    return (a - b).norm() / rate.norm();
  };
  constexpr double first_order = 0.02;  // schemes differ from each other by O(h)
  return nearest_model(seen, rate,
                       {{"the gyroscopic torque is missing", Vector3d::Zero()},
                        {"the gyroscopic torque has the wrong sign", -rate}},
                       first_order, distance, "free bodies do not follow Euler's equations");
}

}  // namespace

Symptoms push_symptoms(const Subject& subject) {
  Symptoms symptoms;
  for (const std::string& words : {force_symptom(subject), torque_symptom(subject)}) {
    if (!words.empty()) symptoms.push_back(words);
  }
  if (!symptoms.empty()) return symptoms;
  if (auto words = gyroscopic_symptom(subject); !words.empty()) symptoms.push_back(words);
  return symptoms;
}

}  // namespace brickbench::conformance
