// Mechanical energy and who made or lost it: docs/metrics.md, section energy.
#include <cmath>

#include "experiments/metrics/compensated_sum.hpp"
#include "experiments/metrics/entries.hpp"
#include "experiments/metrics/mechanics.hpp"
#include "experiments/metrics/outputs.hpp"

namespace brickbench {
namespace {

const std::vector<OutputInfo>& outputs() {
  static const std::vector<OutputInfo> list = {
      {"energy_initial_j", "J", Better::neither, "kinetic + potential energy at the start",
       "that of the scene; equal for all engines"},
      {"energy_final_j", "J", Better::neither, "kinetic + potential energy at the end",
       "never above the initial plus the work from outside"},
      {"external_work_j", "J", Better::neither, "work of the wrenches applied from outside",
       "equal for all engines where contact does not interfere"},
      {"energy_net_drift_j", "J", Better::neither, "final - initial - outer work",
       "0 without contact; with friction or impacts negative, never positive"},
      {"energy_net_drift_relative", "1", Better::neither, "energy_net_drift_j over the scale",
       "rounding (1e-12) for a conserving scheme, of first order in the step for Euler schemes"},
      {"energy_created_j", "J", Better::lower, "sum of all rises of the energy beyond outer work",
       "0: contact, friction and impact only take"},
      {"energy_created_relative", "1", Better::lower, "energy_created_j over the scale",
       "rounding; more comes from penetration pushed out or from the integrator"},
      {"energy_max_rise_j", "J", Better::lower, "largest rise beyond outer work in one step",
       "0; a single large one is a bad impact or a deep overlap thrown apart"},
      {"energy_max_excess_j", "J", Better::lower, "largest excess over initial energy + outer work",
       "0: at no time may there be more energy than was put in"},
      {"energy_error_max_j", "J", Better::neither,
       "largest distance of the energy from initial energy + outer work, on either side",
       "0 where nothing takes energy; with friction or impacts at least what these took"},
      {"energy_error_max_relative", "1", Better::neither, "energy_error_max_j over the scale",
       "as energy_net_drift_relative, at the worst moment instead of the last"},
      {"energy_dissipated_j", "J", Better::neither, "sum of all falls of the energy",
       "0 without contact; with it, what friction and impacts took (and the scheme's loss)"},
  };
  return list;
}

const std::vector<OutputInfo>& curves() {
  static const std::vector<OutputInfo> list = {
      {"kinetic_energy_j", "J", Better::neither, "sum of m v.v / 2 + w.I w / 2",
       "steps at impacts"},
      {"potential_energy_j", "J", Better::neither, "sum of -m g.x; zero at the world's origin",
       "constant while all stands"},
      {"total_energy_j", "J", Better::neither, "kinetic + potential", "never rises by itself"},
      {"work_done_j", "J", Better::neither, "external_work_j so far", "steps at the blows"}};
  return list;
}

class Energy : public Metric {
 public:
  Energy(const Scene& scene, double step_s)
      : world_(scene.world),
        lift_m_(scene.length_scale_m),
        step_s_(step_s),
        before_(scene.world.bodies.size()),
        guard_(scene.world) {}

  void observe(const Sample& sample) override {
    if (!guard_.admits(sample)) return;
    const double total_before_j = kinetic_j_ + potential_j_;
    measure(sample.states);
    const double total_j = kinetic_j_ + potential_j_;
    if (sample.step == 0) {
      initial_j_ = total_j;
      initial_kinetic_j_ = kinetic_j_;
    } else {
      account(total_j - total_before_j - work_of_step_j(sample), sample.time_s);
    }
    before_.assign(sample.states.begin(), sample.states.end());
  }

  void report(std::vector<Measurement>& out) const override {
    if (!guard_.intact()) return emit_none(out, outputs(), guard_.note());
    const double total_j = kinetic_j_ + potential_j_;
    const double drift_j = total_j - initial_j_ - work_j_.value();
    emit(out, outputs(),
         {{initial_j_},
          {total_j},
          {work_j_.value()},
          {drift_j},
          relative(drift_j),
          {created_j_.value()},
          relative(created_j_.value()),
          {max_rise_j_, max_rise_j_ > 0.0 ? at_time(max_rise_s_) : ""},
          {max_excess_j_, max_excess_j_ > 0.0 ? at_time(max_excess_s_) : ""},
          {max_error_j_, max_error_j_ > 0.0 ? at_time(max_error_s_) : ""},
          relative(max_error_j_),
          {dissipated_j_.value()}});
  }

