// Dry friction of one brick on a plane.
#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/exact/cases/builders.hpp"
#include "experiments/exact/cases/cases.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Vector3d;

// Flat, so that friction hardly shifts the load between the corners; the height is a power of two,
// so that the brick starts at a gap of exactly zero.
const Vector3d k_half_m(0.5, 0.5, 0.03125);
constexpr double k_mass_kg = 2.0;

ExactRun brick_on_floor(const ParameterValues& p, double friction, const Vector3d& velocity) {
  ExactRun run = start_run(p);
  run.world.law = {.friction = friction, .restitution = 0.0};
  run.world.bodies = {floor_slab(),
                      box("brick", k_half_m, k_mass_kg, at({0.0, 0.0, k_half_m.z()}, velocity))};
  run.geometry = flat_contact(0, 1, k_half_m.z());
  return run;
}

double duration_s(const ExactRun& run) { return static_cast<double>(run.steps) * run.step_s; }

ExactRun make_incline(const ParameterValues& p) {
  const double angle = value_of(p, "angle_rad"), friction = value_of(p, "friction");
  ExactRun run = brick_on_floor(p, friction, Vector3d::Zero());
  run.world.gravity_mps2 = tilted_gravity_mps2(angle);
  run.measure = latest([](const Sample& s, std::span<double> v) {
    v[0] = s.states[1].velocity_mps.x();
    v[1] = s.states[1].position_m.x();
  });
  const double t = duration_s(run);
  const double drive = k_gravity_mps2 * std::sin(angle);
  const double a = std::max(0.0, drive - friction * k_gravity_mps2 * std::cos(angle));
  run.trajectory = [=](double time, std::span<State> states) {
    states[1].position_m.x() = 0.5 * a * time * time;
    states[1].velocity_mps.x() = a * time;
  };
  run.truths = {{a * t, drive * t}, {0.5 * a * t * t, 0.5 * drive * t * t}};
  return run;
}

double critical_friction(const ParameterValues& p) { return std::tan(value_of(p, "angle_rad")); }

// A brick that slides with this speed at the end of the run slipped: at 1e-4 below the critical
// coefficient it reaches 4e-4 m/s in one second.
constexpr double k_slip_mps = 1e-4;
bool slipped(std::span<const double> v) { return !(std::abs(v[0]) < k_slip_mps); }

ExactRun make_sliding_stop(const ParameterValues& p) {
  const double speed = value_of(p, "speed_mps"), friction = value_of(p, "friction");
  const double heading = value_of(p, "heading_rad");
  const Vector3d along(std::cos(heading), std::sin(heading), 0.0);
  const Vector3d across(-along.y(), along.x(), 0.0);
  ExactRun run = brick_on_floor(p, friction, speed * along);
  const double brake = friction * k_gravity_mps2;
  run.trajectory = [=](double time, std::span<State> states) {
    const double moving = std::min(time, speed / brake);
    states[1].position_m += (speed * moving - 0.5 * brake * moving * moving) * along;
    states[1].velocity_mps = (speed - brake * moving) * along;
  };
  // Stopped: slower than the thousandth part of what one step takes away.
  const double still = 1e-3 * brake * run.step_s;
  run.measure = [=](const Sample& s, std::span<double> v) {
    const State& brick = s.states[1];
    v[0] = along.dot(brick.position_m);
    v[1] = across.dot(brick.position_m);
    if (std::isnan(v[2]) && brick.velocity_mps.head<2>().norm() < still) v[2] = s.time_s;
    // One step after half of the stopping time.
    if (std::isnan(v[3]) && s.time_s > 0.5 * speed / brake) v[3] = along.dot(brick.velocity_mps);
  };
  const double way = 0.5 * speed * speed / brake;
  const double sample_s = run.step_s * (std::floor(0.5 * speed / brake / run.step_s + 1e-9) + 1.0);
  run.truths = {
      {way, way}, {0.0, way}, {speed / brake, speed / brake}, {speed - brake * sample_s, speed}};
  return run;
}

