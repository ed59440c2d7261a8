// Bricks that tip over an edge: thresholds, impacts on edges, rocking.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "experiments/exact/cases/builders.hpp"
#include "experiments/exact/cases/cases.hpp"

namespace brickbench::exact {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

// A lean of this size cannot come back for the slender bricks used here.
bool fell(std::span<const double> v) { return !(v[0] < 0.5); }

Measure largest_lean(const World& initial) {
  return [initial](const Sample& s, std::span<double> v) {
    for (std::size_t i = 0; i < s.states.size(); ++i) {
      if (initial.bodies[i].fixed) continue;
      const double lean = lean_rad(s.states[i]);
      if (std::isnan(v[0]) || lean > v[0]) v[0] = lean;
    }
  };
}

// A column of n bricks leaning with the ground: gravity turns, the ground stays level.
ExactRun tilted_column(const ParameterValues& p, std::size_t bricks, const Vector3d& half) {
  ExactRun run = start_run(p);
  run.world.gravity_mps2 = tilted_gravity_mps2(value_of(p, "angle_rad"));
  run.world.law = {.friction = 1.5, .restitution = 0.0};
  run.world.bodies = {floor_slab()};
  for (std::size_t i = 0; i < bricks; ++i) {
    const double z = half.z() * (2.0 * static_cast<double>(i) + 1.0);
    run.world.bodies.push_back(box("brick " + std::to_string(i), half, 1.0, at({0.0, 0.0, z})));
  }
  run.measure = largest_lean(run.world);
  const double critical = std::atan(half.x() / (half.z() * static_cast<double>(bricks)));
  run.truths = {{value_of(p, "angle_rad") < critical ? 0.0 : k_nan, 1.0}};
  return run;
}

const Vector3d k_slender_half_m(0.0625, 0.125, 0.25);
const Vector3d k_flat_half_m(0.125, 0.125, 0.0625);
constexpr std::size_t k_column_bricks = 5;

ExactRun make_topple(const ParameterValues& p) { return tilted_column(p, 1, k_slender_half_m); }
double critical_topple_rad(const ParameterValues&) {
  return std::atan(k_slender_half_m.x() / k_slender_half_m.z());
}

ExactRun make_column(const ParameterValues& p) {
  return tilted_column(p, k_column_bricks, k_flat_half_m);
}
double critical_column_rad(const ParameterValues&) {
  return std::atan(k_flat_half_m.x() / (k_flat_half_m.z() * k_column_bricks));
}

// Harmonic stack: brick i from the top reaches b/(2 i) over the one below, times `reach`.
ExactRun make_overhang(const ParameterValues& p) {
  ExactRun run = start_run(p);
  const double reach = value_of(p, "reach");
  const Vector3d half(0.25, 0.125, 0.0625);
  constexpr int k_bricks = 4;
  run.world.law = {.friction = 0.8, .restitution = 0.0};
  run.world.bodies = {fixed_body("table", BoxShape{{0.25, 0.5, 0.5}}, at({0.0, 0.0, -0.5}))};
  double x = 0.0;
  for (int i = 0; i < k_bricks; ++i) {
    x += reach * half.x() / (k_bricks - i);
    run.world.bodies.push_back(
        box("brick " + std::to_string(i), half, 1.0, at({x, 0.0, half.z() * (2.0 * i + 1.0)})));
  }
  run.measure = largest_lean(run.world);
  run.truths = {{reach < 1.0 ? 0.0 : k_nan, 1.0}};
  return run;
}
double critical_reach(const ParameterValues&) { return 1.0; }

// An upright brick turning about its lower edge with a given spin: it passes the upright diagonal
// iff (1/2) I_o w^2 > m g (R - h).
ExactRun make_kick(const ParameterValues& p) {
  ExactRun run = start_run(p);
  const double spin = value_of(p, "spin_radps");
  const Vector3d& half = k_slender_half_m;
  run.world.law = {.friction = 1.5, .restitution = 0.0};
  const Vector3d omega(0.0, spin, 0.0);
  const Vector3d arm(-half.x(), 0.0, half.z());  // from the edge at +x to the centre
  run.world.bodies = {floor_slab(),
                      box("brick", half, 1.0, at({0.0, 0.0, half.z()}, omega.cross(arm), omega))};
  run.measure = largest_lean(run.world);
  run.truths = {{k_nan, 1.0}};
  return run;
}
double critical_spin_radps(const ParameterValues&) {
  const double b = k_slender_half_m.x(), h = k_slender_half_m.z();
  const double r2 = b * b + h * h;
  return std::sqrt(1.5 * k_gravity_mps2 * (std::sqrt(r2) - h) / r2);
}

// A smooth brick slides into a low curb: it turns about the upper edge of the curb while its front
// edge stays on the floor.
ExactRun make_curb(const ParameterValues& p) {
  ExactRun run = start_run(p);
  const double speed = value_of(p, "speed_mps"), curb = value_of(p, "curb_m");
  const Vector3d half(0.125, 0.125, 0.125);
  const double gap = 10.5 * speed * run.step_s;
  run.world.bodies = {floor_slab(),
                      box("brick", half, 2.0, at({0.0, 0.0, half.z()}, {speed, 0, 0})),
                      fixed_body("curb", BoxShape{{0.1, 0.5, 0.5 * curb}},
                                 at({half.x() + gap + 0.1, 0.0, 0.5 * curb}))};
  run.measure = [](const Sample& s, std::span<double> v) {
    if (s.step == 0) v[0] = 0.0;
    v[0] = std::max(v[0], s.states[1].angular_velocity_radps.y());
  };
  const double above = half.z() - curb;
  const double inertia = run.world.bodies[1].inertia_kgm2.y() / 2.0;  // per mass
  const double spin = speed * above / (inertia + half.x() * half.x() + above * above);
  run.truths = {{spin, spin}};
  return run;
}

// Brick leaning by `lean` about its lower edge (at the origin), at rest.
ExactRun leaning_brick(const ParameterValues& p, double lean, double friction) {
  ExactRun run = start_run(p);
  const Vector3d& half = k_slender_half_m;
  run.world.law = {.friction = friction, .restitution = 0.0};
  const Quaterniond turn(AngleAxisd(lean, Vector3d::UnitY()));
  State state = at(turn * Vector3d(-half.x(), 0.0, half.z()));
  state.orientation = turn;
  run.world.bodies = {floor_slab(), box("brick", half, 1.0, state)};
  return run;
}

struct Pendulum {
  double alpha = std::atan(k_slender_half_m.x() / k_slender_half_m.z());
  double radius_m = k_slender_half_m.head<3>().cwiseProduct(Vector3d(1, 0, 1)).norm();
  // w^2 gained from one lean to another: I_o = 4 m R^2/3.
  double spin_squared(double from, double to) const {
    return 1.5 * k_gravity_mps2 / radius_m * (std::cos(from - alpha) - std::cos(to - alpha));
  }
  // Time from rest at one lean to another; the substitution lean = from + s u^2 removes the
  // singularity of 1/w at the start. Gauss-Legendre, five points on 64 panels.
  double time_s(double from, double to) const {
    constexpr std::array<double, 5> nodes = {-0.90617984593866399, -0.53846931010568309, 0.0,
                                             0.53846931010568309, 0.90617984593866399};
    constexpr std::array<double, 5> weights = {0.23692688505618909, 0.47862867049936647,
                                               0.56888888888888889, 0.47862867049936647,
                                               0.23692688505618909};
    const double end = std::sqrt(std::abs(to - from));
    const double sign = to > from ? 1.0 : -1.0;
    constexpr int k_panels = 64;
    const double half = 0.5 * end / k_panels;
    double sum = 0.0;
    for (int panel = 0; panel < k_panels; ++panel) {
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        const double u = half * (2.0 * panel + 1.0 + nodes[i]);
        sum += weights[i] * 2.0 * u / std::sqrt(spin_squared(from, from + sign * u * u));
      }
    }
    return sum * half;
  }
};

