// One body against the fixed ground: bounces and single impacts.
#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/exact/cases/builders.hpp"
#include "experiments/exact/cases/cases.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double k_radius_m = 0.1;
constexpr double k_thin_half_m = 0.1;  // of what is dropped, along the fall

ExactRun ball_over_plane(const ParameterValues& p) {
  ExactRun run = start_run(p);
  const double height = value_of(p, "height_m");
  run.world.law = {.friction = 0.0, .restitution = value_of(p, "restitution")};
  run.world.bodies = {ground_plane(),
                      ball("ball", k_radius_m, 1.0, at({0.0, 0.0, k_radius_m + height}))};
  run.geometry = sphere_contact(0, 1, k_radius_m, true);
  return run;
}

// Height and velocity of the bouncing ball at any time, by counting off the bounces.
Trajectory bouncing_trajectory(double height, double e) {
  return [=](double t, std::span<State> states) {
    const double g = k_gravity_mps2;
    double speed = std::sqrt(2.0 * g * height);
    double since = t - std::sqrt(2.0 * height / g);
    State& ball = states[1];
    if (since < 0.0) {
      ball.position_m.z() = k_radius_m + height - 0.5 * g * t * t;
      ball.velocity_mps.z() = -g * t;
      return;
    }
    speed *= e;
    while (speed > 1e-9 && since > 2.0 * speed / g) {
      since -= 2.0 * speed / g;
      speed *= e;
    }
    const bool rests = speed <= 1e-9;
    ball.position_m.z() = k_radius_m + (rests ? 0.0 : speed * since - 0.5 * g * since * since);
    ball.velocity_mps.z() = rests ? 0.0 : speed - g * since;
  };
}

ExactRun make_apexes(const ParameterValues& p) {
  ExactRun run = ball_over_plane(p);
  const double height = value_of(p, "height_m"), e = value_of(p, "restitution");
  run.trajectory = bouncing_trajectory(height, e);
  // Highest point between the n-th and the next rebound.
  run.measure = [bounces = 0, last = 0.0](const Sample& s, std::span<double> v) mutable {
    const State& ball = s.states[1];
    if (last < 0.0 && ball.velocity_mps.z() > 0.0) ++bounces;
    last = ball.velocity_mps.z();
    if (bounces < 1 || bounces > 3) return;
    const double now = ball.position_m.z() - k_radius_m;
    double& apex = v[static_cast<std::size_t>(bounces - 1)];
    if (std::isnan(apex) || now > apex) apex = now;
  };
  run.truths = {{height * e * e, height},
                {height * std::pow(e, 4), height},
                {height * std::pow(e, 6), height}};
  return run;
}

ExactRun make_bounce_times(const ParameterValues& p) {
  ExactRun run = ball_over_plane(p);
  const double height = value_of(p, "height_m"), e = value_of(p, "restitution");
  run.trajectory = bouncing_trajectory(height, e);
  run.measure = [bounces = std::size_t{0}, last = 0.0](const Sample& s,
                                                       std::span<double> v) mutable {
    const double now = s.states[1].velocity_mps.z();
    if (last < 0.0 && now > 0.0 && bounces < v.size()) v[bounces++] = s.time_s;
    last = now;
  };
  const double fall = std::sqrt(2.0 * height / k_gravity_mps2);
  double time = fall;
  double flight = 2.0 * fall;
  for (int i = 0; i < 4; ++i) {
    run.truths.push_back({time, fall});
    flight *= e;
    time += flight;
  }
  return run;
}

ExactRun make_flat_drop(const ParameterValues& p) {
  ExactRun run = start_run(p);
  const double height = value_of(p, "height_m"), e = value_of(p, "restitution");
  const Vector3d half(0.2, 0.15, k_thin_half_m);
  run.world.law = {.friction = 0.0, .restitution = e};
  run.world.bodies = {floor_slab(), box("brick", half, 5.0, at({0.0, 0.0, half.z() + height}))};
  run.geometry = flat_contact(0, 1, half.z());
  // The first upward velocity, and the largest spin and drift of the whole run.
  run.measure = [](const Sample& s, std::span<double> v) {
    const State& brick = s.states[1];
    if (s.step == 0) v[1] = v[2] = 0.0;
    if (std::isnan(v[0]) && brick.velocity_mps.z() > 0.0) v[0] = brick.velocity_mps.z();
    v[1] = std::max(v[1], brick.angular_velocity_radps.norm());
    v[2] = std::max(v[2], brick.position_m.head<2>().norm());
  };
  const double speed = std::sqrt(2.0 * k_gravity_mps2 * height);
  run.truths = {{e * speed, speed}, {0.0, speed / half.norm()}, {0.0, height}};
  return run;
}

