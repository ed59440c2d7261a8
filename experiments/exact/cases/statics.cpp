// Bodies at rest: the resultants of contact forces are known even where single forces are not.
#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/exact/cases/builders.hpp"
#include "experiments/exact/cases/cases.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// Averages the impulse of a pair over the second half of the run, as a force.
class MeanForce {
 public:
  MeanForce(std::size_t a, std::size_t b, const ExactRun& run)
      : a_(a), b_(b), from_(run.steps / 2), step_s_(run.step_s) {}

  Vector3d see(const Sample& sample) {
    if (sample.step <= from_) return Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    sum_ += pair_impulse_ns(sample, a_, b_) / step_s_;
    ++count_;
    return sum_ / static_cast<double>(count_);
  }

 private:
  std::size_t a_, b_, from_;
  double step_s_;
  Vector3d sum_ = Vector3d::Zero();
  std::size_t count_ = 0;
};

ExactRun make_block(const ParameterValues& p) {
  ExactRun run = start_run(p);
  const double mass = value_of(p, "mass_kg"), angle = value_of(p, "angle_rad");
  const Vector3d half(0.25, 0.25, 0.125);
  run.world.gravity_mps2 = tilted_gravity_mps2(angle);
  run.world.law = {.friction = 1.0, .restitution = 0.0};
  run.world.bodies = {floor_slab(), box("brick", half, mass, at({0.0, 0.0, half.z()}))};
  // The moment balance puts the resultant where the weight's line meets the floor.
  run.measure = [force = MeanForce(0, 1, run), from = run.steps / 2, moment = 0.0, load = 0.0](
                    const Sample& s, std::span<double> v) mutable {
    const Vector3d mean = force.see(s);
    v[0] = mean.z();
    v[1] = mean.x();
    v[3] = s.states[1].position_m.head<2>().norm();
    if (s.contacts == nullptr || s.step <= from) return;
    for (const Contact& contact : *s.contacts) {
      const double push = std::abs(contact.impulse_ns.z());
      moment += push * (contact.position_m.x() - s.states[1].position_m.x());
      load += push;
    }
    v[2] = moment / load;
  };
  const double weight = mass * k_gravity_mps2;
  const double t = static_cast<double>(run.steps) * run.step_s;
  run.truths = {{weight * std::cos(angle), weight},
                {-weight * std::sin(angle), weight},
                {half.z() * std::tan(angle), half.x()},
                {0.0, 0.5 * k_gravity_mps2 * t * t}};
  run.trajectory = [](double, std::span<State>) {};
  return run;
}

// Bricks of the given masses, one on the other; interface i carries what lies above it.
ExactRun make_stack(const ParameterValues& p, const std::vector<double>& masses) {
  ExactRun run = start_run(p);
  const Vector3d half(0.25, 0.25, 0.125);
  run.world.law = {.friction = 0.5, .restitution = 0.0};
  run.world.bodies = {floor_slab()};
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const double z = half.z() * (2.0 * static_cast<double>(i) + 1.0);
    run.world.bodies.push_back(
        box("brick " + std::to_string(i), half, masses[i], at({0.0, 0.0, z})));
  }
  std::vector<double> loads(masses.size());
  double above = 0.0;
  for (std::size_t i = masses.size(); i-- > 0;) {
    above += masses[i] * k_gravity_mps2;
    loads[i] = above;
  }
  std::vector<MeanForce> forces;
  for (std::size_t i = 0; i < masses.size(); ++i) forces.emplace_back(i, i + 1, run);
  const World world = run.world;
  run.measure = [forces, loads, world](const Sample& s, std::span<double> v) mutable {
    double worst = 0.0;
    for (std::size_t i = 0; i < forces.size(); ++i) {
      const double error = std::abs(forces[i].see(s).z() / loads[i] - 1.0);
      worst = std::isnan(error) ? error : std::max(worst, error);
      if (std::isnan(worst)) break;
    }
    v[0] = worst;
    const std::size_t top = s.states.size() - 1;
    v[1] = world.bodies[top].initial.position_m.z() - s.states[top].position_m.z();
    v[2] = s.states[top].position_m.head<2>().norm();
  };
  run.truths = {{0.0, 1.0}, {0.0, 2.0 * half.z()}, {0.0, 2.0 * half.z()}};
  run.trajectory = [](double, std::span<State>) {};
  return run;
}

