// StepClock: CPU time per step, in fixed memory. Its numbers go to the timings file alone.
#pragma once

#include <cstdint>

#include "experiments/metrics/log_histogram.hpp"

namespace brickbench {

class StepClock {
 public:
  enum class Scope {
    thread,   // CPU time of the calling thread (CLOCK_THREAD_CPUTIME_ID)
    process,  // of all threads (CLOCK_PROCESS_CPUTIME_ID), for engines with threads of their own
  };
  explicit StepClock(Scope scope = Scope::thread);

  // Around one step: start(), the step, stop(). A stop() without a start() is our own mistake.
  void start();
  void stop();
  // Adds a step of known length (s).
  void add(double cpu_s);

  std::uint64_t steps() const { return histogram_.count(); }
  double total_s() const { return total_s_; }
  double max_s() const { return max_s_; }
  // Within 0.5 % of the true quantile, never above max_s(); NaN before the first step.
  double median_s() const { return quantile_s(0.5); }
  double p99_s() const { return quantile_s(0.99); }
  double quantile_s(double q) const;

 private:
  Scope scope_;
  LogHistogram histogram_;
  double started_s_ = 0.0;
  double total_s_ = 0.0;
  double max_s_ = 0.0;
};

}  // namespace brickbench
