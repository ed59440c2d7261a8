// Spheres that roll, slip, and change from one to the other.
#include <algorithm>
#include <cmath>

#include "experiments/exact/cases/builders.hpp"
#include "experiments/exact/cases/cases.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Vector3d;

constexpr double k_radius_m = 0.125;
constexpr double k_mass_kg = 1.5;
constexpr double k_plank_kg = 4.0;
const Vector3d k_plank_half_m(2.0, 0.5, 0.0625);

ExactRun ball_on_ground(const ParameterValues& p, double friction, const Vector3d& velocity) {
  ExactRun run = start_run(p);
  run.world.law = {.friction = friction, .restitution = 0.0};
  run.world.bodies = {ground_plane(),
                      ball("ball", k_radius_m, k_mass_kg, at({0.0, 0.0, k_radius_m}, velocity))};
  run.geometry = sphere_contact(0, 1, k_radius_m, false);
  return run;
}

Measure rolling_measure() {
  return latest([](const Sample& s, std::span<double> v) {
    const State& ball = s.states[1];
    v[0] = ball.velocity_mps.x();
    v[1] = ball.angular_velocity_radps.y();
    v[2] = ball.position_m.x();
  });
}

ExactRun make_slide_to_roll(const ParameterValues& p) {
  const double speed = value_of(p, "speed_mps"), friction = value_of(p, "friction");
  ExactRun run = ball_on_ground(p, friction, {speed, 0.0, 0.0});
  const double brake = friction * k_gravity_mps2;
  const double sliding = 2.0 * speed / (7.0 * brake);
  const auto distance = [=](double t) {
    const double slid = std::min(t, sliding);
    return speed * slid - 0.5 * brake * slid * slid + 5.0 / 7.0 * speed * (t - slid);
  };
  run.trajectory = [=](double t, std::span<State> states) {
    const double slid = std::min(t, sliding);
    states[1].position_m.x() = distance(t);
    states[1].velocity_mps.x() = speed - brake * slid;
    states[1].angular_velocity_radps.y() = 2.5 * brake * slid / k_radius_m;
  };
  run.measure = rolling_measure();
  const double t = static_cast<double>(run.steps) * run.step_s;
  const double slid = std::min(t, sliding);
  run.truths = {{speed - brake * slid, speed},
                {2.5 * brake * slid / k_radius_m, speed / k_radius_m},
                {distance(t), speed * t}};
  return run;
}

ExactRun make_incline(const ParameterValues& p) {
  const double angle = value_of(p, "angle_rad"), friction = value_of(p, "friction");
  ExactRun run = ball_on_ground(p, friction, Vector3d::Zero());
  run.world.gravity_mps2 = tilted_gravity_mps2(angle);
  const double drive = k_gravity_mps2 * std::sin(angle);
  const double normal = k_gravity_mps2 * std::cos(angle);
  const bool rolls = friction * normal >= 2.0 / 7.0 * drive;
  const double a = rolls ? 5.0 / 7.0 * drive : drive - friction * normal;
  const double alpha = rolls ? a / k_radius_m : 2.5 * friction * normal / k_radius_m;
  run.trajectory = [=](double t, std::span<State> states) {
    states[1].position_m.x() = 0.5 * a * t * t;
    states[1].velocity_mps.x() = a * t;
    states[1].angular_velocity_radps.y() = alpha * t;
  };
  run.measure = rolling_measure();
  const double t = static_cast<double>(run.steps) * run.step_s;
  run.truths = {{a * t, drive * t},
                {alpha * t, drive * t / k_radius_m},
                {0.5 * a * t * t, 0.5 * drive * t * t}};
  return run;
}

// Ball of mass m on a plank of mass M, pulled with F over a smooth floor: the ball rolls on the
// plank with 2/7 of its acceleration.
ExactRun make_plank(const ParameterValues& p) {
  ExactRun run = start_run(p);
  const double force = value_of(p, "force_n");
  const Vector3d& half = k_plank_half_m;
  run.world.law = {.friction = value_of(p, "friction"), .restitution = 0.0};
  run.world.exceptions = {{.surface_a = 0, .surface_b = 1, .law = {}}};
  run.world.bodies = {
      floor_slab(), box("plank", half, k_plank_kg, at({0.0, 0.0, half.z()})),
      ball("ball", k_radius_m, k_mass_kg, at({0.0, 0.0, 2.0 * half.z() + k_radius_m}))};
  run.world.bodies[0].surface = 1;
  run.load = [=](std::size_t, double, std::span<Wrench> w) { w[1].force_n.x() = force; };
  run.measure = latest([](const Sample& s, std::span<double> v) {
    v[0] = s.states[1].velocity_mps.x();
    v[1] = s.states[2].velocity_mps.x();
    v[2] = s.states[2].angular_velocity_radps.y();
  });
  const double a = force / (k_plank_kg + 2.0 / 7.0 * k_mass_kg);
  const double t = static_cast<double>(run.steps) * run.step_s;
  run.truths = {{a * t, a * t},
                {2.0 / 7.0 * a * t, a * t},
                {-5.0 / 7.0 * a * t / k_radius_m, a * t / k_radius_m}};
  return run;
}