ExactRun make_force_ramp(const ParameterValues& p) {
  const double friction = value_of(p, "friction"), rate = value_of(p, "rate_nps");
  ExactRun run = brick_on_floor(p, friction, Vector3d::Zero());
  const double h = run.step_s;
  // The mean of the ramp over the step, so that the impulse is exact.
  run.load = [=](std::size_t, double start, std::span<Wrench> w) {
    w[1].force_n.x() = rate * (start + 0.5 * h);
  };
  const double limit = friction * k_mass_kg * k_gravity_mps2;
  const double onset = limit / rate;
  const double t = duration_s(run);
  run.measure = [still = 1e-3 * rate * h * h / k_mass_kg](const Sample& s, std::span<double> v) {
    const double speed = s.states[1].velocity_mps.x();
    if (std::isnan(v[0]) && speed > still) v[0] = s.time_s;
    v[1] = speed;
  };
  const double speed = t > onset ? 0.5 * rate * (t - onset) * (t - onset) / k_mass_kg : 0.0;
  run.truths = {{onset, onset}, {speed, 0.5 * rate * t * t / k_mass_kg}};
  return run;
}

// All four corners lie at the radius r from the axis and carry a quarter of the load each.
ExactRun make_spin_stop(const ParameterValues& p) {
  const double friction = value_of(p, "friction"), spin = value_of(p, "spin_radps");
  ExactRun run = brick_on_floor(p, friction, Vector3d::Zero());
  run.geometry = nullptr;
  run.world.bodies[1].initial.angular_velocity_radps.z() = spin;
  const double radius = k_half_m.head<2>().norm();
  const double brake =
      friction * k_mass_kg * k_gravity_mps2 * radius / run.world.bodies[1].inertia_kgm2.z();
  run.measure = [=, angle = 0.0, still = 1e-3 * brake * run.step_s](const Sample& s,
                                                                    std::span<double> v) mutable {
    const double now = s.states[1].angular_velocity_radps.z();
    if (s.step > 0) angle += now * run.step_s;
    v[0] = angle;
    if (std::isnan(v[1]) && std::abs(now) < still) v[1] = s.time_s;
    v[2] = s.states[1].position_m.head<2>().norm();
  };
  run.truths = {{0.5 * spin * spin / brake, 0.5 * spin * spin / brake},
                {spin / brake, spin / brake},
                {0.0, radius}};
  return run;
}

ExactRun make_spin_and_slide(const ParameterValues& p) {
  const double friction = value_of(p, "friction");
  const double speed = value_of(p, "speed_mps"), spin = value_of(p, "spin_radps");
  ExactRun run = brick_on_floor(p, friction, {speed, 0.0, 0.0});
  run.geometry = nullptr;
  run.world.bodies[1].initial.angular_velocity_radps.z() = spin;
  const double brake = friction * k_gravity_mps2;
  const double radius = k_half_m.head<2>().norm();
  const double still = 2.0 * brake * run.step_s;
  run.measure = [=, slide = 0.0, turn = 0.0](const Sample& s, std::span<double> v) mutable {
    const State& brick = s.states[1];
    const double forward = brick.velocity_mps.head<2>().norm();
    const double around = std::abs(brick.angular_velocity_radps.z()) * radius;
    if (forward > still) slide = s.time_s;
    if (around > still) turn = s.time_s;
    v[0] = turn > 0.0 ? slide / turn : std::numeric_limits<double>::quiet_NaN();
  };
  run.truths = {{1.0, 1.0}};
  return run;
}

double stopping_s(const ParameterValues& p) {
  return value_of(p, "speed_mps") / (value_of(p, "friction") * k_gravity_mps2);
}
double onset_s(const ParameterValues& p) {
  return value_of(p, "friction") * k_mass_kg * k_gravity_mps2 / value_of(p, "rate_nps");
}
double spinning_s(const ParameterValues& p) {
  const double inertia_m2 = 2.0 / 3.0 * k_half_m.x() * k_half_m.x();  // I/m about the vertical
  const double lever_m = k_half_m.head<2>().norm();
  return value_of(p, "spin_radps") * inertia_m2 /
         (value_of(p, "friction") * k_gravity_mps2 * lever_m);
}
double spin_and_slide_s(const ParameterValues& p) { return stopping_s(p) + spinning_s(p); }