  void trace(std::vector<Measurement>& out) const override {
    if (!guard_.intact()) return emit_none(out, curves(), guard_.note());
    emit(out, curves(),
         {{kinetic_j_}, {potential_j_}, {kinetic_j_ + potential_j_}, {work_j_.value()}});
  }

 private:
  void measure(std::span<const State> states) {
    CompensatedSum kinetic_j;
    CompensatedSum potential_j;
    for (std::size_t i = 0; i < states.size(); ++i) {
      const Body& body = world_.bodies[i];
      if (body.fixed) continue;
      kinetic_j += kinetic_energy_j(body, states[i]);
      potential_j += potential_energy_j(body, states[i], world_.gravity_mps2);
    }
    kinetic_j_ = kinetic_j.value();
    potential_j_ = potential_j.value();
  }

  double work_of_step_j(const Sample& sample) {
    double work_j = 0.0;
    for (std::size_t i = 0; i < sample.wrenches.size(); ++i) {
      const Wrench& wrench = sample.wrenches[i];
      if (is_zero(wrench) || world_.bodies[i].fixed) continue;
      const double of_body_j =
          brickbench::work_of_step_j(wrench, before_[i], sample.states[i], step_s_);
      work_j += of_body_j;
      absolute_work_j_ += std::abs(of_body_j);
    }
    work_j_ += work_j;
    return work_j;
  }

  void account(double change_j, double time_s) {
    if (change_j > 0.0) {
      created_j_ += change_j;
    } else {
      dissipated_j_ += -change_j;
    }
    if (change_j > max_rise_j_) {
      max_rise_j_ = change_j;
      max_rise_s_ = time_s;
    }
    const double excess_j = kinetic_j_ + potential_j_ - initial_j_ - work_j_.value();
    if (std::abs(excess_j) > max_error_j_) {
      max_error_j_ = std::abs(excess_j);
      max_error_s_ = time_s;
    }
    if (excess_j > max_excess_j_) {
      max_excess_j_ = excess_j;
      max_excess_s_ = time_s;
    }
  }

  // Kinetic energy at the start + outer work without signs + weight of all that moves times the
  // smallest edge.
  Value relative(double energy_j) const {
    double mass_kg = 0.0;
    for (const Body& body : world_.bodies) mass_kg += body.fixed ? 0.0 : body.mass_kg;
    const double scale_j = initial_kinetic_j_ + absolute_work_j_.value() +
                           mass_kg * world_.gravity_mps2.norm() * lift_m_;
    if (scale_j > 0.0) return {energy_j / scale_j};
    return not_applicable("nothing moves, weighs or is pushed");
  }

  World world_;
  double lift_m_;
  double step_s_;
  std::vector<State> before_;
  StateGuard guard_;
  double kinetic_j_ = 0.0;
  double potential_j_ = 0.0;
  double initial_j_ = 0.0;
  double initial_kinetic_j_ = 0.0;
  CompensatedSum work_j_;
  CompensatedSum absolute_work_j_;
  CompensatedSum created_j_;
  CompensatedSum dissipated_j_;
  double max_rise_j_ = 0.0;
  double max_rise_s_ = 0.0;
  double max_excess_j_ = 0.0;
  double max_excess_s_ = 0.0;
  double max_error_j_ = 0.0;
  double max_error_s_ = 0.0;
};

}  // namespace

MetricInfo energy_metric() {
  return {
      .name = "energy",
      .meaning = "Kinetic and potential energy, the work done from outside, and the difference.",
      .outputs = outputs(),
      .curves = curves(),
      .make = [](const Scene& scene, double step_s) -> std::unique_ptr<Metric> {
        return std::make_unique<Energy>(scene, step_s);
      }};
}

}  // namespace brickbench
