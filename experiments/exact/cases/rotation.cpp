// Free rotation: uniform, driven, and the torque-free asymmetric and symmetric bodies.
#include <cmath>
#include <numbers>

#include "experiments/exact/cases/builders.hpp"
#include "experiments/exact/cases/cases.hpp"
#include "experiments/exact/cases/elliptic.hpp"

namespace brickbench::exact {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// A brick of three different edges; its moments increase along x, y, z.
const Vector3d k_brick_half_m(0.1, 0.05, 0.025);
constexpr double k_mass_kg = 1.0;

Body brick_spinning(const Vector3d& spin_radps) {
  return box("brick", k_brick_half_m, k_mass_kg,
             at(Vector3d::Zero(), Vector3d::Zero(), spin_radps));
}

ExactRun make_uniform_spin(const ParameterValues& p) {
  ExactRun run = start_run(p, false);
  const double rate = value_of(p, "spin_radps");
  run.world.bodies = {brick_spinning({0.0, 0.0, rate})};
  run.trajectory = [=](double t, std::span<State> states) {
    states[0].orientation = AngleAxisd(rate * t, Vector3d::UnitZ());
  };
  // The angle is added up step by step, so that it may exceed a turn.
  run.measure = [last = Quaterniond::Identity(), angle = 0.0](const Sample& s,
                                                              std::span<double> v) mutable {
    const Quaterniond turn = last.conjugate() * s.states[0].orientation;
    const double sign = turn.w() < 0.0 ? -1.0 : 1.0;
    angle += 2.0 * std::atan2(sign * turn.z(), sign * turn.w());
    last = s.states[0].orientation;
    v[0] = angle;
    v[1] = s.states[0].angular_velocity_radps.z();
    v[2] = s.states[0].angular_velocity_radps.head<2>().norm();
  };
  const double t = static_cast<double>(run.steps) * run.step_s;
  run.truths = {{rate * t, rate * t}, {rate, rate}, {0.0, rate}};
  return run;
}

ExactRun make_spin_up(const ParameterValues& p) {
  ExactRun run = start_run(p, false);
  const double torque = value_of(p, "torque_nm");
  run.world.bodies = {brick_spinning(Vector3d::Zero())};
  const double alpha = torque / run.world.bodies[0].inertia_kgm2.x();
  run.load = [=](std::size_t, double, std::span<Wrench> w) { w[0].torque_nm.x() = torque; };
  run.trajectory = [=](double t, std::span<State> states) {
    states[0].orientation = AngleAxisd(0.5 * alpha * t * t, Vector3d::UnitX());
    states[0].angular_velocity_radps = {alpha * t, 0.0, 0.0};
  };
  run.measure = [last = Quaterniond::Identity(), angle = 0.0](const Sample& s,
                                                              std::span<double> v) mutable {
    const Quaterniond turn = last.conjugate() * s.states[0].orientation;
    const double sign = turn.w() < 0.0 ? -1.0 : 1.0;
    angle += 2.0 * std::atan2(sign * turn.x(), sign * turn.w());
    last = s.states[0].orientation;
    v[0] = angle;
    v[1] = s.states[0].angular_velocity_radps.x();
  };
  const double t = static_cast<double>(run.steps) * run.step_s;
  run.truths = {{0.5 * alpha * t * t, 0.5 * alpha * t * t}, {alpha * t, alpha * t}};
  return run;
}

// Shared by the torque-free cases: truth from the elliptic solution, measurement of attitude,
// spin, energy and momentum.
ExactRun make_torque_free(const ParameterValues& p) {
  ExactRun run = start_run(p, false);
  const double w1 = value_of(p, "spin_1_radps"), w3 = value_of(p, "spin_3_radps");
  run.world.bodies = {brick_spinning({w1, 0.0, w3})};
  const Body body = run.world.bodies[0];
  const TorqueFree exact(body.inertia_kgm2, w1, w3);
  run.trajectory = [=](double t, std::span<State> states) {
    states[0].orientation = exact.orientation(t);
    states[0].angular_velocity_radps = states[0].orientation * exact.spin_radps(t);
  };
  const double t = static_cast<double>(run.steps) * run.step_s;
  const Quaterniond end = exact.orientation(t);
  const Vector3d momentum = spin_momentum_nms(body, body.initial);
  const double energy = 0.5 * momentum.dot(body.initial.angular_velocity_radps);
  run.measure = latest([=](const Sample& s, std::span<double> v) {
    const State& brick = s.states[0];
    const Vector3d spin = brick.orientation.conjugate() * brick.angular_velocity_radps;
    const Vector3d now = spin_momentum_nms(body, brick);
    v[0] = angle_between_rad(end, brick.orientation);
    v[1] = spin[0];
    v[2] = spin[1];
    v[3] = spin[2];
    v[4] = 0.5 * now.dot(brick.angular_velocity_radps);
    v[5] = (now - momentum).norm();
  });
  const Vector3d spin = exact.spin_radps(t);
  const double size = std::hypot(w1, w3);
  run.truths = {{0.0, 1.0},      {spin[0], size},  {spin[1], size},
                {spin[2], size}, {energy, energy}, {0.0, momentum.norm()}};
  return run;
}

// Times of the first two sign changes of w2, linear between samples.
ExactRun make_axis_flip(const ParameterValues& p) {
  ExactRun run = make_torque_free(p);
  const double w1 = value_of(p, "spin_1_radps"), w3 = value_of(p, "spin_3_radps");
  const TorqueFree exact(run.world.bodies[0].inertia_kgm2, w1, w3);
  run.measure = [last_w = 0.0, last_s = 0.0, count = std::size_t{0}](const Sample& s,
                                                                     std::span<double> v) mutable {
    const State& brick = s.states[0];
    const double w = (brick.orientation.conjugate() * brick.angular_velocity_radps).y();
    if (s.step > 1 && last_w * w < 0.0 && count < 2) {
      v[count++] = last_s + (s.time_s - last_s) * last_w / (last_w - w);
    }
    last_w = w;
    last_s = s.time_s;
  };
  run.truths = {{exact.flip_s(), exact.flip_s()}, {2.0 * exact.flip_s(), 2.0 * exact.flip_s()}};
  return run;
}

// A square prism: the spin along the axis is constant, the axis precesses about the momentum.
ExactRun make_symmetric(const ParameterValues& p) {
  ExactRun run = start_run(p, false);
  const double across = value_of(p, "spin_across_radps"), along = value_of(p, "spin_along_radps");
  run.world.bodies = {box("prism", Vector3d(0.03, 0.03, 0.12), k_mass_kg,
                          at(Vector3d::Zero(), Vector3d::Zero(), {across, 0.0, along}))};
  const Body body = run.world.bodies[0];
  const double i1 = body.inertia_kgm2.x(), i3 = body.inertia_kgm2.z();
  const Vector3d momentum = spin_momentum_nms(body, body.initial);
  const double space = momentum.norm() / i1;       // precession in space
  const double relative = (i1 - i3) / i1 * along;  // turn of the body about its own axis
  const Vector3d axis = momentum.normalized();
  const auto attitude = [=](double t) {
    return Quaterniond(AngleAxisd(space * t, axis) * AngleAxisd(relative * t, Vector3d::UnitZ()));
  };
  run.trajectory = [=](double t, std::span<State> states) {
    const Quaterniond q = attitude(t);
    const Vector3d spin(across * std::cos(relative * t), -across * std::sin(relative * t), along);
    states[0].orientation = q;
    states[0].angular_velocity_radps = q * spin;
  };
  const double t = static_cast<double>(run.steps) * run.step_s;
  const Quaterniond end = attitude(t);
  const Vector3d end_axis = end * Vector3d::UnitZ();
  run.measure = latest([=](const Sample& s, std::span<double> v) {
    const State& prism = s.states[0];
    const Vector3d now = prism.orientation * Vector3d::UnitZ();
    v[0] = angle_between_rad(end, prism.orientation);
    v[1] = std::atan2(end_axis.cross(now).norm(), end_axis.dot(now));
    v[2] = (prism.orientation.conjugate() * prism.angular_velocity_radps).z();
  });
  run.truths = {{0.0, 1.0}, {0.0, 1.0}, {along, along}};
  return run;
}

double spin_own_s(const ParameterValues& p) { return 1.0 / value_of(p, "spin_radps"); }
double torque_own_s(const ParameterValues& p) { return 1.0 / std::sqrt(value_of(p, "torque_nm")); }
double torque_free_own_s(const ParameterValues& p) {
  return 1.0 / std::hypot(value_of(p, "spin_1_radps"), value_of(p, "spin_3_radps"));
}
double precession_own_s(const ParameterValues& p) {
  return 1.0 / std::hypot(value_of(p, "spin_across_radps"), value_of(p, "spin_along_radps"));
}
double flip_time_s(const ParameterValues& p) {
  return TorqueFree(brick_spinning(Vector3d::Zero()).inertia_kgm2, value_of(p, "spin_1_radps"),
                    value_of(p, "spin_3_radps"))
      .flip_s();
}

// Of the turns where the axis does not flip at all.
double flip_own_s(const ParameterValues& p) {
  const double flip_s = flip_time_s(p);
  if (std::isfinite(flip_s) && flip_s > 0.0) return flip_s;
  return 1.0 / std::hypot(value_of(p, "spin_1_radps"), value_of(p, "spin_3_radps"));
}

// The period grows without bound towards the separatrix 2 E I2 = M^2, and with it the rounding of
// the elliptic functions.
std::string near_separatrix(const ParameterValues& p) {
  const Vector3d& inertia = brick_spinning(Vector3d::Zero()).inertia_kgm2;
  const Vector3d spin(value_of(p, "spin_1_radps"), 0.0, value_of(p, "spin_3_radps"));
  const double squared = inertia.cwiseProduct(spin).squaredNorm();
  const double middle = inertia.y() * spin.dot(inertia.cwiseProduct(spin));
  return std::abs(squared - middle) < 1e-3 * squared ? "the spin lies on the separatrix" : "";
}

std::string never_flips(const ParameterValues& p) {
  if (const double flip_s = flip_time_s(p); !std::isfinite(flip_s) || !(flip_s > 0.0)) {
    return "the axis never flips";
  }
  return near_separatrix(p);
}

// Half a turn per step cannot be told from half a turn back.
std::string half_turns(double angle_rad) {
  return angle_rad >= std::numbers::pi ? "a step turns the brick by half a turn or more" : "";
}

ExactCase torque_free(std::string id, std::string title, std::string claim, double w1, double w3) {
  return {
      .id = std::move(id),
      .title = std::move(title),
      .source = "Landau & Lifshitz, Mechanics (1976), paragraph 37",
      .claim = std::move(claim),
      .formula = "w = (A1 cn, A2 sn, A3 dn)(tau) for M^2 > 2 E I2, 1 and 3 exchanged otherwise",
      .needs = {},
      .parameters = with_time(
          {real("spin_1_radps", "rad/s", w1, 0.01, 100.0, "spin about the smallest moment"),
           real("spin_3_radps", "rad/s", w3, 0.01, 100.0, "spin about the largest moment")},
          0.001, 2.0),
      .observables = {{"attitude_error_rad", "rad", "angle to the exact attitude at the end"},
                      {"spin_1_radps", "rad/s", "spin in body axes at the end"},
                      {"spin_2_radps", "rad/s", "spin in body axes at the end"},
                      {"spin_3_radps", "rad/s", "spin in body axes at the end"},
                      {"energy_j", "J", "kinetic energy at the end"},
                      {"momentum_error_nms", "N m s", "change of the angular momentum"}},
      .make = make_torque_free,
      .own_time_s = torque_free_own_s,
      .outside = near_separatrix,
      .threshold = std::nullopt,
      .expected_violation = "an explicit gyroscopic term gains energy, an implicit one loses it"};
}

}  // namespace