std::string incline_leaves_floor(const ParameterValues& p) {
  const double angle = value_of(p, "angle_rad"), t = value_of(p, "duration_s");
  const double a = k_gravity_mps2 * (std::sin(angle) - value_of(p, "friction") * std::cos(angle));
  return leaves_floor(0.5 * a * t * t);
}
std::string stop_leaves_floor(const ParameterValues& p) {
  return leaves_floor(0.5 * value_of(p, "speed_mps") * stopping_s(p));
}
std::string ramp_leaves_floor(const ParameterValues& p) {
  const double t = std::max(0.0, value_of(p, "duration_s") - onset_s(p));
  return leaves_floor(value_of(p, "rate_nps") * t * t * t / (6.0 * k_mass_kg));
}
std::string spin_and_slide_leaves_floor(const ParameterValues& p) {
  return leaves_floor(value_of(p, "speed_mps") * spin_and_slide_s(p));
}

std::vector<Parameter> incline_parameters(double angle, double friction, double duration) {
  return with_time({real("angle_rad", "rad", angle, 0.01, 1.2, "inclination"),
                    real("friction", "1", friction, 0.0, 3.0, "coefficient of friction")},
                   0.001, duration);
}

std::vector<Observable> incline_observables() {
  return {{"speed_mps", "m/s", "down the incline at the end"},
          {"distance_m", "m", "down the incline at the end"}};
}

const Needs k_rubbing = {.contacts = Contacts::several, .friction = true};
const std::string k_coulomb = "Coulomb, Theorie des machines simples (1785)";

ExactCase stop_case(std::string id, std::string title, double heading) {
  return {
      .id = std::move(id),
      .title = std::move(title),
      .source = k_coulomb,
      .claim = "A sliding brick is slowed by mu g along its way, whatever its heading, and stops.",
      .formula = "d = v0^2/(2 mu g), t = v0/(mu g), no sideways motion",
      .needs = k_rubbing,
      .parameters = with_time(
          {real("speed_mps", "m/s", 2.0, 0.1, 10.0, "speed at the start"),
           real("friction", "1", 0.5, 0.05, 2.0, "coefficient of friction"),
           real("heading_rad", "rad", heading, 0.0, 6.3, "direction of the velocity from +x")},
          0.001, 0.6),
      .observables = {{"distance_m", "m", "along the start velocity, at the end"},
                      {"sideways_m", "m", "across it, at the end"},
                      {"stop_s", "s", "first sample at rest"},
                      {"speed_mps", "m/s", "one step after half of the stopping time"}},
      .make = make_sliding_stop,
      .own_time_s = stopping_s,
      .outside = stop_leaves_floor,
      .threshold = std::nullopt,
      .expected_violation = "a friction box stops the axes one after the other: the way bends"};
}

}  // namespace

ExactCase incline_slide() {
  return {.id = "friction.incline_slide",
          .title = "Brick sliding down an incline",
          .source = k_coulomb,
          .claim = "Steeper than the angle of friction, a brick accelerates evenly.",
          .formula = "a = g (sin th - mu cos th)",
          .needs = k_rubbing,
          .parameters = incline_parameters(0.5, 0.3, 0.5),
          .observables = incline_observables(),
          .make = make_incline,
          .outside = incline_leaves_floor,
          .threshold = std::nullopt,
          .expected_violation = ""};
}

ExactCase incline_creep() {
  return {.id = "friction.incline_creep",
          .title = "Brick at rest on an incline",
          .source = k_coulomb,
          .claim = "Below the angle of friction a brick does not move at all.",
          .formula = "x = 0 for mu >= tan th",
          .needs = k_rubbing,
          .parameters = incline_parameters(0.4, 0.47, 2.0),
          .observables = incline_observables(),
          .make = make_incline,
          .outside = incline_leaves_floor,
          .threshold = std::nullopt,
          .expected_violation = "regularised friction creeps at a constant speed"};
}

