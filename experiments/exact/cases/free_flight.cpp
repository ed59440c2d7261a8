// Bodies that touch nothing: parabolas and prescribed forces.
#include <cmath>

#include "experiments/exact/cases/builders.hpp"
#include "experiments/exact/cases/cases.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Vector3d;

constexpr std::size_t k_burst_steps = 10;
constexpr double k_side_m = 0.1;  // half edge of the bodies in free flight

ExactRun make_projectile(const ParameterValues& p) {
  ExactRun run = start_run(p);
  const Vector3d start(0.0, 0.0, 1.0);
  const Vector3d velocity(value_of(p, "speed_x_mps"), 0.0, value_of(p, "speed_z_mps"));
  run.world.bodies = {box("brick", Vector3d(0.1, 0.05, 0.03), 2.0, at(start, velocity))};
  const Vector3d g = run.world.gravity_mps2;
  run.trajectory = [=](double t, std::span<State> states) {
    states[0].position_m = start + velocity * t + 0.5 * t * t * g;
    states[0].velocity_mps = velocity + t * g;
  };
  const double energy = 0.5 * velocity.squaredNorm() + k_gravity_mps2 * start.z();
  run.measure = latest([](const Sample& s, std::span<double> v) {
    const State& brick = s.states[0];
    v[0] = brick.position_m.x();
    v[1] = brick.position_m.z();
    v[2] = brick.velocity_mps.z();
    v[3] = 0.5 * brick.velocity_mps.squaredNorm() + k_gravity_mps2 * brick.position_m.z();
  });
  const double t = static_cast<double>(run.steps) * run.step_s;
  const Vector3d end = start + velocity * t + 0.5 * t * t * g;
  const double length = velocity.norm() * t + 0.5 * k_gravity_mps2 * t * t;
  const double speed = velocity.norm() + k_gravity_mps2 * t;
  run.truths = {{end.x(), length},
                {end.z(), length},
                {velocity.z() + g.z() * t, speed},
                {energy, 0.5 * speed * speed}};
  return run;
}

ExactRun make_constant_force(const ParameterValues& p) {
  ExactRun run = start_run(p, false);
  const double mass = value_of(p, "mass_kg");
  const Vector3d force = value_of(p, "force_n") * Vector3d(1.0, -2.0, 2.0).normalized();
  run.world.bodies = {box("brick", Vector3d::Constant(k_side_m), mass, at(Vector3d::Zero()))};
  run.load = [=](std::size_t, double, std::span<Wrench> w) { w[0].force_n = force; };
  const Vector3d a = force / mass;
  run.trajectory = [=](double t, std::span<State> states) {
    states[0].position_m = 0.5 * t * t * a;
    states[0].velocity_mps = t * a;
  };
  const Vector3d direction = force.normalized();
  run.measure = latest([=](const Sample& s, std::span<double> v) {
    v[0] = direction.dot(s.states[0].velocity_mps);
    v[1] = direction.dot(s.states[0].position_m);
    v[2] = (s.states[0].position_m - v[1] * direction).norm();
  });
  const double t = static_cast<double>(run.steps) * run.step_s;
  const double length = 0.5 * a.norm() * t * t;
  run.truths = {{a.norm() * t, a.norm() * t}, {length, length}, {0.0, length}};
  return run;
}

// Eight bricks at the corners of a cube; equal and opposite radial forces act for burst_steps
// steps.
ExactRun make_explosion(const ParameterValues& p) {
  ExactRun run = start_run(p);
  const double force = value_of(p, "force_n");
  const double mass = value_of(p, "mass_kg");
  std::vector<Vector3d> outward;
  for (int i = 0; i < 8; ++i) {
    const Vector3d corner((i & 1) ? 1.0 : -1.0, (i & 2) ? 1.0 : -1.0, (i & 4) ? 1.0 : -1.0);
    outward.push_back(corner.normalized());
    run.world.bodies.push_back(
        box("brick " + std::to_string(i), Vector3d::Constant(0.04), mass, at(0.1 * corner)));
  }
  run.load = [=](std::size_t step, double, std::span<Wrench> w) {
    if (step >= k_burst_steps) return;
    for (std::size_t i = 0; i < 8; ++i) w[i].force_n = force * outward[i];
  };
  const World world = run.world;
  run.measure = latest([world, mass](const Sample& s, std::span<double> v) {
    Vector3d centre = Vector3d::Zero();
    for (const State& state : s.states) centre += state.position_m / 8.0;
    const Vector3d momentum = momentum_ns(world, s.states);
    v[0] = centre.z();
    v[1] = momentum.z();
    v[2] = momentum.head<2>().norm();
    v[3] = angular_momentum_nms(world, s.states).norm();
    // About the centre: as the difference of two energies it would drown in their rounding.
    std::vector<State> relative(s.states.begin(), s.states.end());
    for (State& state : relative) state.velocity_mps -= momentum / (8.0 * mass);
    v[4] = kinetic_energy_j(world, relative);
  });
  const double t = static_cast<double>(run.steps) * run.step_s;
  const double impulse = force * run.step_s * static_cast<double>(k_burst_steps);
  const double fall = 0.5 * k_gravity_mps2 * t * t;
  const double work = 8.0 * 0.5 * impulse * impulse / mass;
  run.truths = {{-fall, fall},
                {-8.0 * mass * k_gravity_mps2 * t, 8.0 * mass * k_gravity_mps2 * t},
                {0.0, 8.0 * impulse},
                {0.0, 8.0 * impulse * 0.2},
                {work, work}};
  return run;
}