ExactCase uniform_spin() {
  return {
      .id = "rotation.uniform_spin",
      .title = "Spin about a principal axis",
      .source = "Euler, Theoria motus corporum (1765)",
      .claim = "A body spinning about a principal axis keeps its spin and turns by w t.",
      .formula = "angle = w t",
      .needs = {},
      .parameters = with_time({real("spin_radps", "rad/s", 5.0, 0.01, 300.0, "spin")}, 0.001, 2.0),
      .observables = {{"angle_rad", "rad", "angle turned, added up over the steps"},
                      {"spin_radps", "rad/s", "spin at the end"},
                      {"spin_across_radps", "rad/s", "spin about the other axes"}},
      .make = make_uniform_spin,
      .own_time_s = spin_own_s,
      .outside =
          [](const ParameterValues& p) {
            return half_turns(value_of(p, "spin_radps") * value_of(p, "step_s"));
          },
      .threshold = std::nullopt,
      .expected_violation = "a normalised Euler step turns by 2 atan(w dt/2) instead of w dt"};
}

ExactCase spin_up() {
  return {
      .id = "rotation.spin_up",
      .title = "Constant torque about a principal axis",
      .source = "Euler, Theoria motus corporum (1765)",
      .claim = "A torque applied through the seam gives the spin T t / I.",
      .formula = "w = T t/I, angle = T t^2/(2 I)",
      .needs = {.applied_forces = true},
      .parameters = with_time({real("torque_nm", "N m", 0.01, 1e-6, 1.0, "torque")}, 0.001, 1.0),
      .observables = {{"angle_rad", "rad", "angle turned, added up over the steps"},
                      {"spin_radps", "rad/s", "spin at the end"}},
      .make = make_spin_up,
      .own_time_s = torque_own_s,
      .threshold = std::nullopt,
      .expected_violation = ""};
}

