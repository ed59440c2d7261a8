// The largest step with which an engine keeps a scene at rest, by bisection.
#pragma once

#include <string>

#include "adapters/seam/adapter.hpp"
#include "experiments/scenarios/scenario.hpp"

namespace brickbench::exact {

struct StableStepSearch {
  double time_s = 2.0;         // each trial lasts this long
  double drift_limit_m = 0.0;  // a body further from its start than this: the scene did not stay
  double first_s = 1e-3;
  double least_s = 1e-5;
  double most_s = 0.2;
  double width = 0.02;  // of the bracket, relative
};

struct StableStep {
  std::string outcome = "ok";  // or to_outcome(fault) if the engine cannot have the scene at all
  std::string reason;
  double stable_s = 0.0;    // the largest step that kept the scene; 0: none did
  double unstable_s = 0.0;  // the smallest larger step that did not; 0: all up to most_s did
  std::string failure;      // what happened at unstable_s
};

// A quarter of the smallest edge or radius of the bodies that move (m).
double quarter_of_smallest_m(const World& world);

// Steps grow by a quarter from first_s on until one fails, or shrink until one holds; the bracket
// is then bisected. Stability need not be monotone: the answer is the first failure on that ladder.
// The bodies must start at rest and stay so, without blows: Fault::invalid as outcome otherwise.
StableStep largest_stable_step(const Adapter& adapter, const Settings& settings, const Scene& scene,
                               const StableStepSearch& search);

}  // namespace brickbench::exact
