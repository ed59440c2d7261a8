// Collisions of free bodies, without gravity and friction.
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "experiments/exact/cases/builders.hpp"
#include "experiments/exact/cases/cases.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double k_radius_m = 0.25;

// Both velocities after a central collision with normal velocities v1 > v2.
std::pair<double, double> central(double m1, double v1, double m2, double v2, double e) {
  const double sum = m1 + m2;
  return {((m1 - e * m2) * v1 + (1.0 + e) * m2 * v2) / sum,
          ((m2 - e * m1) * v2 + (1.0 + e) * m1 * v1) / sum};
}

ExactRun frictionless(const ParameterValues& p, double restitution) {
  ExactRun run = start_run(p, false);
  run.world.law = {.friction = 0.0, .restitution = restitution};
  return run;
}

ExactRun make_central_spheres(const ParameterValues& p) {
  const double e = value_of(p, "restitution");
  ExactRun run = frictionless(p, e);
  const double m1 = value_of(p, "mass_1_kg"), m2 = value_of(p, "mass_2_kg");
  const double v1 = value_of(p, "speed_mps"), v2 = -0.4 * v1;
  // Contact begins in the middle of a step.
  const double gap = 20.5 * (v1 - v2) * run.step_s;
  run.world.bodies = {
      ball("first", k_radius_m, m1, at({0.0, 0.0, 0.0}, {v1, 0.0, 0.0})),
      ball("second", k_radius_m, m2, at({2.0 * k_radius_m + gap, 0.0, 0.0}, {v2, 0.0, 0.0}))};
  run.geometry = sphere_row_contact({0, 1}, k_radius_m);
  run.measure = latest([m1, m2](const Sample& s, std::span<double> v) {
    v[0] = s.states[0].velocity_mps.x();
    v[1] = s.states[1].velocity_mps.x();
    v[2] = m1 * v[0] + m2 * v[1];
  });
  const auto [w1, w2] = central(m1, v1, m2, v2, e);
  run.truths = {{w1, v1}, {w2, v1}, {m1 * v1 + m2 * v2, m1 * v1}};
  return run;
}

ExactRun make_oblique(const ParameterValues& p) {
  const double e = value_of(p, "restitution");
  ExactRun run = frictionless(p, e);
  const double speed = value_of(p, "speed_mps"), offset = value_of(p, "offset_m");
  const double m1 = 1.0, m2 = 2.0;
  const double reach = std::sqrt(4.0 * k_radius_m * k_radius_m - offset * offset);
  const double gap = 20.5 * speed * run.step_s;
  run.world.bodies = {
      ball("first", k_radius_m, m1, at({-gap - reach, 0.0, 0.0}, {speed, 0.0, 0.0})),
      ball("second", k_radius_m, m2, at({0.0, offset, 0.0}))};
  run.geometry = sphere_row_contact({0, 1}, k_radius_m);
  run.measure = latest([](const Sample& s, std::span<double> v) {
    v[0] = s.states[0].velocity_mps.x();
    v[1] = s.states[0].velocity_mps.y();
    v[2] = s.states[1].velocity_mps.x();
    v[3] = s.states[1].velocity_mps.y();
    v[4] = s.states[0].angular_velocity_radps.norm() + s.states[1].angular_velocity_radps.norm();
  });
  const Vector3d n(reach / (2.0 * k_radius_m), offset / (2.0 * k_radius_m), 0.0);
  const double impulse = (1.0 + e) * speed * n.x() / (1.0 / m1 + 1.0 / m2);
  const Vector3d after1 = Vector3d(speed, 0.0, 0.0) - impulse / m1 * n;
  const Vector3d after2 = impulse / m2 * n;
  run.truths = {{after1.x(), speed},
                {after1.y(), speed},
                {after2.x(), speed},
                {after2.y(), speed},
                {0.0, speed / k_radius_m}};
  return run;
}