double signed_lean_rad(const State& state) {
  const Vector3d axis = state.orientation * Vector3d::UnitZ();
  return std::atan2(axis.x(), axis.z());
}

ExactRun make_free_topple(const ParameterValues& p) {
  const Pendulum exact;
  const double from = exact.alpha + value_of(p, "beyond_rad");
  const double to = exact.alpha + 0.6;
  ExactRun run = leaning_brick(p, from, 1.5);
  // Time and spin where the lean passes `to`, linear between samples.
  run.measure = [to, last = State{}, last_s = 0.0](const Sample& s, std::span<double> v) mutable {
    const State& now = s.states[1];
    const double lean = signed_lean_rad(now);
    if (s.step > 0 && std::isnan(v[0]) && lean >= to) {
      const double before = signed_lean_rad(last);
      const double share = (to - before) / (lean - before);
      v[0] = last_s + share * (s.time_s - last_s);
      v[1] =
          (1.0 - share) * last.angular_velocity_radps.y() + share * now.angular_velocity_radps.y();
    }
    last = now;
    last_s = s.time_s;
  };
  const double spin = std::sqrt(exact.spin_squared(from, to));
  const double time = exact.time_s(from, to);
  run.truths = {{time, time}, {spin, spin}};
  return run;
}

// The spin is read so long after the impact, which takes a step or two.
constexpr double k_rocking_wait_s = 0.01;

