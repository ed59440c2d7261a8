#include "experiments/hunt/motion.hpp"

#include <fmt/format.h>

#include <cmath>

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

// Relative: a law that the engine forms of its surfaces' numbers may round.
constexpr double k_law_rounding = 1e-12;

// Fault::unsupported where the engine says itself that it runs a pair under another law: what it
// breaks of the one that was asked for is told.
Expected<void> check_laws(const World& world, const Simulation& simulation) {
  const AuditView* view = simulation.audit_view();
  for (std::size_t a = 0; view != nullptr && a < world.bodies.size(); ++a) {
    for (std::size_t b = a + 1; b < world.bodies.size(); ++b) {
      if (world.bodies[a].fixed && world.bodies[b].fixed) continue;
      const ContactLaw live = view->pair_law(a, b);
      const ContactLaw asked = contact_law(world, a, b);
      if (std::abs(live.friction - asked.friction) <= k_law_rounding * (1.0 + asked.friction) &&
          std::abs(live.restitution - asked.restitution) <= k_law_rounding) {
        continue;
      }
      return fail(Fault::unsupported,
                  fmt::format("bodies '{}' and '{}' run with friction {} and restitution {} "
                              "instead of {} and {}",
                              world.bodies[a].name, world.bodies[b].name, live.friction,
                              live.restitution, asked.friction, asked.restitution));
    }
  }
  return {};
}

Expected<void> play(const Adapter& adapter, const Settings& settings, std::size_t steps,
                    Motion& motion) {
  auto stepper = Stepper::start(adapter, motion.scene, settings);
  if (!stepper) return tl::unexpected(stepper.error());
  if (auto ok = check_laws(motion.scene.world, stepper->simulation()); !ok) return ok;
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