ExactRun make_central_boxes(const ParameterValues& p) {
  const double e = value_of(p, "restitution"), speed = value_of(p, "speed_mps");
  ExactRun run = frictionless(p, e);
  const Vector3d half(0.1, 0.05, 0.05);
  const double m1 = 2.0, m2 = 3.0;
  const double gap = 10.5 * speed * run.step_s;
  run.world.bodies = {box("first", half, m1, at(Vector3d::Zero(), {speed, 0.0, 0.0})),
                      box("second", half, m2, at({2.0 * half.x() + gap, 0.0, 0.0}))};
  run.geometry = [half](std::span<const State> states, std::vector<PointContact>& contacts) {
    PointContact contact;
    contact.body_a = 0;
    contact.body_b = 1;
    contact.normal = Vector3d::UnitX();
    contact.gap_m = states[1].position_m.x() - states[0].position_m.x() - 2.0 * half.x();
    contact.points = 4;
    contact.boxes = true;
    contact.central = true;
    contacts.push_back(contact);
  };
  run.measure = latest([](const Sample& s, std::span<double> v) {
    v[0] = s.states[0].velocity_mps.x();
    v[1] = s.states[1].velocity_mps.x();
    v[2] = s.states[0].angular_velocity_radps.norm() + s.states[1].angular_velocity_radps.norm();
  });
  const auto [w1, w2] = central(m1, speed, m2, 0.0, e);
  run.truths = {{w1, speed}, {w2, speed}, {0.0, speed / half.norm()}};
  return run;
}

// A brick turned by 45 degrees hits another one with its upright edge, off the centre.
ExactRun make_off_centre(const ParameterValues& p) {
  const double e = value_of(p, "restitution"), speed = value_of(p, "speed_mps");
  const double lever = value_of(p, "lever_m");
  ExactRun run = frictionless(p, e);
  const Vector3d target_half(0.05, 0.2, 0.1), half(0.05, 0.05, 0.08);
  const double m1 = 4.0, m2 = 1.0;
  const double edge = half.x() * std::sqrt(2.0);
  const double gap = 10.5 * speed * run.step_s;
  State flying = at({-target_half.x() - edge - gap, lever, 0.0}, {speed, 0.0, 0.0});
  flying.orientation = Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 4.0, Vector3d::UnitZ()));
  run.world.bodies = {box("struck", target_half, m1, State{}), box("striking", half, m2, flying)};
  const Vector3d corner(half.x(), -half.y(), 0.0);
  run.geometry = [=](std::span<const State> states, std::vector<PointContact>& contacts) {
    PointContact contact;
    contact.body_a = 0;
    contact.body_b = 1;
    contact.normal = states[0].orientation * Vector3d(-1.0, 0.0, 0.0);
    contact.position_m = states[1].position_m + states[1].orientation * corner;
    contact.gap_m = contact.normal.dot(contact.position_m - states[0].position_m) - target_half.x();
    contact.points = 2;
    contact.boxes = true;
    contacts.push_back(contact);
  };
  const World world = run.world;
  run.measure = latest([world](const Sample& s, std::span<double> v) {
    v[0] = s.states[0].velocity_mps.x();
    v[1] = s.states[0].angular_velocity_radps.z();
    v[2] = s.states[1].velocity_mps.x();
    v[3] = s.states[1].angular_velocity_radps.z();
    v[4] = angular_momentum_nms(world, s.states).z();
  });
  const double i1 = world.bodies[0].inertia_kgm2.z();
  const double impulse = (1.0 + e) * speed / (1.0 / m1 + 1.0 / m2 + lever * lever / i1);
  run.truths = {{impulse / m1, speed},
                {-lever * impulse / i1, speed / target_half.norm()},
                {speed - impulse / m2, speed},
                {0.0, speed / half.norm()},
                {-lever * m2 * speed, lever * m2 * speed}};
  return run;
}

ExactRun make_cradle(const ParameterValues& p) {
  ExactRun run = frictionless(p, 1.0);
  const double speed = value_of(p, "speed_mps");
  const double gap = 10.5 * speed * run.step_s;
  for (int i = 0; i < 3; ++i) {
    State state = at({2.0 * k_radius_m * i - (i == 0 ? gap : 0.0), 0.0, 0.0});
    if (i == 0) state.velocity_mps.x() = speed;
    run.world.bodies.push_back(ball("ball " + std::to_string(i), k_radius_m, 1.0, state));
  }
  run.geometry = sphere_row_contact({0, 1, 2}, k_radius_m);
  run.measure = latest([](const Sample& s, std::span<double> v) {
    v[3] = v[4] = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      v[i] = s.states[i].velocity_mps.x();
      v[3] += v[i];
      v[4] += 0.5 * v[i] * v[i];
    }
  });
  run.truths = {{0.0, speed},
                {0.0, speed},
                {speed, speed},
                {speed, speed},
                {0.5 * speed * speed, 0.5 * speed * speed}};
  return run;
}

