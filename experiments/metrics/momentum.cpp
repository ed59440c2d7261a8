// Linear and angular momentum against the impulses that are known: docs/metrics.md, section
// momentum.
#include <algorithm>

#include "experiments/metrics/compensated_sum.hpp"
#include "experiments/metrics/entries.hpp"
#include "experiments/metrics/mechanics.hpp"
#include "experiments/metrics/outputs.hpp"

namespace brickbench {
namespace {

const std::vector<OutputInfo>& outputs() {
  static const std::vector<OutputInfo> list = {
      {"linear_momentum_error_ns", "N s", Better::lower,
       "largest |P - P(0) - known impulses| at any step",
       "0: contact between moving bodies cannot change it"},
      {"linear_momentum_error_relative", "1", Better::lower,
       "linear_momentum_error_ns over the sum of all impulses and first momenta, without signs",
       "rounding (1e-13); 1e-7 in single precision"},
      {"angular_momentum_error_nms", "N m s", Better::lower,
       "largest |L - L(0) - known angular impulses| at any step, about the common centre of mass",
       "0, or first order in the step where bodies tumble"},
      {"angular_momentum_error_relative", "1", Better::lower,
       "angular_momentum_error_nms over the same sum of moments, without signs",
       "rounding for central motion; 1e-3 at 1 ms for Euler schemes with free spin"},
      {"momentum_from_fixed_ns", "N s", Better::neither,
       "size of the impulse that fixed bodies must have given: P - P(0) - gravity - wrenches",
       "0 without fixed bodies; weight times time while all rests on the ground"},
  };
  return list;
}

const std::vector<OutputInfo>& curves() {
  static const std::vector<OutputInfo> list = {
      {"linear_momentum_x_ns", "N s", Better::neither, "x of the momentum of all that moves",
       "changes by outer impulses alone"},
      {"linear_momentum_y_ns", "N s", Better::neither, "y of it", "as for x"},
      {"linear_momentum_z_ns", "N s", Better::neither, "z of it", "as for x, with gravity"},
      {"angular_momentum_x_nms", "N m s", Better::neither,
       "x of the angular momentum about the common centre of mass",
       "changes by outer moments alone; gravity has none"},
      {"angular_momentum_y_nms", "N m s", Better::neither, "y of it", "as for x"},
      {"angular_momentum_z_nms", "N m s", Better::neither, "z of it", "as for x"}};
  return list;
}

// Momentum of all that moves; the angular part about the common centre of mass.
struct Momentum {
  Eigen::Vector3d linear_ns = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_nms = Eigen::Vector3d::Zero();
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  double linear_size_ns = 0.0;  // sums without signs
  double angular_size_nms = 0.0;
};

Momentum momentum_of(const World& world, std::span<const State> states) {
  Momentum now;
  double mass_kg = 0.0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const Body& body = world.bodies[i];
    if (body.fixed) continue;
    mass_kg += body.mass_kg;
    now.linear_ns += body.mass_kg * states[i].velocity_mps;
    now.linear_size_ns += body.mass_kg * states[i].velocity_mps.norm();
    now.center_m += body.mass_kg * states[i].position_m;
  }
  if (mass_kg == 0.0) return now;
  now.center_m /= mass_kg;
  const Eigen::Vector3d drift_mps = now.linear_ns / mass_kg;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const Body& body = world.bodies[i];
    if (body.fixed) continue;
    const Eigen::Vector3d arm_m = states[i].position_m - now.center_m;
    const Eigen::Vector3d relative_ns = body.mass_kg * (states[i].velocity_mps - drift_mps);
    const Eigen::Vector3d spin = spin_nms(body, states[i]);
    now.angular_nms += arm_m.cross(relative_ns) + spin;
    now.angular_size_nms += arm_m.norm() * relative_ns.norm() + spin.norm();
  }
  return now;
}

struct Compensated3 {
  CompensatedSum x, y, z;
  void operator+=(const Eigen::Vector3d& term) {
    x += term.x();
    y += term.y();
    z += term.z();
  }
  Eigen::Vector3d value() const { return {x.value(), y.value(), z.value()}; }
};

// Impulses from outside, summed over the run; sizes are sums without signs.
struct Impulses {
  Compensated3 linear_ns;
  Compensated3 angular_nms;
  double linear_size_ns = 0.0;
  double angular_size_nms = 0.0;

  // An impulse through the common centre of mass, of known size.
  void add_central(const Eigen::Vector3d& impulse_ns, double size_ns) {
    linear_ns += impulse_ns;
    linear_size_ns += size_ns;
  }
  // An impulse at the arm from the common centre of mass, and a couple.
  void add(const Eigen::Vector3d& impulse_ns, const Eigen::Vector3d& arm_m,
           const Eigen::Vector3d& couple_nms) {
    linear_ns += impulse_ns;
    angular_nms += arm_m.cross(impulse_ns) + couple_nms;
    linear_size_ns += impulse_ns.norm();
    angular_size_nms += arm_m.norm() * impulse_ns.norm() + couple_nms.norm();
  }
};

// The largest error so far and when.
struct WorstError {
  double size = 0.0;
  double time_s = 0.0;
  void see(double error, double now_s) {
    if (error <= size) return;
    size = error;
    time_s = now_s;
  }
};

