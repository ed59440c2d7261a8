#include "experiments/run/watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace brickbench {

Watch::Watch(const Scene& scene, const Cell& cell, const Catalogues& catalogues)
    : scene_(scene),
      cell_(cell),
      steps_(step_count(cell)),
      stride_(std::max<std::uint64_t>(1, (steps_ + k_series_points - 2) / (k_series_points - 1))),
      energy_bound_(scene, cell.step_s),
      passages_(scene.world, cell.step_s) {
  for (const std::string& name : cell.metrics) {
    metrics_.push_back(find_metric(catalogues, name)->make(scene, cell.step_s));
  }
}

Expected<void> Watch::run(const Adapter& adapter, const StepCallback& after_step,
                          TrajectoryRecorder* recorder) {
  recorder_ = recorder;
  auto started = Stepper::start(adapter, scene_, settings());
  if (!started) return tl::unexpected(started.error());
  Stepper& stepper = stepper_.emplace(std::move(*started));
  note_method(adapter, stepper.simulation());
  if (auto ok = observe(stepper.sample()); !ok) return ok;
  while (stepper.done() < steps_) {
    if (auto ok = stepper.advance(); !ok) return ok;
    if (auto ok = observe(stepper.sample()); !ok) return ok;
    if (cell_.time_limit_s > 0.0 && stepper.clock().total_s() > cell_.time_limit_s) {
      return fail(Fault::timed_out, fmt::format("{} of {} steps done within the limit of {} s",
                                                stepper.done(), steps_, cell_.time_limit_s));
    }
    const double done = static_cast<double>(stepper.done()) / static_cast<double>(steps_);
    if (after_step && !after_step(done)) {
      return fail(Fault::timed_out,
                  fmt::format("stopped after {} of {} steps", stepper.done(), steps_));
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

Expected<void> Watch::check_energy(const Sample& sample) {
  const auto excess = energy_bound_.observe(sample);
  if (!excess) return {};
  const std::string& body = scene_.world.bodies[excess->body].name;
  if (excess->is_too_far) {
    return fail(Fault::blown_up,
                fmt::format("after step {} ({} s) body '{}' is {:.3g} m from its start, where the "
                            "energy that there is carries it {:.3g} m at most",
                            sample.step, sample.time_s, body, excess->found, excess->bound));
  }
  return fail(
      Fault::blown_up,
      fmt::format("after step {} ({} s) there are {:.3g} J more kinetic and potential energy than "
                  "at the start and by outer work, where at most {:.3g} J are an error; body '{}' "
                  "gained most",
                  sample.step, sample.time_s, excess->found, excess->bound, body));
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

Expected<void> Watch::observe(Sample sample) {
  if (auto ok = check_energy(sample); !ok) return ok;
  watch_passages(sample);
  validity_.observe(sample);
  hash_.observe(sample);
  if (recorder_ != nullptr) recorder_->observe(sample);
  for (const auto& metric : metrics_) metric->observe(sample);
  if (sample.step % stride_ != 0) return {};
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
  if (!stepper_) return;
  timing.steps = stepper_->clock().steps();
  timing.build_cpu_s = stepper_->build_cpu_s();
  timing.step_median_cpu_s = stepper_->clock().median_s();
  timing.step_max_cpu_s = stepper_->clock().max_s();
  timing.steps_total_cpu_s = stepper_->clock().total_s();
}

}  // namespace brickbench