ExactRun make_mass_chain(const ParameterValues& p) {
  const double e = value_of(p, "restitution"), speed = value_of(p, "speed_mps");
  const double ratio = value_of(p, "mass_ratio");
  ExactRun run = frictionless(p, e);
  constexpr int k_balls = 4;
  // Gaps so wide that only one pair touches at a time.
  const double gap = 20.5 * speed * run.step_s;
  double mass = 1.0;
  double last = speed;
  for (int i = 0; i < k_balls; ++i) {
    State state = at({(2.0 * k_radius_m + gap) * i, 0.0, 0.0});
    if (i == 0) state.velocity_mps.x() = speed;
    run.world.bodies.push_back(ball("ball " + std::to_string(i), k_radius_m, mass, state));
    if (i + 1 < k_balls) last *= (1.0 + e) / (1.0 + ratio);
    mass *= ratio;
  }
  run.geometry = sphere_row_contact({0, 1, 2, 3}, k_radius_m);
  const World world = run.world;
  run.measure = latest([world](const Sample& s, std::span<double> v) {
    v[0] = s.states[3].velocity_mps.x();
    v[1] = momentum_ns(world, s.states).x();
  });
  run.truths = {{last, last}, {speed, speed}};
  return run;
}

// Both fall at the same speed onto the fixed plane, the light one above the heavy one.
ExactRun make_small_on_big(const ParameterValues& p) {
  ExactRun run = frictionless(p, 1.0);
  const double speed = value_of(p, "speed_mps"), heavy = value_of(p, "heavy_mass_kg");
  const double gap = 10.5 * speed * run.step_s;
  run.world.bodies = {
      ground_plane(),
      ball("heavy", k_radius_m, heavy, at({0.0, 0.0, k_radius_m + gap}, {0.0, 0.0, -speed})),
      ball("light", k_radius_m, 1.0,
           at({0.0, 0.0, 3.0 * k_radius_m + 3.0 * gap}, {0.0, 0.0, -speed}))};
  run.geometry =
      both(sphere_contact(0, 1, k_radius_m, true), sphere_row_contact({1, 2}, k_radius_m));
  run.measure = latest([](const Sample& s, std::span<double> v) {
    v[0] = s.states[2].velocity_mps.z();
    v[1] = s.states[1].velocity_mps.z();
  });
  const auto [low, high] = central(heavy, speed, 1.0, -speed, 1.0);
  run.truths = {{high, speed}, {low, speed}};
  return run;
}

// Which of the two solutions that keep momentum and energy the three balls show.
std::string cradle_law(std::span<const double> v, const ExactRun& run) {
  const double speed = run.truths[0].scale;
  const auto near = [&](double first, double second, double third) {
    const double away = std::abs(v[0] / speed - first) + std::abs(v[1] / speed - second) +
                        std::abs(v[2] / speed - third);
    return away <= 3.0 * k_law_band;
  };
  if (near(0.0, 0.0, 1.0)) return "sequential";
  if (near(-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0)) return "simultaneous";
  return "neither";
}

// A quarter of the radius, or of the half-edge along the approach.
std::string spheres_outrun(const ParameterValues& p) {
  return outruns(p, value_of(p, "speed_mps"), 0.25 * k_radius_m);
}
std::string boxes_outrun(const ParameterValues& p) {
  return outruns(p, value_of(p, "speed_mps"), 0.0125);
}

// Until the last ball of the chain is struck: each gap is crossed (1 + e)/(1 + ratio) times faster
// than the one before.
double chain_s(const ParameterValues& p) {
  const double faster = (1.0 + value_of(p, "restitution")) / (1.0 + value_of(p, "mass_ratio"));
  return value_of(p, "step_s") * (1.0 + 1.0 / faster + 1.0 / (faster * faster));
}

const std::string k_no_restitution = "contacts without a coefficient of restitution do not bounce";

}  // namespace

