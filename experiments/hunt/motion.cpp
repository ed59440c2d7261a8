#include "experiments/hunt/motion.hpp"

#include "experiments/step/stepper.hpp"

namespace brickbench::hunt {
namespace {

void note_flags(const Simulation& simulation, Motion& motion) {
  const DiagnosticView* view = simulation.diagnostic_view();
  if (view == nullptr || motion.flag) return;
  const Flags flags = view->flags();
  for (const Flag flag : k_all_flags) {
    if (motion.flag || !flags.has(flag)) continue;
    motion.flag = flag;
    motion.flagged_step = motion.steps();
  }
}

Expected<void> play(const Adapter& adapter, const Settings& settings, std::size_t steps,
                    Motion& motion) {
  auto stepper = Stepper::start(adapter, motion.scene.world, settings,
                                blows_of(motion.scene, settings.step_s));
  if (!stepper) return tl::unexpected(stepper.error());
  const auto states = [&] {
    return std::vector<State>(stepper->states().begin(), stepper->states().end());
  };
  motion.states.push_back(states());
  while (stepper->done() < steps) {
    if (auto ok = stepper->advance(); !ok) return ok;
    motion.wrenches.emplace_back(stepper->wrenches().begin(), stepper->wrenches().end());
    motion.states.push_back(states());
    note_flags(stepper->simulation(), motion);
  }
  return {};
}

}  // namespace

Motion run_motion(const Adapter& adapter, const Settings& settings, const Scene& scene,
                  std::size_t steps) {
  Motion motion;
  motion.scene = scene;
  motion.step_s = settings.step_s;
  motion.single = variant_of(adapter, settings.variant).precision != "f64";
  motion.scheme = scheme_of(adapter, settings);
  if (const auto ok = play(adapter, settings, steps, motion); !ok) {
    motion.outcome = to_outcome(ok.error().fault);
    motion.reason = ok.error().reason;
  }
  return motion;
}

std::uint64_t fingerprint(const Motion& motion) {
  std::uint64_t hash = 0;
  for (const auto& states : motion.states) hash = hash_states(states, hash);
  return hash;
}

}  // namespace brickbench::hunt