// A body falls on the ground and must stay there: no restitution, no friction.
ExactRun make_landing(const ParameterValues& p, bool sphere) {
  ExactRun run = start_run(p);
  // The ground is reached in the middle of a step of the fall.
  const double height = value_of(p, "height_m");
  const double half = 0.125;
  const State above = at({0.0, 0.0, half + height});
  if (sphere) {
    run.world.bodies = {ground_plane(), ball("ball", half, 1.0, above)};
    run.geometry = sphere_contact(0, 1, half, true);
  } else {
    run.world.bodies = {floor_slab(), box("brick", Vector3d(0.25, 0.2, half), 5.0, above)};
    run.geometry = flat_contact(0, 1, half);
  }
  run.measure = [half](const Sample& s, std::span<double> v) {
    const State& body = s.states[1];
    if (s.step == 0) v[2] = v[3] = 0.0;
    v[0] = body.position_m.z() - half;
    v[1] = body.velocity_mps.z();
    v[2] = std::max(v[2], v[1]);
    v[3] = std::min(v[3], v[0]);
  };
  const double speed = std::sqrt(2.0 * k_gravity_mps2 * height);
  run.truths = {{0.0, height}, {0.0, speed}, {0.0, speed}, {0.0, height}};
  run.trajectory = [=](double t, std::span<State> states) {
    const double fallen = 0.5 * k_gravity_mps2 * t * t;
    states[1].position_m.z() = half + std::max(0.0, height - fallen);
    states[1].velocity_mps.z() = fallen < height ? -k_gravity_mps2 * t : 0.0;
  };
  return run;
}

double fall_s(const ParameterValues& p) {
  return std::sqrt(2.0 * value_of(p, "height_m") / k_gravity_mps2);
}

// Until the fourth bounce.
double bounces_s(const ParameterValues& p) {
  const double e = value_of(p, "restitution");
  return fall_s(p) * (1.0 + 2.0 * e * (1.0 + e * (1.0 + e)));
}

// Each flight that is measured must span some steps; the third is the shortest.
std::string flights_too_short(const ParameterValues& p) {
  constexpr double k_least_steps = 4.0;
  const double third_s = 2.0 * fall_s(p) * std::pow(value_of(p, "restitution"), 3);
  const bool too_short = third_s < k_least_steps * value_of(p, "step_s");
  return too_short ? "the third flight lasts less than four steps" : "";
}

std::string drop_outruns(const ParameterValues& p) {
  return outruns(p, k_gravity_mps2 * fall_s(p), k_thin_half_m);
}

ExactCase landing(std::string id, std::string title, bool sphere,
                  ExactRun (*make)(const ParameterValues&)) {
  return {
      .id = std::move(id),
      .title = std::move(title),
      .source =
          "Signorini's conditions with Newton's e = 0; Brogliato, Nonsmooth Mechanics "
          "(2016), section 5.1",
      .claim = "A dropped body without restitution stops on the ground and stays there.",
      .formula = "gap >= 0, v+ = 0",
      .needs = {.contacts = sphere ? Contacts::one : Contacts::several, .spheres = sphere},
      .parameters = with_time(
          {real("height_m", "m", 0.1, 1e-4, 10.0, "start height of the lowest point")}, 0.001, 0.4),
      .observables = {{"gap_m", "m", "at the end"},
                      {"velocity_mps", "m/s", "at the end"},
                      {"rebound_mps", "m/s", "largest upward velocity of the run"},
                      {"deepest_gap_m", "m", "smallest gap of the run"}},
      .make = make,
      .own_time_s = fall_s,
      .outside = drop_outruns,
      .threshold = std::nullopt,
      .expected_violation = "steps sink in by up to v dt; springs rebound a little"};
}

