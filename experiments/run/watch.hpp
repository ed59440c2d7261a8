// Watch: steps a simulation through its scene and shows every step to the metrics.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiments/metrics/energy_bound.hpp"
#include "experiments/metrics/passages.hpp"
#include "experiments/metrics/state_hash.hpp"
#include "experiments/metrics/validity.hpp"
#include "experiments/record/provenance.hpp"
#include "experiments/record/timing.hpp"
#include "experiments/run/run_cell.hpp"
#include "experiments/run/trajectory_recorder.hpp"
#include "experiments/step/stepper.hpp"

namespace brickbench {

struct CurvePoint {
  std::string curve;
  std::string unit;
  double time_s = 0.0;
  double value = 0.0;
};

class Watch {
 public:
  // The scene must outlive the watch.
  Watch(const Scene& scene, const Cell& cell, const Catalogues& catalogues);

  // Builds the simulation and steps it to the end of the cell. Fails as the engine fails; with
  // Fault::diverged at the first state that is not finite; with Fault::blown_up at the first with
  // more energy than anything could have given it; with Fault::timed_out at the cell's time limit
  // or when `after_step` says so.
  // `recorder` (may be nullptr) is shown every step too.
  Expected<void> run(const Adapter& adapter, const StepCallback& after_step,
                     TrajectoryRecorder* recorder = nullptr);

  // (metrics of the cell): what each of them says of the run so far.
  std::vector<std::vector<Measurement>> report() const;
  const Validity& validity() const { return validity_; }
  const std::vector<CurvePoint>& curves() const { return curves_; }
  std::uint64_t stride() const { return stride_; }
  std::string state_hash() const { return hash_.hex(); }
  void fill_timing(Timing& timing) const;
  // What was asked of the engine and what its live objects have; empty before it is built.
  const MethodRecord& method() const { return method_; }

 private:
  Settings settings() const;
  void note_method(const Adapter& adapter, const Simulation& simulation);
  Expected<void> observe(Sample sample);
  Expected<void> check_energy(const Sample& sample);
  void watch_passages(Sample& sample);

  const Scene& scene_;
  const Cell& cell_;
  std::uint64_t steps_;
  std::uint64_t stride_;
  std::vector<std::unique_ptr<Metric>> metrics_;
  std::vector<CurvePoint> curves_;
  MethodRecord method_;
  StateHash hash_;
  EnergyBound energy_bound_;
  Passages passages_;
  std::string passage_;
  Validity validity_;
  TrajectoryRecorder* recorder_ = nullptr;
  std::optional<Stepper> stepper_;  // none before it is built
};

}  // namespace brickbench
