#include "experiments/exact/validation/stable_step.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "adapters/seam/shape.hpp"
#include "experiments/step/stepper.hpp"

namespace brickbench::exact {
namespace {

constexpr double k_ladder = 1.25;

// Why the scene did not stay, or an empty text. An engine that refuses the step is a Failure.
Expected<std::string> trial(const Adapter& adapter, Settings settings, const World& world,
                            const StableStepSearch& search, double step_s) {
  settings.step_s = step_s;
  auto stepper = Stepper::start(adapter, world, settings);
  if (!stepper) return tl::make_unexpected(stepper.error());
  const auto steps = static_cast<std::size_t>(std::ceil(search.time_s / step_s));
  for (std::size_t step = 1; step <= steps; ++step) {
    if (auto ok = stepper->advance(); !ok) return ok.error().reason;
    const std::span<const State> states = stepper->states();
    for (std::size_t i = 0; i < states.size(); ++i) {
      if (world.bodies[i].fixed) continue;
      const double drift_m = (states[i].position_m - world.bodies[i].initial.position_m).norm();
      if (drift_m <= search.drift_limit_m) continue;
      return fmt::format("'{}' is {:.2g} m from its start after {:.3g} s", world.bodies[i].name,
                         drift_m, stepper->time_s());
    }
  }
  return std::string();
}

}  // namespace

double quarter_of_smallest_m(const World& world) {
  double smallest_m = std::numeric_limits<double>::infinity();
  for (const Body& body : world.bodies) {
    if (body.fixed) continue;
    smallest_m = std::min(
        smallest_m, is_round(body.shape) ? bounding_radius_m(body.shape) : thickness_m(body.shape));
  }
  return 0.25 * smallest_m;
}

StableStep largest_stable_step(const Adapter& adapter, const Settings& settings, const Scene& scene,
                               const StableStepSearch& search) {
  StableStep result;
  const World& world = scene.world;
  const bool moves = std::ranges::any_of(world.bodies, [](const Body& body) {
    return body.initial.velocity_mps.norm() > 0.0 ||
           body.initial.angular_velocity_radps.norm() > 0.0;
  });
  if (moves || !scene.blows.empty() || !scene.pushes.empty()) {
    result.outcome = to_outcome(Fault::invalid);
    result.reason = moves ? "a body starts with a velocity: only scenes at rest have a stable step"
                          : "blows or forces act: only scenes at rest have a stable step";
    return result;
  }
  // Whether the scene stays with this step; notes the largest that held and the last that failed.
  const auto holds = [&](double step_s) {
    const auto failure = trial(adapter, settings, world, search, step_s);
    if (!failure) {
      result.outcome = to_outcome(failure.error().fault);
      result.reason = failure.error().reason;
      return false;
    }
    if (failure->empty()) {
      result.stable_s = step_s;
      return true;
    }
    result.unstable_s = step_s;
    result.failure = *failure;
    return false;
  };
  double step_s = search.first_s;
  if (holds(step_s)) {
    while ((step_s *= k_ladder) <= search.most_s && holds(step_s)) {
    }
  } else {
    while (result.outcome == "ok" && (step_s /= k_ladder) >= search.least_s && !holds(step_s)) {
    }
  }
  while (result.outcome == "ok" && result.stable_s > 0.0 &&
         result.unstable_s > result.stable_s * (1.0 + search.width)) {
    holds(std::sqrt(result.stable_s * result.unstable_s));
  }
  return result;
}

}  // namespace brickbench::exact