double sliding_s(const ParameterValues& p) {
  return value_of(p, "speed_mps") / (value_of(p, "friction") * k_gravity_mps2);
}

// The ball keeps rolling while friction can give it 2/7 of the plank's acceleration, and stays on
// the plank, which stays on the floor.
std::string plank_outside(const ParameterValues& p) {
  const double a = value_of(p, "force_n") / (k_plank_kg + 2.0 / 7.0 * k_mass_kg);
  const double t = value_of(p, "duration_s");
  if (2.0 / 7.0 * a > value_of(p, "friction") * k_gravity_mps2) return "the ball slips";
  if (5.0 / 7.0 * 0.5 * a * t * t > k_plank_half_m.x()) return "the ball rolls off the plank";
  return leaves_floor(0.5 * a * t * t + k_plank_half_m.x());
}

const Needs k_rolling = {.contacts = Contacts::one, .spheres = true, .friction = true};

std::vector<Observable> rolling_observables() {
  return {{"speed_mps", "m/s", "of the centre at the end"},
          {"spin_radps", "rad/s", "about the axle at the end"},
          {"distance_m", "m", "covered at the end"}};
}

ExactCase down(std::string id, std::string title, std::string claim, double friction) {
  return {.id = std::move(id),
          .title = std::move(title),
          .source = "Goldstein, Classical Mechanics (1980), section 2-4",
          .claim = std::move(claim),
          .formula = "a = 5/7 g sin th if mu >= 2/7 tan th, else a = g (sin th - mu cos th)",
          .needs = k_rolling,
          .parameters =
              with_time({real("angle_rad", "rad", 0.5, 0.01, 1.2, "inclination"),
                         real("friction", "1", friction, 0.0, 2.0, "coefficient of friction")},
                        0.001, 0.5),
          .observables = rolling_observables(),
          .make = make_incline,
          .threshold = std::nullopt,
          .expected_violation = ""};
}

}  // namespace

ExactCase slide_to_roll() {
  return {
      .id = "rolling.slide_to_roll",
      .title = "Sliding ball begins to roll",
      .source = "Routh, Dynamics of a System of Rigid Bodies (1905); Sommerfeld, Mechanics (1952)",
      .claim = "Friction turns sliding into rolling; 5/7 of the speed remain, whatever mu is.",
      .formula = "v = 5/7 v0 after t = 2 v0/(7 mu g)",
      .needs = k_rolling,
      .parameters = with_time({real("speed_mps", "m/s", 2.0, 0.1, 20.0, "speed at the start"),
                               real("friction", "1", 0.2, 0.01, 2.0, "coefficient of friction")},
                              0.001, 0.5),
      .observables = rolling_observables(),
      .make = make_slide_to_roll,
      .own_time_s = sliding_s,
      .threshold = std::nullopt,
      .expected_violation = ""};
}

ExactCase roll_down() {
  return down("rolling.roll_down", "Ball rolling down an incline",
              "With enough friction the ball rolls with 5/7 of the smooth acceleration.", 0.4);
}

ExactCase slip_down() {
  return down("rolling.slip_down", "Ball slipping down an incline",
              "With too little friction the ball slips, and friction alone spins it.", 0.1);
}

ExactCase ball_on_plank() {
  return {.id = "rolling.ball_on_plank",
          .title = "Ball on a driven plank",
          .source = "Hwangbo et al., SimBenchmark (2018), rolling test; derived",
          .claim = "The ball follows with 2/7 of the plank's acceleration and spins backwards.",
          .formula = "a_plank = F/(M + 2 m/7), a_ball = 2/7 a_plank",
          .needs = {.contacts = Contacts::several,
                    .spheres = true,
                    .friction = true,
                    .applied_forces = true},
          .parameters = with_time({real("friction", "1", 0.6, 0.05, 2.0, "ball on plank"),
                                   real("force_n", "N", 12.0, 0.1, 60.0, "pull on the plank")},
                                  0.001, 0.5),
          .observables = {{"speed_plank_mps", "m/s", "at the end"},
                          {"speed_ball_mps", "m/s", "at the end"},
                          {"spin_ball_radps", "rad/s", "about the axle at the end"}},
          .make = make_plank,
          .outside = plank_outside,
          .threshold = std::nullopt,
          .expected_violation = ""};
}

}  // namespace brickbench::exact