// A frictionless box flies without gravity onto the ground; one corner, or one edge, hits. The
// impulse is J = (1+e) v / (1/m + (r x n) . I^-1 (r x n)).
ExactRun make_impact(const ParameterValues& p, const Body& body, const Vector3d& corner,
                     int points) {
  ExactRun run = start_run(p, false);
  const double e = value_of(p, "restitution"), speed = value_of(p, "speed_mps");
  run.world.law = {.friction = 0.0, .restitution = e};
  const Vector3d lever = body.initial.orientation * corner;
  // The gap closes in the middle of a step, so that no rounding decides when contact begins.
  const double gap = 10.5 * speed * run.step_s;
  Body flying = body;
  flying.initial.position_m = {0.0, 0.0, gap - lever.z()};
  flying.initial.velocity_mps = {0.0, 0.0, -speed};
  run.world.bodies = {ground_plane(), flying};
  run.geometry = [=](std::span<const State> states, std::vector<PointContact>& contacts) {
    PointContact contact;
    contact.body_b = 1;
    contact.position_m = states[1].position_m + states[1].orientation * corner;
    contact.gap_m = contact.position_m.z();
    contact.points = points;
    contacts.push_back(contact);
  };
  const Eigen::Matrix3d r = body.initial.orientation.toRotationMatrix();
  const Vector3d turn = lever.cross(Vector3d::UnitZ());
  const Vector3d response = r * (r.transpose() * turn).cwiseQuotient(body.inertia_kgm2);
  const double impulse = (1.0 + e) * speed / (1.0 / body.mass_kg + turn.dot(response));
  const Vector3d spin = impulse * response;
  const double before = 0.5 * body.mass_kg * speed * speed;
  const double after = 0.5 * body.mass_kg * std::pow(impulse / body.mass_kg - speed, 2) +
                       0.5 * impulse * turn.dot(spin);
  // Read once, right after the impact: later the box may strike again.
  const World world = run.world;
  run.measure = [world, speed](const Sample& s, std::span<double> v) {
    const State& now = s.states[1];
    if (!std::isnan(v[0]) || std::abs(now.velocity_mps.z() + speed) < 1e-9 * speed) return;
    v[0] = now.velocity_mps.z();
    v[1] = now.angular_velocity_radps.x();
    v[2] = now.angular_velocity_radps.y();
    v[3] = now.velocity_mps.head<2>().norm();
    v[4] = kinetic_energy_j(world, s.states);
  };
  const double turn_scale = spin.norm();
  run.truths = {{impulse / body.mass_kg - speed, speed},
                {spin.x(), turn_scale},
                {spin.y(), turn_scale},
                {0.0, speed},
                {after, before}};
  return run;
}

ExactRun make_corner(const ParameterValues& p) {
  Body body = box("brick", Vector3d(0.1, 0.05, 0.025), 2.0, State{});
  body.initial.orientation = Quaterniond(Eigen::AngleAxisd(0.5, Vector3d::UnitX()) *
                                         Eigen::AngleAxisd(0.4, Vector3d::UnitY()));
  Vector3d lowest = Vector3d::Zero();
  double depth = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 8; ++i) {
    const Vector3d corner((i & 1) ? 0.1 : -0.1, (i & 2) ? 0.05 : -0.05, (i & 4) ? 0.025 : -0.025);
    const double z = (body.initial.orientation * corner).z();
    if (z < depth) {
      depth = z;
      lowest = corner;
    }
  }
  return make_impact(p, body, lowest, 1);
}

ExactRun make_rod(const ParameterValues& p) {
  const double angle = value_of(p, "angle_rad"), thickness = value_of(p, "half_thickness_m");
  Body body = box("rod", Vector3d(0.5, thickness, thickness), 1.0, State{});
  body.initial.orientation = Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
  return make_impact(p, body, Vector3d(0.5, 0.0, -thickness), 2);
}

// The next corner is 0.04 m higher than the lowest.
std::string corner_outruns(const ParameterValues& p) {
  return outruns(p, value_of(p, "speed_mps"), 0.01);
}

// A quarter of the height of the next edge above the lowest.
std::string rod_outruns(const ParameterValues& p) {
  const double angle = value_of(p, "angle_rad"), half = value_of(p, "half_thickness_m");
  return outruns(p, value_of(p, "speed_mps"),
                 0.25 * std::min(2.0 * half * std::cos(angle), std::sin(angle)));
}

std::vector<Observable> impact_observables() {
  return {{"velocity_z_mps", "m/s", "of the centre of mass after the impact"},
          {"spin_x_radps", "rad/s", "after the impact, world frame"},
          {"spin_y_radps", "rad/s", "after the impact, world frame"},
          {"velocity_sideways_mps", "m/s", "must stay zero: no friction"},
          {"energy_j", "J", "kinetic energy after the impact"}};
}

}  // namespace

ExactCase ball_apexes() {
  return {
      .id = "impact.ball_apexes",
      .title = "Bouncing ball: heights",
      .source = "Newton, Principia (1687), scholium to the laws; Stronge, Impact Mechanics (2000)",
      .claim = "Each bounce returns e^2 of the height.",
      .formula = "h_n = h0 e^(2 n)",
      .needs = {.contacts = Contacts::one, .spheres = true, .restitution = true},
      .parameters =
          with_time({real("height_m", "m", 1.0, 0.01, 100.0, "start height of the lowest point"),
                     real("restitution", "1", 0.8, 0.3, 1.0, "coefficient of restitution")},
                    0.001, 2.4),
      .observables = {{"apex_1_m", "m", "height after the first bounce"},
                      {"apex_2_m", "m", "height after the second bounce"},
                      {"apex_3_m", "m", "height after the third bounce"}},
      .make = make_apexes,
      .own_time_s = bounces_s,
      .outside = flights_too_short,
      .threshold = std::nullopt,
      .expected_violation = "contacts without a coefficient of restitution do not bounce"};
}