ExactRun make_tower(const ParameterValues& p) {
  return make_stack(p, std::vector<double>(static_cast<std::size_t>(value_of(p, "bricks")), 1.0));
}

ExactRun make_heavy_on_light(const ParameterValues& p) {
  return make_stack(p, {1.0, value_of(p, "mass_ratio")});
}

// Two fixed boxes form a groove; their upper faces rise by the angle to both sides.
ExactRun make_groove(const ParameterValues& p) {
  ExactRun run = start_run(p);
  const double angle = value_of(p, "angle_rad");
  constexpr double k_radius_m = 0.125;
  constexpr double k_mass_kg = 2.0;
  const Vector3d half(0.5, 0.5, 0.05);
  for (const double side : {1.0, -1.0}) {
    const Quaterniond turn(Eigen::AngleAxisd(-side * angle, Vector3d::UnitY()));
    // The face passes through the origin; the box extends to its side.
    State state = at(turn * Vector3d(side * half.x(), 0.0, -half.z()));
    state.orientation = turn;
    run.world.bodies.push_back(fixed_body(side > 0.0 ? "right" : "left", BoxShape{half}, state));
  }
  run.world.bodies.push_back(
      ball("ball", k_radius_m, k_mass_kg, at({0.0, 0.0, k_radius_m / std::cos(angle)})));
  run.measure = [right = MeanForce(0, 2, run), left = MeanForce(1, 2, run),
                 start = run.world.bodies[2].initial.position_m](const Sample& s,
                                                                 std::span<double> v) mutable {
    v[0] = right.see(s).norm();
    v[1] = left.see(s).norm();
    v[2] = (s.states[2].position_m - start).norm();
  };
  const double force = 0.5 * k_mass_kg * k_gravity_mps2 / std::cos(angle);
  run.truths = {{force, force}, {force, force}, {0.0, k_radius_m}};
  run.trajectory = [](double, std::span<State>) {};
  return run;
}

constexpr double k_slab_half_m = 0.5;
constexpr double k_slab_half_thickness_m = 0.03;

double critical_ladder_friction(const ParameterValues& p) {
  const double angle = value_of(p, "angle_rad");
  return (std::cos(angle) - k_slab_half_thickness_m / k_slab_half_m * std::sin(angle)) /
         (2.0 * std::sin(angle));
}

// The slab leans to the right against a smooth wall; both touching edges lie on its lower face.
ExactRun make_leaning_slab(const ParameterValues& p) {
  ExactRun run = start_run(p);
  const double angle = value_of(p, "angle_rad");
  const double l = k_slab_half_m, t = k_slab_half_thickness_m;
  run.world.law = {.friction = value_of(p, "friction"), .restitution = 0.0};
  run.world.exceptions = {{.surface_a = 0, .surface_b = 1, .law = {}}};
  State state = at({0.0, 0.0, l * std::sin(angle) + t * std::cos(angle)});
  state.orientation = Quaterniond(Eigen::AngleAxisd(-angle, Vector3d::UnitY()));
  Body wall = fixed_body("wall", BoxShape{{0.5, 2.0, 2.0}},
                         at({l * std::cos(angle) + t * std::sin(angle) + 0.5, 0.0, 1.0}));
  wall.surface = 1;
  run.world.bodies = {floor_slab(), wall, box("slab", Vector3d(l, 0.2, t), 3.0, state)};
  run.measure = [start = state.position_m](const Sample& s, std::span<double> v) {
    v[0] = (s.states[2].position_m - start).norm();
  };
  const bool slips = value_of(p, "friction") < critical_ladder_friction(p);
  run.truths = {{slips ? std::numeric_limits<double>::quiet_NaN() : 0.0, l}};
  return run;
}

// Instability grows like exp(3.8 t): from 1e-4 of the weight it passes this well within the run.
bool slab_fell(std::span<const double> v) { return !(v[0] < 0.02); }

std::vector<Observable> stack_observables() {
  return {{"interface_force_error", "1", "worst |N_i/(weight above) - 1|, mean of the second half"},
          {"sinking_m", "m", "of the top brick"},
          {"drift_m", "m", "horizontal, of the top brick"}};
}

const Needs k_forces = {.contacts = Contacts::several, .friction = true, .contact_forces = true};
const std::string k_statics = "Varignon, Nouvelle mecanique (1725): balance of forces and moments";

