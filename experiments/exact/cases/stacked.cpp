// One brick on another, the lower one pulled over a smooth floor.
#include <cmath>

#include "experiments/exact/cases/builders.hpp"
#include "experiments/exact/cases/cases.hpp"

namespace brickbench::exact {
namespace {

using Eigen::Vector3d;

constexpr double k_lower_kg = 4.0;
constexpr double k_upper_kg = 2.0;
const Vector3d k_lower_half_m(1.0, 0.5, 0.03125);
const Vector3d k_upper_half_m(0.5, 0.25, 0.03125);
// The way that the upper brick has until its end passes that of the lower one.
const double k_overlap_m = k_lower_half_m.x() - k_upper_half_m.x();

double critical_force_n(const ParameterValues& p) {
  return value_of(p, "friction") * k_gravity_mps2 * (k_lower_kg + k_upper_kg);
}

ExactRun make_pull(const ParameterValues& p) {
  ExactRun run = start_run(p);
  const double friction = value_of(p, "friction"), force = value_of(p, "force_n");
  const Vector3d &lower_half = k_lower_half_m, &upper_half = k_upper_half_m;
  run.world.law = {.friction = friction, .restitution = 0.0};
  run.world.exceptions = {{.surface_a = 0, .surface_b = 1, .law = {}}};
  run.world.bodies = {
      floor_slab(), box("lower", lower_half, k_lower_kg, at({0.0, 0.0, lower_half.z()})),
      box("upper", upper_half, k_upper_kg, at({0.0, 0.0, 2.0 * lower_half.z() + upper_half.z()}))};
  run.world.bodies[0].surface = 1;
  run.load = [=](std::size_t, double, std::span<Wrench> w) { w[1].force_n.x() = force; };
  run.measure = latest([](const Sample& s, std::span<double> v) {
    v[0] = s.states[1].velocity_mps.x();
    v[1] = s.states[2].velocity_mps.x();
    v[2] = v[0] - v[1];
  });
  const double t = static_cast<double>(run.steps) * run.step_s;
  const bool together = force <= critical_force_n(p);
  const double grip = friction * k_gravity_mps2;
  const double a_lower =
      together ? force / (k_lower_kg + k_upper_kg) : (force - k_upper_kg * grip) / k_lower_kg;
  const double a_upper = together ? a_lower : grip;
  const double scale = force / (k_lower_kg + k_upper_kg) * t;
  run.truths = {{a_lower * t, scale}, {a_upper * t, scale}, {(a_lower - a_upper) * t, scale}};
  return run;
}

// The upper brick rests on the lower one with its whole face, and the lower one stays on the floor.
std::string pull_leaves(const ParameterValues& p) {
  const double force = value_of(p, "force_n"), t = value_of(p, "duration_s");
  const double grip = value_of(p, "friction") * k_gravity_mps2;
  const bool together = force <= critical_force_n(p);
  const double lower =
      together ? force / (k_lower_kg + k_upper_kg) : (force - k_upper_kg * grip) / k_lower_kg;
  const double slip = together ? 0.0 : lower - grip;
  if (0.5 * slip * t * t > k_overlap_m)
    return "the upper brick slides over the end of the lower one";
  return leaves_floor(0.5 * lower * t * t);
}

// At 1e-4 above the critical force the bricks part with 1.5e-4 mu g each second.
bool parted(std::span<const double> v) { return !(std::abs(v[2]) < 1e-4); }

ExactCase pull(std::string id, std::string title, std::string claim, double force) {
  return {
      .id = std::move(id),
      .title = std::move(title),
      .source = "Coulomb, Theorie des machines simples (1785); moment balance of both bricks",
      .claim = std::move(claim),
      .formula = "together iff F <= mu (m + M) g; else a_top = mu g, a_bottom = (F - mu m g)/M",
      .needs = {.contacts = Contacts::several, .friction = true, .applied_forces = true},
      .parameters = with_time({real("friction", "1", 0.4, 0.05, 2.0, "friction between the bricks"),
                               real("force_n", "N", force, 0.1, 1e3, "pull on the lower brick")},
                              0.001, 0.4),
      .observables = {{"speed_lower_mps", "m/s", "at the end"},
                      {"speed_upper_mps", "m/s", "at the end"},
                      {"slip_mps", "m/s", "difference of both"}},
      .make = make_pull,
      .outside = pull_leaves,
      .threshold = std::nullopt,
      .expected_violation = ""};
}

}  // namespace

ExactCase stack_pulled_together() {
  return pull("friction.pull_together", "Two bricks pulled together",
              "Below the critical force friction carries the upper brick along without slip.",
              15.0);
}

ExactCase stack_pulled_apart() {
  return pull("friction.pull_apart", "Lower brick pulled away",
              "Above the critical force each brick has its own constant acceleration.", 40.0);
}

ExactCase pull_threshold() {
  ExactCase threshold_case = pull("friction.pull_threshold", "Onset of slip between two bricks",
                                  "The bricks part where F = mu (m + M) g.", 15.0);
  Threshold threshold;
  threshold.parameter = "force_n";
  threshold.critical = critical_force_n;
  threshold.happened = parted;
  threshold_case.threshold = threshold;
  // What happens after the onset does not matter.
  threshold_case.outside = nullptr;
  threshold_case.parameters =
      with_time({real("friction", "1", 0.4, 0.05, 2.0, "friction between the bricks"),
                 real("force_n", "N", 15.0, 0.1, 1e3, "pull on the lower brick")},
                0.001, 0.5);
  return threshold_case;
}

}  // namespace brickbench::exact