ExactCase central_spheres() {
  return {.id = "impact.central_spheres",
          .title = "Central collision of two spheres",
          .source = "Goldsmith, Impact (1960), eq. 1.5; Huygens (1656) for e = 1",
          .claim = "Momentum is kept and the relative velocity is reversed times e.",
          .formula = "v1' = ((m1 - e m2) v1 + (1+e) m2 v2)/(m1 + m2)",
          .needs = {.contacts = Contacts::one, .spheres = true, .restitution = true},
          .parameters =
              with_time({real("speed_mps", "m/s", 2.0, 0.3, 20.0, "speed of the first sphere"),
                         real("mass_1_kg", "kg", 1.0, 0.01, 100.0, "mass of the first sphere"),
                         real("mass_2_kg", "kg", 3.0, 0.01, 100.0, "mass of the second sphere"),
                         real("restitution", "1", 0.7, 0.0, 1.0, "coefficient of restitution")},
                        0.001, 0.05),
          .observables = {{"velocity_1_mps", "m/s", "of the first sphere afterwards"},
                          {"velocity_2_mps", "m/s", "of the second sphere afterwards"},
                          {"momentum_ns", "N s", "sum of both"}},
          .make = make_central_spheres,
          .own_time_s = one_step_s,
          .outside = spheres_outrun,
          .threshold = std::nullopt,
          .expected_violation = k_no_restitution};
}

ExactCase oblique_spheres() {
  return {.id = "impact.oblique_spheres",
          .title = "Oblique frictionless collision of two spheres",
          .source = "Goldsmith, Impact (1960), section 1.2",
          .claim = "Only the velocity along the line of centres changes; nothing starts to spin.",
          .formula = "J = (1+e) v n_x/(1/m1 + 1/m2) along the line of centres",
          .needs = {.contacts = Contacts::one, .spheres = true, .restitution = true},
          .parameters =
              with_time({real("speed_mps", "m/s", 2.0, 0.3, 20.0, "speed of the first sphere"),
                         real("offset_m", "m", 0.2, 0.0, 0.45, "offset of the centres"),
                         real("restitution", "1", 0.7, 0.0, 1.0, "coefficient of restitution")},
                        0.001, 0.05),
          .observables = {{"velocity_1x_mps", "m/s", "first sphere, along the flight"},
                          {"velocity_1y_mps", "m/s", "first sphere, across"},
                          {"velocity_2x_mps", "m/s", "second sphere, along"},
                          {"velocity_2y_mps", "m/s", "second sphere, across"},
                          {"spin_radps", "rad/s", "must stay zero: no friction"}},
          .make = make_oblique,
          .own_time_s = one_step_s,
          .outside = spheres_outrun,
          .threshold = std::nullopt,
          .expected_violation = k_no_restitution};
}

ExactCase central_boxes() {
  return {.id = "impact.central_boxes",
          .title = "Two bricks face to face",
          .source = "Goldsmith, Impact (1960), eq. 1.5",
          .claim = "As for spheres; the four corners of the face must not start a spin.",
          .formula = "v1' = (m1 - e m2) v1/(m1 + m2), v2' = (1+e) m1 v1/(m1 + m2)",
          .needs = {.contacts = Contacts::several, .restitution = true},
          .parameters =
              with_time({real("speed_mps", "m/s", 2.0, 0.3, 20.0, "speed of the first brick"),
                         real("restitution", "1", 0.5, 0.0, 1.0, "coefficient of restitution")},
                        0.001, 0.03),
          .observables = {{"velocity_1_mps", "m/s", "of the first brick afterwards"},
                          {"velocity_2_mps", "m/s", "of the second brick afterwards"},
                          {"spin_radps", "rad/s", "sum of both spins, must stay zero"}},
          .make = make_central_boxes,
          .own_time_s = one_step_s,
          .outside = boxes_outrun,
          .threshold = std::nullopt,
          .expected_violation = k_no_restitution,
          .classify = symmetric_impact_law};
}

ExactCase off_centre_bricks() {
  return {.id = "impact.off_centre",
          .title = "Off-centre hit of two free bricks",
          .source = "Stronge, Impact Mechanics (2000), eq. 3.12, in the plane",
          .claim = "One impulse along the struck face; angular momentum about any point stays.",
          .formula = "J = (1+e) v/(1/m1 + 1/m2 + c^2/I1)",
          .needs = {.contacts = Contacts::several, .restitution = true},
          .parameters = with_time(
              {real("speed_mps", "m/s", 2.0, 0.3, 20.0, "speed of the striking brick"),
               real("lever_m", "m", 0.12, 0.01, 0.18, "distance of the hit from the centre"),
               real("restitution", "1", 0.0, 0.0, 1.0, "coefficient of restitution")},
              0.0005, 0.008),
          .observables = {{"velocity_1_mps", "m/s", "of the struck brick"},
                          {"spin_1_radps", "rad/s", "of the struck brick"},
                          {"velocity_2_mps", "m/s", "of the striking brick"},
                          {"spin_2_radps", "rad/s", "of the striking brick, must stay zero"},
                          {"angular_momentum_nms", "N m s", "about the origin, z"}},
          .make = make_off_centre,
          .own_time_s = one_step_s,
          .outside = boxes_outrun,
          .threshold = std::nullopt,
          .expected_violation = ""};
}