ExactCase block(std::string id, std::string title, std::string claim, double angle) {
  return {.id = std::move(id),
          .title = std::move(title),
          .source = k_statics,
          .claim = std::move(claim),
          .formula = "N = m g cos th, T = m g sin th, centre of pressure h tan th downhill",
          .needs = k_forces,
          .parameters = with_time({real("mass_kg", "kg", 3.0, 0.01, 1e4, "mass of the brick"),
                                   real("angle_rad", "rad", angle, 0.0, 0.7, "inclination")},
                                  0.001, 1.0),
          .observables = {{"normal_force_n", "N", "sum over the contacts, second half of the run"},
                          {"friction_force_n", "N", "sum over the contacts, down the incline"},
                          {"centre_of_pressure_m", "m", "downhill from the centre of the brick"},
                          {"drift_m", "m", "along the plane at the end"}},
          .make = make_block,
          .threshold = std::nullopt,
          .expected_violation = "regularised friction creeps"};
}

}  // namespace

ExactCase block_at_rest() {
  return block("statics.block", "Brick at rest",
               "The contact forces sum up to the weight, under the centre.", 0.0);
}

ExactCase block_on_slope() {
  return block("statics.slope", "Brick at rest on a slope",
               "Normal and friction forces balance the weight; their moment balances the lever.",
               0.3);
}

ExactCase tower() {
  Parameter bricks = real("bricks", "1", 5.0, 1.0, 50.0, "number of bricks");
  bricks.kind = ParameterKind::integer;
  return {.id = "statics.tower",
          .title = "Tower of equal bricks",
          .source = k_statics,
          .claim = "Interface i carries exactly the weight of the bricks above it.",
          .formula = "N_i = (n - i) m g",
          .needs = k_forces,
          .parameters = with_time({bricks}, 0.001, 1.0),
          .observables = stack_observables(),
          .make = make_tower,
          .threshold = std::nullopt,
          .expected_violation = ""};
}

ExactCase heavy_on_light() {
  return {
      .id = "statics.heavy_on_light",
      .title = "Heavy brick on a light one",
      .source = k_statics,
      .claim = "The loads do not care about the mass ratio, iterative solvers do.",
      .formula = "N_1 = M g, N_0 = (M + m) g",
      .needs = k_forces,
      .parameters = with_time(
          {real("mass_ratio", "1", 1000.0, 1e-3, 1e6, "upper mass over lower mass")}, 0.001, 1.0),
      .observables = stack_observables(),
      .make = make_heavy_on_light,
      .threshold = std::nullopt,
      .expected_violation = "few iterations do not converge for large ratios"};
}

ExactCase ball_in_groove() {
  return {.id = "statics.groove",
          .title = "Ball in a groove",
          .source = k_statics,
          .claim = "Two smooth planes share the weight.",
          .formula = "N = W/(2 cos th)",
          .needs = {.contacts = Contacts::several, .spheres = true, .contact_forces = true},
          .parameters = with_time({real("angle_rad", "rad", 0.7, 0.1, 1.3, "slope of both planes")},
                                  0.001, 1.0),
          .observables = {{"force_right_n", "N", "mean of the second half of the run"},
                          {"force_left_n", "N", "mean of the second half of the run"},
                          {"drift_m", "m", "of the centre at the end"}},
          .make = make_groove,
          .threshold = std::nullopt,
          .expected_violation = ""};
}

ExactCase leaning_slab() {
  Threshold threshold;
  threshold.parameter = "friction";
  threshold.critical = critical_ladder_friction;
  threshold.happened = slab_fell;
  threshold.above = false;
  threshold.high_factor = 1.5;
  return {
      .id = "statics.leaning_slab",
      .title = "Slab leaning on a smooth wall",
      .source = k_statics,
      .claim = "The slab stays while the floor's friction bears the wall's push.",
      .formula = "mu_c = (cos th - (t/L) sin th)/(2 sin th), thin: 1/(2 tan th)",
      .needs = {.contacts = Contacts::several, .friction = true},
      .parameters = with_time({real("angle_rad", "rad", 0.9, 0.3, 1.3, "inclination of the slab"),
                               real("friction", "1", 0.6, 0.0, 3.0, "on the floor")},
                              0.001, 3.0),
      .observables = {{"moved_m", "m", "displacement of the centre at the end"}},
      .make = make_leaning_slab,
      .threshold = threshold,
      .expected_violation = "creep of regularised friction lets it slide down slowly"};
}

}  // namespace brickbench::exact
