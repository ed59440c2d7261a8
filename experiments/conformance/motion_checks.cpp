// Rules about bodies that touch nothing.
#include <fmt/core.h>

#include <cmath>

#include "experiments/conformance/check.hpp"

namespace brickbench::conformance {
namespace {

// A box with three different moments of inertia, turned away from all axes.
Body odd_box(const Eigen::Vector3d& position_m) {
  State state;
  state.position_m = position_m;
  state.orientation =
      Eigen::Quaterniond(Eigen::AngleAxisd(0.9, Eigen::Vector3d(1, 2, 3).normalized()));
  return solid_body("odd box", BoxShape{{0.15, 0.1, 0.05}}, 2000.0, state);
}

World weightless() {
  World world;
  world.gravity_mps2.setZero();
  return world;
}

Eigen::Matrix3d world_inertia_kgm2(const Body& body, const Eigen::Quaterniond& orientation) {
  const Eigen::Matrix3d turn = orientation.toRotationMatrix();
  return turn * body.inertia_kgm2.asDiagonal() * turn.transpose();
}

constexpr Tolerance k_read_back = {"read back", 1e-15, 6.4e-17,
                                   "relative; one turn to the body frame and back"};

Verdict initial_state_check(const Subject& subject) {
  return guarded([&] {
    World world = weightless();
    world.bodies.push_back(odd_box({1, 2, 3}));
    world.bodies[0].initial.velocity_mps = {0.3, -0.4, 0.5};
    world.bodies[0].initial.angular_velocity_radps = {0.7, -1.1, 1.9};
    const auto simulation = must_build(subject, world, k_step_s, false);
    const State state = read(*simulation, world)[0];
    const State& wanted = world.bodies[0].initial;
    Worst worst;
    worst.see((state.position_m - wanted.position_m).norm(), "position");
    worst.see((state.orientation.coeffs() - wanted.orientation.coeffs()).norm(), "orientation");
    worst.see((state.velocity_mps - wanted.velocity_mps).norm(), "velocity");
    worst.see((state.angular_velocity_radps - wanted.angular_velocity_radps).norm(), "spin");
    return within(worst, k_read_back);
  });
}

constexpr Tolerance k_turn = {"turn of one step", 1e-3, 1.65e-4,
                              "of the spin; the spin itself changes by O(h) within the step"};

Verdict spin_frame_check(const Subject& subject) {
  return guarded([&] {
    World world = weightless();
    world.bodies.push_back(odd_box({0, 0, 0}));
    const Eigen::Vector3d spin(0.3, -0.2, 0.8);
    world.bodies[0].initial.angular_velocity_radps = spin;
    const States states = run(subject, world, k_step_s, 1, false);
    const Eigen::Quaterniond& before = world.bodies[0].initial.orientation;
    const Eigen::AngleAxisd turn(states[0].orientation * before.conjugate());
    const Eigen::Vector3d turned = turn.angle() * turn.axis() / k_step_s;
    Worst worst;
    worst.see((turned - spin).norm() / spin.norm(), "turn about the world axes");
    return within(worst, k_turn);
  });
}

constexpr Tolerance k_gyroscopic = {"gyroscopic change of spin", 5e-3, 2.2e-3,
                                    "of the change; the schemes differ from each other by O(h)"};

Verdict gyroscopic_check(const Subject& subject) {
  return guarded([&] {
    World world = weightless();
    world.bodies.push_back(odd_box({0, 0, 0}));
    const Body& body = world.bodies[0];
    const Eigen::Vector3d spin(0.3, -0.2, 0.8);
    world.bodies[0].initial.angular_velocity_radps = spin;
    const States states = run(subject, world, k_step_s, 1, false);
    const Eigen::Matrix3d inertia = world_inertia_kgm2(body, body.initial.orientation);
    const Eigen::Vector3d rate = -inertia.inverse() * spin.cross(inertia * spin);
    const Eigen::Vector3d change = (states[0].angular_velocity_radps - spin) / k_step_s;
    Worst worst;
    worst.see((change - rate).norm() / rate.norm(), "Euler's equations, first step");
    return within(worst, k_gyroscopic);
  });
}

constexpr Tolerance k_linear_response = {"impulse response", 3e-15, 1.6e-16, "relative; rounding"};
constexpr Tolerance k_angular_response = {
    "angular impulse response", 2e-5, 1.23e-6,
    "relative; the inertia may be that of either end of the step"};

// From rest: dv = F h / m, dw = I^-1 tau h. Then nothing: the wrench is forgotten.
Verdict wrench_check(const Subject& subject, bool angular) {
  return guarded([&] {
    World world = weightless();
    world.bodies.push_back(odd_box({0, 0, 0}));
    world.bodies.push_back(odd_box({5, 0, 0}));
    world.bodies[1].mass_kg *= 7.0;
    world.bodies[1].inertia_kgm2 *= 5.0;
    const auto simulation = must_build(subject, world, k_step_s, false);
    std::vector<Wrench> wrenches(2);
    for (std::size_t i = 0; i < 2; ++i) {
      const double sign = i == 0 ? 1.0 : -1.0;
      wrenches[i] = {sign * Eigen::Vector3d(3, -5, 7), sign * Eigen::Vector3d(0.2, 0.5, -0.3)};
    }
    simulation->apply(wrenches);
    const States first = step_and_read(*simulation, world, false);
    const States second = step_and_read(*simulation, world, false);
    Worst worst;
    for (std::size_t i = 0; i < 2; ++i) {
      const Body& body = world.bodies[i];
      if (angular) {
        const Eigen::Vector3d wanted =
            k_step_s * world_inertia_kgm2(body, body.initial.orientation).inverse() *
            wrenches[i].torque_nm;
        const auto see = [&](const States& states, const char* when) {
          worst.see((states[i].angular_velocity_radps - wanted).norm() / wanted.norm(),
                    fmt::format("body {} after the {} step", i, when));
        };
        see(first, "first");
        see(second, "second");
      } else {
        const Eigen::Vector3d wanted = k_step_s * wrenches[i].force_n / body.mass_kg;
        worst.see((first[i].velocity_mps - wanted).norm() / wanted.norm(),
                  fmt::format("body {} after the first step", i));
        worst.see((second[i].velocity_mps - wanted).norm() / wanted.norm(),
                  fmt::format("body {} after the second step: the force must be gone", i));
      }
    }
    return within(worst, angular ? k_angular_response : k_linear_response);
  });
}

Verdict force_check(const Subject& subject) { return wrench_check(subject, false); }
Verdict torque_check(const Subject& subject) { return wrench_check(subject, true); }

constexpr Tolerance k_straight_flight = {"straight flight", 3e-13, 1.52e-14,
                                         "m; 10 additions of rounding at 30 m"};

// Bodies all different, fixed ones in between: each goes where its own velocity takes it.
Verdict body_order_check(const Subject& subject) {
  return guarded([&] {
    World world = weightless();
    for (int i = 0; i < 7; ++i) {
      State state;
      state.position_m = {5.0 * i, 1.0 * i, -2.0 * i};
      const Shape shape = i % 2 == 0 ? Shape{BoxShape{{0.1 + 0.01 * i, 0.2, 0.3}}}
                                     : Shape{SphereShape{0.1 + 0.01 * i}};
      const bool fixed = i == 0 || i == 3 || i == 4;
      if (!fixed) state.velocity_mps = {0.1 * i, 1.0 - i, 0.5};
      world.bodies.push_back(fixed ? fixed_body("fixed", shape, state)
                                   : solid_body("moving", shape, 1000.0 + 100.0 * i, state));
    }
    const int steps = 10;
    const States states = run(subject, world, k_step_s, steps, false);
    Worst worst;
    for (std::size_t i = 0; i < states.size(); ++i) {
      const State& start = world.bodies[i].initial;
      const Eigen::Vector3d wanted = start.position_m + steps * k_step_s * start.velocity_mps;
      worst.see((states[i].position_m - wanted).norm(), fmt::format("body {}", i));
      worst.see((states[i].velocity_mps - start.velocity_mps).norm(), fmt::format("v of {}", i));
    }
    return within(worst, k_straight_flight);
  });
}

constexpr Tolerance k_step_length = {"velocity of free fall", 3e-13, 1.68e-14,
                                     "relative; rounding of up to 1000 additions"};

Verdict step_length_check(const Subject& subject) {
  return guarded([&] {
    World world;
    world.gravity_mps2 = {0.3, -0.2, -9.81};
    world.bodies.push_back(odd_box({0, 0, 100}));
    Worst worst;
    for (const double step_s : {0.001, 0.00137, 1.0 / 240.0}) {
      run(subject, world, step_s, 1000, false, [&](int k, const States& states) {
        const Eigen::Vector3d wanted = k * step_s * world.gravity_mps2;
        worst.see((states[0].velocity_mps - wanted).norm() / wanted.norm(),
                  fmt::format("step {} of {} s", k, step_s));
      });
    }
    return within(worst, k_step_length);
  });
}

constexpr Tolerance k_fall = {"free fall of 1 s", 4.906e-3, 4.905e-3,
                              "m; g h t / 2, the error of a first-order scheme at 1/1000 s"};

Verdict free_fall_check(const Subject& subject) {
  return guarded([&] {
    World world;
    world.bodies.push_back(odd_box({0, 0, 100}));
    const States states = run(subject, world, k_step_s, 1000, false);
    Worst worst;
    worst.see(states[0].position_m.z() - (100.0 - 0.5 * 9.81), "height after 1 s");
    return within(worst, k_fall);
  });
}

}  // namespace

std::vector<Check> motion_checks() {
  return {
      {"initial_state", "the state before any step is that of the World", initial_state_check},
      {"spin_frame", "angular velocity is in the world frame", spin_frame_check},
      {"gyroscopic", "a torque-free body follows Euler's equations", gyroscopic_check},
      {"force", "a force acts in the world frame, on the mass, for one step", force_check},
      {"torque", "a torque acts in the world frame, on the inertia, for one step", torque_check},
      {"body_order", "states come in the order of World::bodies", body_order_check},
      {"step_length", "a step is exactly step_s long", step_length_check},
      {"free_fall", "lengths and times are metres and seconds", free_fall_check},
  };
}

}  // namespace brickbench::conformance
