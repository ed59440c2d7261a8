// What may not grow or change, however complicated the motion: momentum, energy.
#include <algorithm>
#include <cmath>
#include <random>

#include "experiments/exact/cases/builders.hpp"
#include "experiments/exact/cases/cases.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

template <typename Unit>
Quaterniond random_turn(const Unit& unit) {
  const double w = unit(), x = unit(), y = unit(), z = unit();
  return Quaterniond(w, x, y, z).normalized();
}

template <typename Unit>
Vector3d random_vector(const Unit& unit) {
  const double x = unit(), y = unit(), z = unit();
  return {x, y, z};
}

// Eight frictionless bricks fly at each other without gravity.
ExactRun make_heap(const ParameterValues& p) {
  ExactRun run = start_run(p, false);
  run.world.law = {.friction = 0.0, .restitution = value_of(p, "restitution")};
  const double speed = value_of(p, "speed_mps");
  // A fixed seed of a generator whose sequence the standard prescribes: the same scene everywhere.
  std::mt19937_64 generator(20131);
  const auto unit = [&] { return static_cast<double>(generator() >> 11) * 0x1p-52 - 1.0; };
  for (int i = 0; i < 8; ++i) {
    const Vector3d corner((i & 1) ? 1.0 : -1.0, (i & 2) ? 1.0 : -1.0, (i & 4) ? 1.0 : -1.0);
    const Vector3d jitter = random_vector(unit);
    State state = at(0.25 * corner + 0.03 * jitter, -speed * (corner + 0.2 * jitter) / 2.0,
                     random_vector(unit));
    state.orientation = random_turn(unit);
    run.world.bodies.push_back(
        box("brick " + std::to_string(i), Vector3d(0.08, 0.06, 0.05), 1.0, state));
  }
  std::vector<State> start;
  for (const Body& body : run.world.bodies) start.push_back(body.initial);
  const World world = run.world;
  const double energy = kinetic_energy_j(world, start);
  const Vector3d momentum = momentum_ns(world, start), angular = angular_momentum_nms(world, start);
  // Errors of the momenta, the final energy, and the largest gain of energy in one step.
  run.measure = [=, last = energy](const Sample& s, std::span<double> v) mutable {
    const double now = kinetic_energy_j(world, s.states);
    if (s.step == 0) v[2] = 0.0;
    v[0] = (momentum_ns(world, s.states) - momentum).norm();
    v[1] = (angular_momentum_nms(world, s.states) - angular).norm();
    v[2] = std::max(v[2], now - last);
    if (v.size() > 3) v[3] = now;
    last = now;
  };
  const double scale = 8.0 * speed;
  run.truths = {{0.0, scale}, {0.0, scale * 0.3}, {0.0, energy}};
  if (value_of(p, "restitution") == 1.0) run.truths.push_back({energy, energy});
  return run;
}

// A thin plate slides on its lower edge, leaning forward, with much friction.
ExactRun make_painleve(const ParameterValues& p) {
  ExactRun run = start_run(p);
  const double angle = value_of(p, "angle_rad"), speed = value_of(p, "speed_mps");
  const Vector3d half(0.5, 0.1, 0.01);
  run.world.law = {.friction = value_of(p, "friction"), .restitution = 0.0};
  State state =
      at({0.0, 0.0, half.x() * std::sin(angle) + half.z() * std::cos(angle)}, {-speed, 0.0, 0.0});
  state.orientation = Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
  run.world.bodies = {floor_slab(), box("plate", half, 1.0, state)};
  const World world = run.world;
  const auto energy_of = [world](std::span<const State> states) {
    return kinetic_energy_j(world, states) + k_gravity_mps2 * states[1].position_m.z();
  };
  run.measure = [energy_of, start = 0.0](const Sample& s, std::span<double> v) mutable {
    const double now = energy_of(s.states);
    if (s.step == 0) {
      start = now;
      v[0] = 0.0;
    }
    v[0] = std::max(v[0], now - start);
    v[1] = s.states[1].position_m.allFinite() ? 1.0 : 0.0;
  };
  const double energy = 0.5 * speed * speed + k_gravity_mps2 * half.x();
  run.truths = {{0.0, energy}, {1.0, 1.0}};
  return run;
}

ExactCase heap(std::string id, std::string title, std::string claim, double restitution) {
  ExactCase exact_case = {
      .id = std::move(id),
      .title = std::move(title),
      .source = "Goldstein, Classical Mechanics (1980), section 1-2; Newton's law of impact",
      .claim = std::move(claim),
      .formula = "sum p, sum L constant; KE constant for e = 1, never growing for e < 1",
      .needs = {.contacts = Contacts::several, .restitution = restitution > 0.0},
      .parameters =
          with_time({real("speed_mps", "m/s", 1.0, 0.1, 10.0, "of the bricks towards each other"),
                     real("restitution", "1", restitution, restitution, restitution,
                          "coefficient of restitution, fixed for this case")},
                    0.001, 0.6),
      .observables = {{"momentum_error_ns", "N s", "at the end"},
                      {"angular_momentum_error_nms", "N m s", "about the origin, at the end"},
                      {"energy_gain_j", "J", "largest gain of kinetic energy in one step"}},
      .make = make_heap,
      .own_time_s = [](const ParameterValues& p) { return 1.0 / value_of(p, "speed_mps"); },
      .threshold = std::nullopt,
      .expected_violation = "position correction through velocities adds energy"};
  if (restitution == 1.0) {
    exact_case.observables.push_back({"energy_j", "J", "kinetic energy at the end"});
  }
  return exact_case;
}

}  // namespace

ExactCase elastic_heap() {
  return heap("conservation.elastic_heap", "Elastic swarm of bricks",
              "Frictionless elastic collisions keep momentum, angular momentum and energy.", 1.0);
}

ExactCase inelastic_heap() {
  return heap("conservation.inelastic_heap", "Inelastic swarm of bricks",
              "Inelastic collisions keep both momenta and never add energy.", 0.0);
}

ExactCase painleve() {
  return {.id = "conservation.painleve",
          .title = "Painleve's sliding rod",
          .source = "Genot & Brogliato, Eur. J. Mech. A 18 (1999); Champneys & Varkonyi (2016)",
          .claim =
              "Where rigid Coulomb friction has no classical solution, an engine must still "
              "stay finite and not add energy.",
          .formula = "paradox for mu > (1 + 3 cos^2 th)/(3 sin th cos th), least 4/3 at tan th = 2",
          .needs = {.contacts = Contacts::several, .friction = true},
          .parameters = with_time(
              {real("friction", "1", 1.8, 0.0, 5.0, "coefficient of friction"),
               real("angle_rad", "rad", 1.1071487177940904, 0.1, 1.4, "inclination of the plate"),
               real("speed_mps", "m/s", 3.0, 0.1, 20.0, "sliding speed")},
              0.0005, 1.0),
          .observables = {{"energy_gain_j", "J", "largest energy above that of the start"},
                          {"finite", "1", "1 if the final position is finite"}},
          .make = make_painleve,
          .threshold = std::nullopt,
          .expected_violation = "correction of penetration adds energy"};
}

}  // namespace brickbench::exact
