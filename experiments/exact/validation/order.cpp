#include "experiments/exact/validation/order.hpp"

#include <array>
#include <cmath>
#include <ctime>

namespace brickbench::exact {
namespace {

constexpr double k_rounding = 1e-12;

// Two-sided 95 % quantiles of Student's t for 1, 2, ... degrees of freedom.
constexpr std::array<double, 10> k_student = {12.706, 4.303, 3.182, 2.776, 2.571,
                                              2.447,  2.365, 2.306, 2.262, 2.228};

double thread_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

OrderFit fit_order(std::span<const LadderRung> ladder) {
  OrderFit fit;
  const auto n = static_cast<double>(ladder.size());
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (const LadderRung& rung : ladder) {
    if (!(rung.error > k_rounding)) fit.at_rounding = true;
    const double x = std::log(rung.step_s), y = std::log(rung.error);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  if (fit.at_rounding || ladder.size() < 3) return fit;
  const double spread = sxx - sx * sx / n;
  fit.order = (sxy - sx * sy / n) / spread;
  const double offset = (sy - fit.order * sx) / n;
  double squares = 0.0;
  for (const LadderRung& rung : ladder) {
    squares += std::pow(std::log(rung.error) - offset - fit.order * std::log(rung.step_s), 2);
  }
  const std::size_t freedom = std::min(ladder.size() - 2, k_student.size());
  fit.half_width = k_student[freedom - 1] * std::sqrt(squares / (n - 2.0) / spread);
  return fit;
}

OrderResult convergence(const Adapter& adapter, const std::string& variant,
                        const ExactCase& exact_case, int rungs) {
  OrderResult result;
  result.engine = adapter.name;
  result.case_id = exact_case.id;
  const ParameterValues values = complete(exact_case).value();
  double step_s = 2.0 * value_of(values, "step_s");
  for (int rung = 0; rung < rungs; ++rung, step_s *= 0.5) {
    const auto run = build(exact_case, {{"step_s", step_s}});
    const Settings settings = settings_of(adapter, variant, *run);
    result.variant = settings.variant;
    if (const auto scheme = scheme_of(adapter, settings)) result.promised = scheme->order;
    const double start_s = thread_cpu_s();
    const auto measured = measure(adapter, variant, exact_case, *run);
    if (!measured) {
      result.outcome = to_outcome(measured.error().fault);
      result.reason = measured.error().reason;
      return result;
    }
    const Truth& truth = run->truths.front();
    result.ladder.push_back({.step_s = step_s,
                             .error = std::abs(measured->front() - truth.value) / truth.scale,
                             .cpu_s = thread_cpu_s() - start_s});
  }
  result.fit = fit_order(result.ladder);
  return result;
}

}  // namespace brickbench::exact
