#include "experiments/metrics/step_clock.hpp"

#include <algorithm>
#include <ctime>

namespace brickbench {
namespace {

// One nanosecond is the clock's unit; no step takes eleven days.
constexpr double k_shortest_s = 1e-9;
constexpr double k_longest_s = 1e6;

double now_s(StepClock::Scope scope) {
  timespec now{};
  clock_gettime(
      scope == StepClock::Scope::thread ? CLOCK_THREAD_CPUTIME_ID : CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

StepClock::StepClock(Scope scope) : scope_(scope), histogram_(k_shortest_s, k_longest_s) {}

void StepClock::start() { started_s_ = now_s(scope_); }

void StepClock::stop() { add(now_s(scope_) - started_s_); }

void StepClock::add(double cpu_s) {
  histogram_.add(cpu_s);
  total_s_ += cpu_s;
  max_s_ = std::max(max_s_, cpu_s);
}

double StepClock::quantile_s(double q) const {
  const double estimate_s = histogram_.quantile(q);
  return estimate_s > max_s_ ? max_s_ : estimate_s;
}

}  // namespace brickbench
