// Order of convergence from a ladder of time steps, with a confidence band.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "experiments/exact/validation/validate.hpp"

namespace brickbench::exact {

struct LadderRung {
  double step_s = 0.0;
  double error =
      0.0;  // relative to the scale; the largest of the observables without bound on order
  double cpu_s = 0.0;  // of the whole run in the engine
};

struct OrderFit {
  double order = 0.0;        // slope of log error over log step
  double half_width = 0.0;   // of the 95 % confidence interval of the slope (Student)
  bool at_rounding = false;  // errors below 1e-12: no order can be seen
};

// Least squares on the logarithms; needs three rungs with positive errors.
OrderFit fit_order(std::span<const LadderRung> ladder);

struct OrderResult {
  std::string engine;
  std::string variant;
  std::string case_id;
  std::string outcome = "ok";
  std::string reason;
  std::vector<LadderRung> ladder;
  OrderFit fit;
  double promised = 0.0;  // by the scheme; 0 if it states none
};

// Runs the case at step, step/2, ... and fits the error of the first observable.
OrderResult convergence(const Adapter& adapter, const std::string& variant,
                        const ExactCase& exact_case, int rungs = 5);

}  // namespace brickbench::exact
