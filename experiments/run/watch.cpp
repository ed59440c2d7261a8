#include "experiments/run/watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>

namespace brickbench {
namespace {

// A blow at the instant between two steps belongs to the later one; this share of a step covers the
// rounding of time / step.
constexpr double k_blow_rounding = 1e-9;

// Calls into the engine; what it throws becomes a value.
template <typename Call>
Expected<void> guarded(std::size_t step, const Call& call) {
  try {
    return call();
  } catch (const std::bad_alloc&) {
    return fail(Fault::out_of_memory, fmt::format("the engine ran out of memory in step {}", step));
  } catch (const std::exception& error) {
    return fail(Fault::crashed, fmt::format("the engine threw in step {}: {}", step, error.what()));
  } catch (...) {
    return fail(Fault::crashed, fmt::format("the engine threw in step {}", step));
  }
}

}  // namespace

Watch::Watch(const Scene& scene, const Cell& cell, const Catalogues& catalogues)
    : scene_(scene),
      cell_(cell),
      steps_(step_count(cell)),
      stride_(std::max<std::uint64_t>(1, (steps_ + k_series_points - 2) / (k_series_points - 1))),
      states_(scene.world.bodies.size()),
      wrenches_(scene.world.bodies.size()),
      energy_bound_(scene, cell.step_s),
      passages_(scene.world, cell.step_s) {
  for (const std::string& name : cell.metrics) {
    metrics_.push_back(find_metric(catalogues, name)->make(scene, cell.step_s));
  }
}

Expected<void> Watch::run(const Adapter& adapter, const StepCallback& after_step,
                          TrajectoryRecorder* recorder) {
  recorder_ = recorder;
  StepClock build_clock;
  build_clock.start();
  auto simulation = build(adapter, scene_.world, settings());
  build_clock.stop();
  build_cpu_s_ = build_clock.total_s();
  if (!simulation) return tl::unexpected(simulation.error());
  note_method(adapter, **simulation);
  (*simulation)->read(states_);
  if (auto ok = observe(**simulation, 0); !ok) return ok;
  for (std::size_t step = 1; step <= steps_; ++step) {
    if (auto ok = advance(**simulation, step); !ok) return ok;
    if (auto ok = observe(**simulation, step); !ok) return ok;
    if (cell_.time_limit_s > 0.0 && clock_.total_s() > cell_.time_limit_s) {
      return fail(Fault::timed_out, fmt::format("{} of {} steps done within the limit of {} s",
                                                step, steps_, cell_.time_limit_s));
    }
    const double done = static_cast<double>(step) / static_cast<double>(steps_);
    if (after_step && !after_step(done)) {
      return fail(Fault::timed_out, fmt::format("stopped after {} of {} steps", step, steps_));
    }
  }
  return {};
}

Settings Watch::settings() const {
  return {
      .step_s = cell_.step_s, .variant = cell_.engine.variant, .knobs = cell_.knobs, .threads = 1};
}

// The step is the cell's and no method.
void Watch::note_method(const Adapter& adapter, const Simulation& simulation) {
  const AuditView* view = simulation.audit_view();
  const auto used = view != nullptr ? view->audit().settings : std::vector<AuditFact>{};
  const auto asked = asked_of(adapter, scene_.world, settings());
  method_.engine = cell_.engine.label();
  for (const AuditFact& fact : asked) {
    const auto found = std::ranges::find(used, fact.name, &AuditFact::name);
    method_.facts.push_back({fact.name, fact.unit, fact.value,
                             found == used.end() ? std::string(k_unsupported) : found->value});
  }
  for (const AuditFact& fact : used) {
    if (std::ranges::find(asked, fact.name, &AuditFact::name) != asked.end()) continue;
    method_.facts.push_back({fact.name, fact.unit, std::string(k_not_stated), fact.value});
  }
  std::erase_if(method_.facts, [](const MethodFact& fact) { return fact.name == "step_s"; });
}

Expected<void> Watch::advance(Simulation& simulation, std::size_t step) {
  set_wrenches(step);
  auto stepped = guarded(step, [&]() -> Expected<void> {
    simulation.apply(wrenches_);
    clock_.start();
    auto result = simulation.step();
    clock_.stop();
    if (!result) {
      result.error().reason =
          fmt::format("step {} ({} s): {}", step, static_cast<double>(step) * cell_.step_s,
                      result.error().reason);
      return result;
    }
    simulation.read(states_);
    return {};
  });
  if (!stepped) return stepped;
  ++steps_done_;
  return check_finite(step);
}

Expected<void> Watch::check_finite(std::size_t step) const {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (is_finite(states_[i])) continue;
    return fail(Fault::diverged, fmt::format("body '{}' is not finite after step {} ({} s)",
                                             scene_.world.bodies[i].name, step,
                                             static_cast<double>(step) * cell_.step_s));
  }
  return {};
}

