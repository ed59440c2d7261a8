#include "experiments/regression/equivalence.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace brickbench::gate {
namespace {

// The continued fraction of the incomplete beta function, by Lentz's method.
double beta_fraction(double a, double b, double x) {
  constexpr double tiny = 1e-300;
  double c = 1.0;
  double d = 1.0 - (a + b) * x / (a + 1.0);
  if (std::abs(d) < tiny) d = tiny;
  d = 1.0 / d;
  double h = d;
  for (int m = 1; m < 500; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    double change = 1.0;
    for (const double term : {even, odd}) {
      d = 1.0 + term * d;
      c = 1.0 + term / c;
      if (std::abs(d) < tiny) d = tiny;
      if (std::abs(c) < tiny) c = tiny;
      d = 1.0 / d;
      change = c * d;
      h *= change;
    }
    if (std::abs(change - 1.0) < 1e-15) break;
  }
  return h;
}

double incomplete_beta(double a, double b, double x) {
  if (x <= 0.0) return 0.0;
  if (x >= 1.0) return 1.0;
  const double front = std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) +
                                a * std::log(x) + b * std::log1p(-x));
  if (x < (a + 1.0) / (a + b + 2.0)) return front * beta_fraction(a, b, x) / a;
  return 1.0 - front * beta_fraction(b, a, 1.0 - x) / b;
}

struct Moments {
  double mean = 0.0;
  double variance = 0.0;
  double count = 0.0;
};

Moments moments(std::span<const double> values) {
  Moments result;
  result.count = static_cast<double>(values.size());
  for (const double value : values) result.mean += value / result.count;
  for (const double value : values) {
    result.variance += (value - result.mean) * (value - result.mean) / (result.count - 1.0);
  }
  return result;
}

// Two one-sided tests pass with probability 0.9 at equal means when the margin is
// (t(1 - alpha) + t(0.95)) standard errors.
std::size_t runs_needed(const Moments& a, const Moments& b, double margin, double alpha) {
  const double variance = a.variance + b.variance;
  double runs = std::max(2.0, std::max(a.count, b.count));
  for (int round = 0; round < 50; ++round) {
    const double freedom = 2.0 * runs - 2.0;
    const double t = student_quantile(1.0 - alpha, freedom) + student_quantile(0.95, freedom);
    const double next = std::ceil(variance * t * t / (margin * margin));
    if (!(next > runs)) break;
    runs = std::min(next, 1e9);
  }
  return static_cast<std::size_t>(runs);
}

}  // namespace

double student_cdf(double t, double freedom) {
  const double tail = 0.5 * incomplete_beta(0.5 * freedom, 0.5, freedom / (freedom + t * t));
  return t > 0.0 ? 1.0 - tail : tail;
}

double student_quantile(double probability, double freedom) {
  double low = -1.0;
  double high = 1.0;
  while (student_cdf(low, freedom) > probability) low *= 2.0;
  while (student_cdf(high, freedom) < probability) high *= 2.0;
  while (true) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return middle;
    (student_cdf(middle, freedom) < probability ? low : high) = middle;
  }
}

Equivalence equivalence(std::span<const double> a, std::span<const double> b, double margin,
                        double alpha) {
  assert(a.size() > 1 && b.size() > 1);
  const Moments ma = moments(a);
  const Moments mb = moments(b);
  Equivalence result;
  result.difference = mb.mean - ma.mean;
  const double ea = ma.variance / ma.count;
  const double eb = mb.variance / mb.count;
  double reach = 0.0;
  if (ea + eb > 0.0) {
    const double freedom =
        (ea + eb) * (ea + eb) / (ea * ea / (ma.count - 1.0) + eb * eb / (mb.count - 1.0));
    reach = student_quantile(1.0 - alpha, freedom) * std::sqrt(ea + eb);
  }
  result.low = result.difference - reach;
  result.high = result.difference + reach;
  result.equivalent = result.low > -margin && result.high < margin;
  result.runs_needed = runs_needed(ma, mb, margin, alpha);
  return result;
}

Look look_at(std::span<const double> a, std::span<const double> b, double margin,
             const SequentialPlan& plan) {
  Look look;
  if (a.size() == b.size() && std::ranges::equal(a, b)) {
    look.verdict = Verdict::identical;
    return look;
  }
  const double looks = static_cast<double>(plan.looks);
  look.test = energy_test(a, b, plan.permutation);
  look.mean = equivalence(a, b, margin, plan.alpha_same / looks);
  if (look.test.p_value <= plan.alpha_different / looks) {
    look.verdict = Verdict::different;
  } else if (look.mean.equivalent) {
    look.verdict = Verdict::same;
  } else {
    const std::size_t present = std::min(a.size(), b.size());
    look.more_runs = look.mean.runs_needed > present ? look.mean.runs_needed - present : 1;
  }
  return look;
}

}  // namespace brickbench::gate