ExactRun make_rocking(const ParameterValues& p) {
  const Pendulum exact;
  const double from = value_of(p, "lean_share") * exact.alpha;
  ExactRun run = leaning_brick(p, from, 1.5);
  // The largest spin before upright; and the spin 0.01 s later, taken back to upright by the energy
  // of the rocking in between, so that the steps which the impact takes do not matter.
  run.measure = [exact, upright = k_nan, before = 0.0](const Sample& s,
                                                       std::span<double> v) mutable {
    const double lean = signed_lean_rad(s.states[1]);
    const double spin = std::abs(s.states[1].angular_velocity_radps.y());
    if (std::isnan(upright) && lean <= 0.0) upright = s.time_s;
    if (std::isnan(upright)) before = std::max(before, spin);
    v[0] = upright;
    if (s.time_s > upright + k_rocking_wait_s && std::isnan(v[1])) {
      v[1] = std::sqrt(spin * spin - exact.spin_squared(0.0, std::abs(lean))) / before;
    }
  };
  const double time = exact.time_s(from, 0.0);
  run.truths = {{time, time}, {1.0 - 1.5 * std::pow(std::sin(exact.alpha), 2), 1.0}};
  return run;
}

double topple_own_s(const ParameterValues& p) {
  const Pendulum exact;
  return exact.time_s(exact.alpha + value_of(p, "beyond_rad"), exact.alpha + 0.6);
}
double rocking_own_s(const ParameterValues& p) {
  const Pendulum exact;
  return exact.time_s(value_of(p, "lean_share") * exact.alpha, 0.0);
}

std::string rocking_too_coarse(const ParameterValues& p) {
  return value_of(p, "step_s") > 0.2 * k_rocking_wait_s
             ? "the impact's steps last longer than the wait before its spin is read"
             : "";
}

// The law is of the impact alone: gravity must not change the brick's motion much meanwhile.
std::string curb_outside(const ParameterValues& p) {
  constexpr double k_share = 0.2;
  const double speed = value_of(p, "speed_mps");
  if (k_gravity_mps2 * value_of(p, "duration_s") > k_share * speed) {
    return "gravity changes the velocity by more than a fifth within the run";
  }
  return outruns(p, speed, 0.2 * value_of(p, "curb_m"));
}

Threshold threshold_of(std::string parameter, double (*critical)(const ParameterValues&)) {
  Threshold threshold;
  threshold.parameter = std::move(parameter);
  threshold.critical = critical;
  threshold.happened = fell;
  return threshold;
}

const Needs k_edges = {.contacts = Contacts::several, .friction = true};
const std::vector<Observable> k_lean = {{"lean_rad", "rad", "largest lean of any brick"}};

ExactCase tipping(std::string id, std::string title, std::string source, std::string claim,
                  std::string formula, Parameter parameter, double step, double duration,
                  ExactRun (*make)(const ParameterValues&),
                  double (*critical)(const ParameterValues&)) {
  Threshold threshold = threshold_of(parameter.name, critical);
  threshold.high_factor = 1.5;
  return {.id = std::move(id),
          .title = std::move(title),
          .source = std::move(source),
          .claim = std::move(claim),
          .formula = std::move(formula),
          .needs = k_edges,
          .parameters = with_time({std::move(parameter)}, step, duration),
          .observables = k_lean,
          .make = make,
          .threshold = threshold,
          .expected_violation = "contacts that yield let it fall a little early"};
}

}  // namespace

ExactCase topple_threshold() {
  return tipping("tipping.incline", "Brick on an incline topples",
                 "moment balance about the lower edge",
                 "A brick that cannot slip topples when its weight passes the edge.",
                 "tan th = b/h", real("angle_rad", "rad", 0.2, 0.0, 1.2, "inclination"), 0.001, 2.5,
                 make_topple, critical_topple_rad);
}

