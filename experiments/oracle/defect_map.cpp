#include "experiments/oracle/defect_map.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "experiments/metrics/mechanics.hpp"
#include "experiments/oracle/contact_candidates.hpp"
#include "experiments/step/stepper.hpp"

namespace brickbench::gate {
namespace {

double body_defect_ns(const Body& body, const State& a, const State& b) {
  if (body.fixed) return 0.0;
  const double linear = body.mass_kg * (a.velocity_mps - b.velocity_mps).norm();
  const double gyration_m = std::sqrt(body.inertia_kgm2.mean() / body.mass_kg);
  return std::hypot(linear, (spin_nms(body, a) - spin_nms(body, b)).norm() / gyration_m);
}

// The contact of the worst body that is deepest where the step began.
void name_contact(const World& world, const std::vector<State>& before, StepDefect& defect) {
  constexpr double range_m = 0.02;
  defect.partner = defect.worst_body;
  defect.gap_m = HUGE_VAL;
  std::vector<ContactCandidate> found;
  for (std::size_t k = 0; k < world.bodies.size(); ++k) {
    if (k == defect.worst_body) continue;
    found.clear();
    contact_candidates(world.bodies[defect.worst_body].shape, before[defect.worst_body],
                       world.bodies[k].shape, before[k], {range_m, 0.0, 0.0}, found);
    for (const ContactCandidate& candidate : found) {
      if (candidate.gap_m >= defect.gap_m) continue;
      defect.gap_m = candidate.gap_m;
      defect.partner = k;
      defect.contact_m = candidate.position_m;
    }
  }
}

StepDefect compare_states(const World& world, std::span<const State> a, std::span<const State> b) {
  StepDefect defect;
  double square = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double size = body_defect_ns(world.bodies[i], a[i], b[i]);
    if (defect.per_body_ns.empty() || size > defect.per_body_ns[defect.worst_body]) {
      defect.worst_body = i;
    }
    defect.per_body_ns.push_back(size);
    square += size * size;
  }
  defect.total_ns = std::sqrt(square);
  return defect;
}

// The wrenches that A felt in the same steps.
Load wrenches_of(const Recording& recording) {
  return [&recording](std::size_t step, double, std::span<Wrench> wrenches) {
    std::ranges::copy(recording.wrenches[step], wrenches.begin());
  };
}

}  // namespace

Expected<DefectMap> defect_map(const Adapter& b, const Settings& settings, const Scene& scene,
                               const Recording& recording, std::size_t stride, double share) {
  const World& world = scene.world;
  auto stepper = Stepper::start(b, world, settings, wrenches_of(recording));
  if (!stepper) return tl::unexpected(stepper.error());
  DefectMap map;
  double lightest_kg = HUGE_VAL;
  for (const Body& body : world.bodies) {
    if (!body.fixed) lightest_kg = std::min(lightest_kg, body.mass_kg);
  }
  map.threshold_ns =
      share * lightest_kg * std::max(1.0, world.gravity_mps2.norm()) * settings.step_s;
  for (std::size_t step = 1; step < recording.states.size(); step += stride) {
    const std::vector<State>& before = recording.states[step - 1];
    if (auto ok = stepper->resume(before, step - 1); !ok) return tl::unexpected(ok.error());
    if (auto ok = stepper->advance(); !ok) return tl::unexpected(ok.error());
    StepDefect defect = compare_states(world, recording.states[step], stepper->states());
    defect.step = step;
    defect.time_s = static_cast<double>(step) * settings.step_s;
    name_contact(world, before, defect);
    map.steps.push_back(std::move(defect));
  }
  const auto first = std::ranges::find_if(
      map.steps, [&](const StepDefect& d) { return !(d.total_ns <= map.threshold_ns); });
  map.first = static_cast<std::size_t>(first - map.steps.begin());
  return map;
}

}  // namespace brickbench::gate