ExactCase incline_threshold() {
  Threshold threshold;
  threshold.parameter = "friction";
  threshold.critical = critical_friction;
  threshold.happened = slipped;
  threshold.above = false;
  return {.id = "friction.incline_threshold",
          .title = "Onset of slip on an incline",
          .source = k_coulomb,
          .claim = "Slip begins where mu = tan th.",
          .formula = "mu_c = tan th",
          .needs = k_rubbing,
          .parameters = incline_parameters(0.4, 0.6, 1.0),
          .observables = incline_observables(),
          .make = make_incline,
          .outside = incline_leaves_floor,
          .threshold = threshold,
          .expected_violation = "creep of regularised friction counts as slip"};
}

ExactCase sliding_stop() {
  return stop_case("friction.sliding_stop", "Sliding to a stop along an axis", 0.0);
}

ExactCase diagonal_slide() {
  ExactCase diagonal =
      stop_case("friction.diagonal_slide", "Sliding to a stop at 30 degrees", 0.5235987755982988);
  diagonal.claim = "Coulomb's cone is round: a brick heading anywhere keeps a straight line.";
  return diagonal;
}

ExactCase force_ramp() {
  return {.id = "friction.force_ramp",
          .title = "Growing pull on a resting brick",
          .source = "Le Lidec et al., Contact models in robotics (2024), section V",
          .claim = "The brick rests until F = mu m g and then gathers the excess.",
          .formula = "t_on = mu m g/k, v = k (t - t_on)^2/(2 m)",
          .needs = {.contacts = Contacts::several, .friction = true, .applied_forces = true},
          .parameters = with_time({real("friction", "1", 0.4, 0.05, 2.0, "coefficient of friction"),
                                   real("rate_nps", "N/s", 20.0, 0.1, 1e3, "growth of the pull")},
                                  0.001, 0.8),
          .observables = {{"onset_s", "s", "first sample that moves"},
                          {"speed_mps", "m/s", "at the end"}},
          .make = make_force_ramp,
          .own_time_s = onset_s,
          .outside = ramp_leaves_floor,
          .threshold = std::nullopt,
          .expected_violation = "regularised friction moves at once"};
}

ExactCase spin_stop() {
  return {
      .id = "friction.spin_stop",
      .title = "Brick spinning in place",
      .source = "derived: four corners at the radius r, a quarter of the load each",
      .claim = "Friction at the corners slows the spin by mu m g r / I.",
      .formula = "angle = w0^2 I/(2 mu m g r), t = w0 I/(mu m g r)",
      .needs = k_rubbing,
      .parameters = with_time({real("friction", "1", 0.3, 0.05, 2.0, "coefficient of friction"),
                               real("spin_radps", "rad/s", 4.0, 0.1, 50.0, "spin at the start")},
                              0.001, 1.0),
      .observables = {{"angle_rad", "rad", "turned until rest, sum of spin times step"},
                      {"stop_s", "s", "first sample at rest"},
                      {"drift_m", "m", "of the centre"}},
      .make = make_spin_stop,
      .own_time_s = spinning_s,
      .threshold = std::nullopt,
      .expected_violation = "a friction box gives the corners up to sqrt(2) mu N each"};
}

ExactCase spin_and_slide() {
  return {
      .id = "friction.spin_and_slide",
      .title = "Sliding and spinning end together",
      .source = "Farkas, Bartels, Unger & Wolf, Phys. Rev. Lett. 90 (2003) 248302",
      .claim = "Friction couples both motions so that they stop at the same time.",
      .formula = "t_slide = t_spin",
      .needs = k_rubbing,
      .parameters = with_time({real("friction", "1", 0.3, 0.05, 2.0, "coefficient of friction"),
                               real("speed_mps", "m/s", 1.5, 0.1, 10.0, "speed at the start"),
                               real("spin_radps", "rad/s", 2.0, 0.1, 50.0, "spin at the start")},
                              0.0005, 1.2),
      .observables = {{"time_ratio", "1", "end of sliding over end of spinning"}},
      .make = make_spin_and_slide,
      .own_time_s = spin_and_slide_s,
      .outside = spin_and_slide_leaves_floor,
      .threshold = std::nullopt,
      .expected_violation = "uncoupled friction rows end one motion before the other"};
}

}  // namespace brickbench::exact
