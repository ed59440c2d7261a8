#include "experiments/step/stepper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace brickbench {
namespace {

// This share of a step covers the rounding of time / step of a blow at a step's border.
constexpr double k_blow_rounding = 1e-9;

// Mean of the push's share over begin_s .. end_s: the trapezia under its course, clipped to that
// time.
double mean_share(const Push& push, double begin_s, double end_s) {
  double sum_s = 0.0;
  for (std::size_t i = 0; i + 1 < push.times_s.size(); ++i) {
    const double from_s = push.times_s[i];
    const double to_s = push.times_s[i + 1];
    const double low_s = std::max(begin_s, from_s);
    const double high_s = std::min(end_s, to_s);
    if (!(high_s > low_s)) continue;
    const double slope_hz = (push.shares[i + 1] - push.shares[i]) / (to_s - from_s);
    const double middle_s = 0.5 * (low_s + high_s) - from_s;
    sum_s += (high_s - low_s) * (push.shares[i] + slope_hz * middle_s);
  }
  return sum_s / (end_s - begin_s);
}

}  // namespace

void add_outer_wrenches(const Scene& scene, double step_s, std::size_t step,
                        std::span<const State> states, std::span<Wrench> wrenches) {
  for (const Blow& blow : scene.blows) {
    if (std::floor(blow.time_s / step_s + k_blow_rounding) != static_cast<double>(step)) continue;
    wrenches[blow.body].force_n += blow.impulse_ns / step_s;
    wrenches[blow.body].torque_nm += blow.angular_impulse_nms / step_s;
  }
  const double begin_s = static_cast<double>(step) * step_s;
  for (const Push& push : scene.pushes) {
    const double share = mean_share(push, begin_s, begin_s + step_s);
    if (share == 0.0) continue;
    const Eigen::Vector3d arm_m = states[push.body].orientation * push.point_m;
    wrenches[push.body].force_n += share * push.force_n;
    wrenches[push.body].torque_nm += share * (push.torque_nm + arm_m.cross(push.force_n));
  }
}

Stepper::Stepper(const World& world, const Settings& settings, Load load)
    : world_(&world),
      step_s_(settings.step_s),
      load_(std::move(load)),
      states_(world.bodies.size()),
      wrenches_(world.bodies.size()) {}

Expected<Stepper> Stepper::start(const Adapter& adapter, const World& world,
                                 const Settings& settings, Load load) {
  Stepper stepper(world, settings, std::move(load));
  StepClock build_clock;
  build_clock.start();
  auto built = build(adapter, world, settings);
  build_clock.stop();
  if (!built) return tl::unexpected(built.error());
  stepper.simulation_ = std::move(*built);
  const CostView* cost = stepper.simulation_->cost_view();
  stepper.build_cpu_s_ = cost == nullptr ? build_clock.total_s() : cost->build_cpu_s();
  stepper.simulation_->read(stepper.states_);
  return stepper;
}

Expected<Stepper> Stepper::start(const Adapter& adapter, const Scene& scene,
                                 const Settings& settings) {
  auto stepper = start(adapter, scene.world, settings);
  if (stepper) stepper->scene_ = &scene;
  return stepper;
}

Expected<void> Stepper::advance() {
  std::ranges::fill(wrenches_, Wrench{});
  if (scene_ != nullptr) add_outer_wrenches(*scene_, step_s_, done_, states_, wrenches_);
  if (load_) load_(done_, time_s(), wrenches_);
  ++done_;
  simulation_->apply(wrenches_);
  clock_.start();
  auto result = simulation_->step();
  if (const CostView* cost = simulation_->cost_view(); cost == nullptr) {
    clock_.stop();
  } else if (result) {
    clock_.add(cost->step_cpu_s());
  }
  if (!result) {
    return fail(result.error().fault,
                fmt::format("step {} ({} s): {}", done_, time_s(), result.error().reason));
  }
  simulation_->read(states_);
  return {};
}

Expected<void> Stepper::resume(std::span<const State> states, std::size_t done) {
  done_ = done;
  std::ranges::copy(states, states_.begin());
  return simulation_->state_view()->set_state(states);
}

Sample Stepper::sample(bool with_contacts) {
  Sample sample;
  sample.step = done_;
  sample.time_s = time_s();
  sample.states = states_;
  sample.wrenches = wrenches_;
  if (done_ == 0) return sample;
  if (const ContactView* view = with_contacts ? simulation_->contact_view() : nullptr) {
    view->contacts(contacts_);
    sample.contacts = &contacts_;
  }
  if (const DiagnosticView* view = simulation_->diagnostic_view()) {
    sample.diagnostics = view->diagnostics();
    sample.flags = view->flags();
    sample.tellable = view->tellable();
  }
  return sample;
}

}  // namespace brickbench