class MomentumBalance : public Metric {
 public:
  MomentumBalance(const Scene& scene, double step_s)
      : world_(scene.world),
        step_s_(step_s),
        before_(scene.world.bodies.size()),
        guard_(scene.world) {
    has_fixed_ = std::any_of(world_.bodies.begin(), world_.bodies.end(),
                             [](const Body& body) { return body.fixed; });
    for (const Body& body : world_.bodies) {
      if (body.fixed) continue;
      const Eigen::Vector3d impulse_ns = body.mass_kg * step_s_ * world_.gravity_mps2;
      weights_.push_back({impulse_ns, impulse_ns.norm()});
    }
  }

  void observe(const Sample& sample) override {
    if (!guard_.admits(sample)) return;
    const Eigen::Vector3d center_before_m = now_.center_m;
    now_ = momentum_of(world_, sample.states);
    if (sample.step == 0) {
      start_ = now_;
    } else {
      add_gravity();
      add_wrenches(sample, 0.5 * (center_before_m + now_.center_m));
      add_contacts(sample, center_before_m);
      linear_.see((now_.linear_ns - start_.linear_ns - known_.linear_ns.value() -
                   from_fixed_.linear_ns.value())
                      .norm(),
                  sample.time_s);
      angular_.see((now_.angular_nms - start_.angular_nms - known_.angular_nms.value() -
                    from_fixed_.angular_nms.value())
                       .norm(),
                   sample.time_s);
    }
    before_.assign(sample.states.begin(), sample.states.end());
  }

  void report(std::vector<Measurement>& out) const override {
    if (!guard_.intact()) return emit_none(out, outputs(), guard_.note());
    const double given_ns = (now_.linear_ns - start_.linear_ns - known_.linear_ns.value()).norm();
    if (!balanced()) {
      const Value none =
          not_applicable("the engine does not tell the impulses that fixed bodies give");
      return emit(out, outputs(), {none, none, none, none, {given_ns}});
    }
    const std::string assumed =
        has_fixed_ ? ", with the contact impulses on fixed bodies as the engine tells them" : "";
    emit(out, outputs(),
         {{linear_.size, at_time(linear_.time_s) + assumed},
          relative(linear_.size,
                   start_.linear_size_ns + known_.linear_size_ns + from_fixed_.linear_size_ns),
          {angular_.size, at_time(angular_.time_s) + assumed},
          relative(angular_.size, start_.angular_size_nms + known_.angular_size_nms +
                                      from_fixed_.angular_size_nms),
          {given_ns}});
  }

  void trace(std::vector<Measurement>& out) const override {
    if (!guard_.intact()) return emit_none(out, curves(), guard_.note());
    emit(out, curves(),
         {{now_.linear_ns.x()},
          {now_.linear_ns.y()},
          {now_.linear_ns.z()},
          {now_.angular_nms.x()},
          {now_.angular_nms.y()},
          {now_.angular_nms.z()}});
  }

 private:
  bool balanced() const { return !has_fixed_ || contacts_told_; }

  static Value relative(double error, double scale) {
    if (scale > 0.0) return {error / scale};
    return not_applicable("nothing moves, weighs or is pushed");
  }

  // Uniform gravity has no moment about the common centre of mass.
  void add_gravity() {
    for (const Weight& weight : weights_) known_.add_central(weight.impulse_ns, weight.size_ns);
  }

  void add_wrenches(const Sample& sample, const Eigen::Vector3d& center_m) {
    for (std::size_t i = 0; i < sample.wrenches.size(); ++i) {
      if (is_zero(sample.wrenches[i]) || world_.bodies[i].fixed) continue;
      const Eigen::Vector3d arm_m =
          0.5 * (before_[i].position_m + sample.states[i].position_m) - center_m;
      known_.add(step_s_ * sample.wrenches[i].force_n, arm_m,
                 step_s_ * sample.wrenches[i].torque_nm);
    }
  }

  // Contact points are those of the step's start.
  void add_contacts(const Sample& sample, const Eigen::Vector3d& center_m) {
    if (sample.contacts == nullptr) {
      contacts_told_ = false;
      return;
    }
    for (const Contact& contact : *sample.contacts) {
      const bool fixed_a = world_.bodies[contact.body_a].fixed;
      const bool fixed_b = world_.bodies[contact.body_b].fixed;
      if (fixed_a == fixed_b) continue;
      from_fixed_.add(fixed_a ? contact.impulse_ns : Eigen::Vector3d(-contact.impulse_ns),
                      contact.position_m - center_m, Eigen::Vector3d::Zero());
    }
  }

  // What gravity gives to one moving body in a step.
  struct Weight {
    Eigen::Vector3d impulse_ns;
    double size_ns;
  };

  World world_;
  double step_s_;
  std::vector<Weight> weights_;  // of the moving bodies
  std::vector<State> before_;
  StateGuard guard_;
  bool has_fixed_ = false;
  bool contacts_told_ = true;
  Momentum start_;
  Momentum now_;
  Impulses known_;       // gravity and wrenches
  Impulses from_fixed_;  // as the engine tells them
  WorstError linear_;
  WorstError angular_;
};

}  // namespace

MetricInfo momentum_metric() {
  return {.name = "momentum",
          .meaning =
              "Momentum of all that moves against the impulse of gravity, of the wrenches applied "
              "and, where the engine tells them, of the contacts with fixed bodies.",
          .outputs = outputs(),
          .curves = curves(),
          .make = [](const Scene& scene, double step_s) -> std::unique_ptr<Metric> {
            return std::make_unique<MomentumBalance>(scene, step_s);
          }};
}

}  // namespace brickbench