ExactCase torque_free_third_axis() {
  return torque_free("rotation.torque_free_3", "Torque-free brick, about the largest moment",
                     "A free asymmetric body follows Jacobi's elliptic functions; energy and "
                     "angular momentum stay.",
                     2.0, 6.0);
}

ExactCase torque_free_first_axis() {
  return torque_free("rotation.torque_free_1", "Torque-free brick, about the smallest moment",
                     "As before on the other side of the separatrix, where 1 and 3 exchange roles.",
                     6.0, 1.0);
}

ExactCase axis_flip() {
  ExactCase flip = torque_free("rotation.axis_flip", "Flips of the middle axis",
                               "Near the separatrix the body turns over again and again; the time "
                               "from flip to flip is 2 K(m)/p.",
                               4.0, 2.3);
  flip.formula = "T = 4 K(m) sqrt(I1 I2 I3/((I3 - I2)(M^2 - 2 E I1))), w2 = 0 at T/2, T, ...";
  flip.parameters =
      with_time({real("spin_1_radps", "rad/s", 4.0, 0.01, 100.0, "spin about the smallest moment"),
                 real("spin_3_radps", "rad/s", 2.3, 0.01, 100.0, "spin about the largest moment")},
                0.001, 6.0);
  flip.observables = {{"first_flip_s", "s", "first sign change of the middle spin"},
                      {"second_flip_s", "s", "second sign change"}};
  flip.make = make_axis_flip;
  flip.own_time_s = flip_own_s;
  flip.outside = never_flips;
  flip.expected_violation = "schemes that gain or lose energy flip too early or too late";
  return flip;
}

ExactCase symmetric_precession() {
  return {.id = "rotation.symmetric_precession",
          .title = "Precession of a square prism",
          .source = "Kane, Likins & Levinson, Spacecraft Dynamics (1983), section 3.1",
          .claim =
              "The axis of a symmetric free body precesses about the momentum at L/I1 while "
              "the body turns about its axis at (I1 - I3)/I1 w3.",
          .formula = "q(t) = exp(L/I1 t) q0 exp((I1 - I3)/I1 w3 t)",
          .needs = {},
          .parameters = with_time(
              {real("spin_across_radps", "rad/s", 3.0, 0.01, 100.0, "spin across the axis"),
               real("spin_along_radps", "rad/s", 8.0, 0.01, 100.0, "spin along the axis")},
              0.001, 2.0),
          .observables = {{"attitude_error_rad", "rad", "angle to the exact attitude at the end"},
                          {"axis_error_rad", "rad", "angle between axis and exact axis"},
                          {"spin_along_radps", "rad/s", "spin along the axis at the end"}},
          .make = make_symmetric,
          .own_time_s = precession_own_s,
          .threshold = std::nullopt,
          .expected_violation = ""};
}

}  // namespace brickbench::exact
