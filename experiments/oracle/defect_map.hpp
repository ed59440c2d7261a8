// One-step defects: engine B continues from states that engine A recorded, for one step at a time,
// so that differences do not grow by chaos. Says when, at which bodies and at which contact two
// engines part.
#pragma once

#include <string>

#include "experiments/oracle/recorder.hpp"

namespace brickbench::gate {

struct StepDefect {
  std::size_t step = 0;   // from 1: the step that both made
  double time_s = 0.0;    // its end
  double total_ns = 0.0;  // sqrt of the sum over bodies of |m dv|^2 + |I dw|^2 / gyration^2
  std::vector<double> per_body_ns;  // (bodies)
  std::size_t worst_body = 0;
  std::size_t partner = 0;  // the body whose gap to the worst one is the smallest before the step
  Eigen::Vector3d contact_m = Eigen::Vector3d::Zero();  // deepest contact of the two
  double gap_m = 0.0;                                   // infinite if they do not touch
};

struct DefectMap {
  std::vector<StepDefect> steps;
  // Index into `steps` of the first defect above the threshold; steps.size() if there is none.
  std::size_t first = 0;
  double threshold_ns = 0.0;
};

// `recording` is of engine A in the same scene and step. Every `stride`-th step. The threshold is
// `share` times weight times step of the lightest moving body. Fault::unsupported if B cannot take
// states.
Expected<DefectMap> defect_map(const Adapter& b, const Settings& settings, const Scene& scene,
                               const Recording& recording, std::size_t stride, double share);

}  // namespace brickbench::gate