void Watch::set_wrenches(std::size_t step) {
  std::ranges::fill(wrenches_, Wrench{});
  for (const Blow& blow : scene_.blows) {
    const double at = std::floor(blow.time_s / cell_.step_s + k_blow_rounding);
    if (at + 1.0 != static_cast<double>(step)) continue;
    wrenches_[blow.body].force_n += blow.impulse_ns / cell_.step_s;
    wrenches_[blow.body].torque_nm += blow.angular_impulse_nms / cell_.step_s;
  }
}

Expected<void> Watch::check_energy(const Sample& sample) {
  const auto excess = energy_bound_.observe(sample);
  if (!excess) return {};
  return fail(
      Fault::blown_up,
      fmt::format("after step {} ({} s) there are {:.3g} J more kinetic and potential energy than "
                  "at the start and by outer work, where at most {:.3g} J are an error; body '{}' "
                  "gained most",
                  sample.step, sample.time_s, excess->excess_j, excess->bound_j,
                  scene_.world.bodies[excess->body].name));
}

void Watch::watch_passages(Sample& sample) {
  sample.tellable.raise(Flag::tunnelled);
  const std::vector<Passage>& passages = passages_.observe(sample.states);
  if (passages.empty()) return;
  const auto& bodies = scene_.world.bodies;
  passage_ = fmt::format("'{}' through '{}'", bodies[passages.front().body].name,
                         bodies[passages.front().through].name);
  sample.flags.raise(Flag::tunnelled);
  sample.passage = passage_;
}

Expected<void> Watch::observe(Simulation& simulation, std::size_t step) {
  Sample sample;
  sample.step = step;
  sample.time_s = static_cast<double>(step) * cell_.step_s;
  sample.states = states_;
  sample.wrenches = wrenches_;
  if (const ContactView* view = simulation.contact_view(); view != nullptr && step > 0) {
    view->contacts(contacts_);
    sample.contacts = &contacts_;
  }
  if (const DiagnosticView* view = simulation.diagnostic_view(); view != nullptr && step > 0) {
    sample.diagnostics = view->diagnostics();
    sample.flags = view->flags();
    sample.tellable = view->tellable();
  }
  if (auto ok = check_energy(sample); !ok) return ok;
  watch_passages(sample);
  validity_.observe(sample);
  hash_.observe(sample);
  if (recorder_ != nullptr) recorder_->observe(sample);
  for (const auto& metric : metrics_) metric->observe(sample);
  if (step % stride_ != 0) return {};
  std::vector<Measurement> values;
  for (const auto& metric : metrics_) metric->trace(values);
  for (const Measurement& value : values) {
    if (std::isnan(value.value)) continue;
    curves_.push_back({value.name, value.unit, sample.time_s, value.value});
  }
  return {};
}

std::vector<std::vector<Measurement>> Watch::report() const {
  std::vector<std::vector<Measurement>> values(metrics_.size());
  for (std::size_t i = 0; i < metrics_.size(); ++i) metrics_[i]->report(values[i]);
  return values;
}

void Watch::fill_timing(Timing& timing) const {
  timing.steps = steps_done_;
  timing.build_cpu_s = build_cpu_s_;
  timing.step_median_cpu_s = clock_.median_s();
  timing.step_max_cpu_s = clock_.max_s();
  timing.steps_total_cpu_s = clock_.total_s();
}

}  // namespace brickbench