ExactCase cradle() {
  return {.id = "impact.cradle",
          .title = "Newton's cradle of three touching balls",
          .source =
              "Smith, Kaufman, Vouga, Tamstorf & Grinspun, Reflections on simultaneous impact "
              "(2012), section 2",
          .claim =
              "Hit one after the other the last ball leaves alone. Both answers below keep "
              "momentum and energy.",
          .formula = "sequential (0, 0, v); simultaneous Newton (-v/3, 2 v/3, 2 v/3)",
          .needs = {.contacts = Contacts::several, .spheres = true, .restitution = true},
          .parameters = with_time(
              {real("speed_mps", "m/s", 1.0, 0.3, 20.0, "speed of the first ball")}, 0.001, 0.02),
          .observables = {{"velocity_1_mps", "m/s", "of the first ball afterwards"},
                          {"velocity_2_mps", "m/s", "of the middle ball"},
                          {"velocity_3_mps", "m/s", "of the last ball"},
                          {"momentum_ns", "N s", "sum"},
                          {"energy_j", "J", "kinetic energy"}},
          .make = make_cradle,
          .own_time_s = one_step_s,
          .outside = spheres_outrun,
          .threshold = std::nullopt,
          .expected_violation = "Newton's law at all contacts at once gives (-v/3, 2 v/3, 2 v/3)",
          .classify = cradle_law};
}

ExactCase mass_chain() {
  return {.id = "impact.mass_chain",
          .title = "Chain of growing or shrinking masses",
          .source = "Goldsmith, Impact (1960), section 1.2, applied along the chain",
          .claim = "Each collision passes on (1+e) m_i/(m_i + m_(i+1)) of the velocity.",
          .formula = "v_n = v0 prod (1+e) m_i/(m_i + m_(i+1))",
          .needs = {.contacts = Contacts::one, .spheres = true, .restitution = true},
          .parameters = with_time(
              {real("speed_mps", "m/s", 2.0, 0.3, 20.0, "speed of the first ball"),
               real("mass_ratio", "1", 0.5, 0.1, 1.0, "mass of each ball over the one before"),
               real("restitution", "1", 1.0, 0.5, 1.0, "coefficient of restitution")},
              0.001, 0.08),
          .observables = {{"velocity_last_mps", "m/s", "of the last ball"},
                          {"momentum_ns", "N s", "sum"}},
          .make = make_mass_chain,
          .own_time_s = chain_s,
          .outside = spheres_outrun,
          .threshold = std::nullopt,
          .expected_violation = k_no_restitution};
}

ExactCase small_on_big() {
  return {
      .id = "impact.small_on_big",
      .title = "Light ball on a heavy one",
      .source = "Harter, Velocity amplification in collision experiments, Am. J. Phys. 39 (1971)",
      .claim =
          "The heavy ball turns first and throws the light one back at nearly three times "
          "its speed.",
      .formula = "v' = v (3 M - m)/(M + m)",
      .needs = {.contacts = Contacts::one, .spheres = true, .restitution = true},
      .parameters =
          with_time({real("speed_mps", "m/s", 2.0, 0.3, 20.0, "speed of both"),
                     real("heavy_mass_kg", "kg", 20.0, 3.0, 1e6,
                          "mass of the heavy ball, which then does not fall back; the other: 1")},
                    0.001, 0.04),
      .observables = {{"velocity_light_mps", "m/s", "of the light ball afterwards"},
                      {"velocity_heavy_mps", "m/s", "of the heavy ball afterwards"}},
      .make = make_small_on_big,
      .own_time_s = one_step_s,
      .outside = spheres_outrun,
      .threshold = std::nullopt,
      .expected_violation = k_no_restitution};
}

}  // namespace brickbench::exact