ExactCase column_tilt() {
  return tipping("tipping.column", "Column of bricks on a tilt table",
                 "limit analysis of dry masonry: Heyman, The Stone Skeleton (1966)",
                 "A column overturns as one piece about its lowest edge.", "tan th = b/(n h)",
                 real("angle_rad", "rad", 0.3, 0.0, 1.2, "inclination"), 0.001, 2.5, make_column,
                 critical_column_rad);
}

ExactCase overhang() {
  return tipping("tipping.overhang", "Harmonic overhang of four bricks",
                 "Paterson, Peres, Thorup, Winkler & Zwick, Maximum overhang (2009), section 1",
                 "Four bricks reach b (1 + 1/2 + 1/3 + 1/4) of half their length over the table.",
                 "reach_c = 1", real("reach", "1", 0.9, 0.0, 2.0, "overhang over the harmonic one"),
                 0.001, 3.0, make_overhang, critical_reach);
}

ExactCase kick_threshold() {
  return tipping(
      "tipping.kick", "Brick kicked about its edge",
      "energy: I_o = 4 m R^2/3; Housner, Bull. Seism. Soc. Am. 53 (1963)",
      "A brick turning about its edge falls over when its energy lifts it past the edge.",
      "w_c^2 = 3 g (R - h)/(2 R^2)",
      real("spin_radps", "rad/s", 1.0, 0.0, 20.0, "spin about the edge"), 0.001, 3.0, make_kick,
      critical_spin_radps);
}

ExactCase curb_impact() {
  return {.id = "tipping.curb",
          .title = "Brick hits a curb",
          .source =
              "angular momentum about the curb's edge; c = 0 and a cube of edge a: w+ = 3 v/(4 a)",
          .claim = "Inelastic contact at curb and floor turns the velocity into one spin.",
          .formula = "w+ = v (h - c)/(I/m + b^2 + (h - c)^2)",
          .needs = {.contacts = Contacts::several},
          .parameters = with_time({real("speed_mps", "m/s", 1.0, 0.1, 5.0, "speed of the brick"),
                                   real("curb_m", "m", 0.02, 0.005, 0.1, "height of the curb")},
                                  0.0005, 0.012),
          .observables = {{"spin_radps", "rad/s", "largest spin of the run"}},
          .make = make_curb,
          .own_time_s = one_step_s,
          .outside = curb_outside,
          .threshold = std::nullopt,
          .expected_violation = ""};
}

ExactCase free_topple() {
  return {.id = "tipping.free_fall_over",
          .title = "Brick falling over",
          .source = "energy: I_o = 4 m R^2/3; Housner, Bull. Seism. Soc. Am. 53 (1963)",
          .claim = "A brick released beyond its balance turns about the edge like a pendulum.",
          .formula = "w^2 = 3 g/(2 R) (cos(th0 - a) - cos(th - a))",
          .needs = k_edges,
          .parameters = with_time(
              {real("beyond_rad", "rad", 0.1, 0.02, 0.4, "lean at the start beyond the balance")},
              0.001, 1.5),
          .observables = {{"time_s", "s", "until the lean passes 0.6 rad beyond the balance"},
                          {"spin_radps", "rad/s", "at that lean"}},
          .make = make_free_topple,
          .own_time_s = topple_own_s,
          .threshold = std::nullopt,
          .expected_violation = ""};
}

ExactCase rocking_block() {
  return {.id = "tipping.rocking",
          .title = "Housner's rocking block",
          .source = "Housner, Bull. Seism. Soc. Am. 53 (1963), eq. 5 and 10",
          .claim =
              "The brick falls back upright, and an inelastic impact on the other edge keeps "
              "1 - (3/2) sin^2 a of its spin.",
          .formula = "w+/w- = 1 - (3/2) sin^2 a",
          .needs = k_edges,
          .parameters = with_time(
              {real("lean_share", "1", 0.6, 0.1, 0.95, "lean at the start over that of balance")},
              0.0005, 0.6),
          .observables = {{"quarter_period_s", "s", "first sample at or past upright"},
                          {"spin_ratio", "1", "spin after the impact over spin before"}},
          .make = make_rocking,
          .own_time_s = rocking_own_s,
          .outside = rocking_too_coarse,
          .threshold = std::nullopt,
          .expected_violation =
              "both edges may take part in the impact (Lipscombe & Pellegrino "
              "1993), then the ratio differs"};
}

}  // namespace brickbench::exact