ExactCase ball_bounce_times() {
  return {.id = "impact.ball_bounce_times",
          .title = "Bouncing ball: times",
          .source = "Stronge, Impact Mechanics (2000), section 2.4",
          .claim = "Flights shorten by e each time; the times add up to a geometric series.",
          .formula = "t_n = sqrt(2 h0/g) (1 + 2 (e + ... + e^(n-1)))",
          .needs = {.contacts = Contacts::one, .spheres = true, .restitution = true},
          .parameters = with_time(
              {real("height_m", "m", 1.0, 0.01, 100.0, "start height of the lowest point"),
               real("restitution", "1", 0.8, 0.3, 1.0, "coefficient of restitution")},
              0.001, 2.4),
          .observables = {{"bounce_1_s", "s", "time of the first sample that moves up again"},
                          {"bounce_2_s", "s", "the second bounce"},
                          {"bounce_3_s", "s", "the third bounce"},
                          {"bounce_4_s", "s", "the fourth bounce"}},
          .make = make_bounce_times,
          .own_time_s = bounces_s,
          .outside = flights_too_short,
          .threshold = std::nullopt,
          .expected_violation = "contacts without a coefficient of restitution do not bounce"};
}

ExactCase flat_drop() {
  return {
      .id = "impact.flat_drop",
      .title = "Brick dropped flat",
      .source = "symmetry of the four corners",
      .claim = "Four simultaneous impacts reverse the velocity and start neither spin nor drift.",
      .formula = "v+ = -e v-, w+ = 0",
      .needs = {.contacts = Contacts::several, .restitution = true},
      .parameters =
          with_time({real("height_m", "m", 0.3, 0.01, 10.0, "start height of the lower face"),
                     real("restitution", "1", 0.5, 0.05, 1.0, "coefficient of restitution")},
                    0.001, 0.35),
      .observables = {{"rebound_mps", "m/s", "first upward velocity"},
                      {"spin_radps", "rad/s", "largest spin of the run"},
                      {"drift_m", "m", "largest horizontal displacement"}},
      .make = make_flat_drop,
      .own_time_s = fall_s,
      .outside = drop_outruns,
      .threshold = std::nullopt,
      .expected_violation = "contacts without a coefficient of restitution do not bounce",
      .classify = symmetric_impact_law};
}

ExactCase ball_landing() {
  return landing("impact.ball_landing", "Ball dropped without restitution", true,
                 [](const ParameterValues& p) { return make_landing(p, true); });
}

ExactCase flat_landing() {
  return landing("impact.flat_landing", "Brick dropped flat without restitution", false,
                 [](const ParameterValues& p) { return make_landing(p, false); });
}

ExactCase corner_impact() {
  return {
      .id = "impact.corner",
      .title = "Frictionless impact on one corner",
      .source = "Stronge, Impact Mechanics (2000), eq. 3.12",
      .claim = "One impulse at the corner, along the normal, sized by the effective mass there.",
      .formula = "J = (1+e) v/(1/m + (r x n) . I^-1 (r x n))",
      .needs = {.contacts = Contacts::one, .restitution = true},
      .parameters =
          with_time({real("speed_mps", "m/s", 2.0, 0.3, 20.0, "speed of the approach"),
                     real("restitution", "1", 0.6, 0.0, 1.0, "coefficient of restitution")},
                    0.0005, 0.007),
      .observables = impact_observables(),
      .make = make_corner,
      .own_time_s = one_step_s,
      .outside = corner_outruns,
      .threshold = std::nullopt,
      .expected_violation = "contacts without a coefficient of restitution do not bounce"};
}

ExactCase rod_impact() {
  return {.id = "impact.rod",
          .title = "Frictionless impact of a tilted rod on its lower edge",
          .source = "Stronge, Impact Mechanics (2000), section 3.1; thin rod limit derived",
          .claim = "As before; for a thin rod J = (1+e) m v/(1 + 3 cos^2 angle).",
          .formula = "J = (1+e) v/(1/m + (r x n) . I^-1 (r x n))",
          .needs = {.contacts = Contacts::several, .restitution = true},
          .parameters =
              with_time({real("speed_mps", "m/s", 2.0, 0.3, 20.0, "speed of the approach"),
                         real("restitution", "1", 0.5, 0.0, 1.0, "coefficient of restitution"),
                         real("angle_rad", "rad", 0.7, 0.1, 1.4, "inclination of the rod"),
                         real("half_thickness_m", "m", 0.02, 1e-6, 0.1, "half of its thickness")},
                        0.0005, 0.007),
          .observables = impact_observables(),
          .make = make_rod,
          .own_time_s = one_step_s,
          .outside = rod_outruns,
          .threshold = std::nullopt,
          .expected_violation = "contacts without a coefficient of restitution do not bounce",
          .classify = symmetric_impact_law};
}

}  // namespace brickbench::exact