std::string short_of_burst(const ParameterValues& p) {
  return step_count(p) < k_burst_steps ? "the run ends before the burst does" : "";
}

}  // namespace

ExactCase projectile() {
  return {.id = "free_flight.projectile",
          .title = "Projectile",
          .source = "Galilei, Discorsi (1638), fourth day",
          .claim = "A thrown brick follows a parabola; its energy does not change.",
          .formula = "x(t) = x0 + v0 t + g t^2/2",
          .needs = {},
          .parameters = with_time(
              {real("speed_x_mps", "m/s", 3.0, -50.0, 50.0, "horizontal speed at the start"),
               real("speed_z_mps", "m/s", 4.0, -50.0, 50.0, "upward speed at the start")},
              0.001, 1.0),
          .observables = {{"position_x_m", "m", "horizontal position at the end"},
                          {"position_z_m", "m", "height at the end"},
                          {"velocity_z_mps", "m/s", "vertical velocity at the end"},
                          {"specific_energy_j_per_kg", "J/kg", "v^2/2 + g z at the end"}},
          .make = make_projectile,
          .threshold = std::nullopt,
          .expected_violation = "semi-implicit Euler lags by g dt t/2, explicit Euler leads by it"};
}

ExactCase constant_force() {
  return {.id = "free_flight.constant_force",
          .title = "Constant force",
          .source = "Newton, Principia (1687), law II",
          .claim = "A force applied through the seam gives F t / m, along F and nowhere else.",
          .formula = "v = F t/m, x = F t^2/(2 m)",
          .needs = {.applied_forces = true},
          .parameters = with_time({real("force_n", "N", 6.0, 1e-3, 1e4, "size of the force"),
                                   real("mass_kg", "kg", 3.0, 1e-3, 1e4, "mass of the brick")},
                                  0.001, 1.0),
          .observables = {{"speed_mps", "m/s", "velocity along the force at the end"},
                          {"distance_m", "m", "way along the force"},
                          {"sideways_m", "m", "way across the force"}},
          .make = make_constant_force,
          .threshold = std::nullopt,
          .expected_violation = ""};
}

ExactCase explosion() {
  return {.id = "free_flight.explosion",
          .title = "Explosion in free flight",
          .source = "Goldstein, Classical Mechanics (1980), eq. 1-22 and 1-26",
          .claim =
              "Internal forces leave the centre of mass on its parabola and add exactly the "
              "kinetic energy J^2/(2m) per brick.",
          .formula = "z_cm = -g t^2/2, sum p = M g t, KE' = sum J^2/(2 m)",
          .needs = {.applied_forces = true},
          .parameters = with_time({real("force_n", "N", 400.0, 1.0, 1e5, "force on each brick"),
                                   real("mass_kg", "kg", 2.0, 0.01, 1e3, "mass of each brick")},
                                  0.001, 0.5),
          .observables = {{"centre_z_m", "m", "height of the centre of mass at the end"},
                          {"momentum_z_ns", "N s", "vertical momentum at the end"},
                          {"momentum_sideways_ns", "N s", "horizontal momentum at the end"},
                          {"angular_momentum_nms", "N m s", "about the origin, at the end"},
                          {"internal_energy_j", "J", "kinetic energy about the centre of mass"}},
          .make = make_explosion,
          .outside = short_of_burst,
          .threshold = std::nullopt,
          .expected_violation = ""};
}

}  // namespace brickbench::exact
