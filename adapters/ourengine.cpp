// ourengine: the engine of this project, behind the same seam as the others.
//
// Choices (docs/engines/ourengine.md):
//  * baraff: the paper's system with overlap handling; paper: its plain choices. Both frictionless:
//    a world in which a pair may rub is refused, unless ignore_friction is 1.
//  * exact: Coulomb's law with restitution at velocity level, solved to a residual every step.
//  * lcp: the frictionless law at velocity level, with a choice of solvers.
//  * fast: soft contacts in small sub-steps, velocities in single precision.
//  * Refused: several threads in paper and baraff. In the others they change no bit.
#include <algorithm>
#include <limits>

#include "adapters/ourengine_variants.hpp"
#include "ourengine/baraff/face_contact.hpp"
#include "ourengine/baraff/simulator.hpp"
#include "ourengine/integration/rotation.hpp"
#include "ourengine/version.hpp"

namespace brickbench {
namespace {

// More threads than any machine of today has.
constexpr int k_most_threads = 1024;

using Build = Expected<std::unique_ptr<Simulation>> (*)(const World&, const Settings&);
using Asked = std::vector<AuditFact> (*)(const World&, const Settings&);
using Stated = std::optional<Scheme> (*)(const Settings&);

struct Entry {
  Variant variant;
  std::vector<Knob> knobs;
  Build build;
  Asked asked;
  Stated scheme;
};

std::vector<AuditFact> baraff_asked(const World& world, const Settings& settings) {
  return asked_knobs(k_baraff_knobs, world, settings);
}

std::vector<AuditFact> velocity_asked(const World& world, const Settings& settings) {
  const bool frictionless = settings.variant == "lcp";
  std::vector<AuditFact> facts = frictionless ? asked_knobs(k_lcp_knobs, world, settings)
                                              : asked_knobs(k_exact_knobs, world, settings);
  if (!frictionless) facts.push_back({"solver", "1", "exact"});
  facts.push_back(number_fact("frictionless", "1", frictionless ? 1 : 0));
  facts.push_back(number_fact("threads", "1", settings.threads));
  return facts;
}

std::vector<AuditFact> fast_asked(const World& world, const Settings& settings) {
  std::vector<AuditFact> facts = asked_knobs(k_fast_knobs, world, settings);
  facts.push_back(number_fact("substeps", "1", fast_substeps(settings)));
  facts.push_back(number_fact("threads", "1", settings.threads));
  return facts;
}

// The paper's system as ourengine/baraff/simulator.hpp states it; steps that bisection cuts at the
// time of contact have no map in Scheme.
std::optional<Scheme> baraff_scheme(const Settings& settings) {
  const auto value = [&](std::string_view name) { return knob(settings, name); };
  Scheme scheme;
  scheme.source =
      "Darji & Alur, Explosion Simulator, \"Rigid body physics\"; Baraff, Rigid Body Simulation I; "
      "Hairer & Vilmart 2006";
  const bool forward_euler = value("forward_euler") == 1.0;
  scheme.position = forward_euler ? PositionRule::old_velocity : PositionRule::middle_momentum;
  scheme.gyroscopic = GyroscopicRule::spatial_momentum;
  scheme.attitude = forward_euler ? AttitudeRule::normalised_euler : AttitudeRule::moser_veselov;
  if (!forward_euler) scheme.cut_turn_rad = ourengine::k_largest_turn_rad;
  if (value("max_bisections") > 0.0) return scheme;
  scheme.contact = SequentialContact{.margin_m = value("contact_tolerance_m"),
                                     .border_share = ourengine::baraff::k_border_share,
                                     .collision_velocity_mps = value("collision_velocity_mps"),
                                     .most_sweeps = static_cast<int>(value("max_collision_sweeps")),
                                     .hits_at_once = value("hits_at_once") == 1.0,
                                     .velocity_share = value("velocity_share"),
                                     .overlap_share = value("overlap_share"),
                                     .overlap_slop_m = value("overlap_slop_m"),
                                     .slow_hit_steps = ourengine::baraff::Options{}.slow_hit_steps,
                                     .depth_share = value("depth_share")};
  return scheme;
}

// The velocity-level engine as ourengine/exact/dynamics.hpp and normal_bias_mps() state it.
std::optional<Scheme> velocity_scheme(const Settings& settings) {
  const auto value = [&](std::string_view name) { return knob(settings, name); };
  const double integrator = value("integrator");
  Scheme scheme;
  scheme.source = "Moreau 1999; Stewart & Trinkle 1996; ourengine/dynamics, ourengine/contact";
  scheme.position = PositionRule::mean_unless_pushed;
  scheme.gyroscopic = GyroscopicRule::spatial_momentum;
  scheme.attitude = integrator == 0.0 ? AttitudeRule::exponential : AttitudeRule::moser_veselov;
  scheme.cut_turn_rad = ourengine::k_largest_turn_rad;
  scheme.contact = ImpulseContact{.margin_m = std::numeric_limits<double>::infinity(),
                                  .approach_allowed = true,
                                  .bounces_before_touch = true,
                                  .restitution_threshold_steps = value("resting_approach_steps"),
                                  .error_reduction = value("overlap_recovery"),
                                  .max_correction_mps = value("recovery_limit_mps")};
  return scheme;
}

// As ourengine/fast/fast_dynamics.hpp, soft_batch.hpp and manifold_set.hpp state it.
std::optional<Scheme> fast_scheme(const Settings& settings) {
  Scheme scheme;
  scheme.source = "Catto, Solver2D 2024; Macklin et al., Small Steps, 2019; ourengine/fast";
  scheme.position = PositionRule::mean_velocity;  // of bodies that nothing touches
  scheme.gyroscopic = GyroscopicRule::spatial_momentum;
  scheme.attitude = AttitudeRule::moser_veselov;
  scheme.cut_turn_rad = ourengine::k_largest_turn_rad;
  scheme.contact = fast_contact(settings);
  return scheme;
}

// One entry per variant; the first is the default.
const std::vector<Entry>& entries() {
  static const std::vector<Entry> list = {
      {{"exact", "Coulomb friction and restitution at velocity level, solved to a stated residual",
        "f64", tuned_values(k_exact_knobs), k_most_threads},
       to_knobs(k_exact_knobs),
       &build_ourengine_exact,
       &velocity_asked,
       &velocity_scheme},
      {{"lcp", "the paper's frictionless law at velocity level; solver selectable", "f64",
        tuned_values(k_lcp_knobs), k_most_threads},
       to_knobs(k_lcp_knobs),
       &build_ourengine_lcp,
       &velocity_asked,
       &velocity_scheme},
      {{"fast", "soft contacts in small sub-steps, sixteen manifolds at a time", "f32",
        tuned_values(k_fast_knobs), k_most_threads},
       to_knobs(k_fast_knobs),
       &build_ourengine_fast,
       &fast_asked,
       &fast_scheme},
      {{"baraff", "the paper's system; overlaps are undone; Dantzig pivoting, frictionless", "f64",
        tuned_values(k_baraff_knobs)},
       to_knobs(k_baraff_knobs),
       &build_ourengine_baraff,
       &baraff_asked,
       &baraff_scheme},
      {{"paper", "the paper's plain choices: no overlap handling; frictionless", "f64",
        library_values(k_baraff_knobs)},
       to_knobs(k_baraff_knobs),
       &build_ourengine_baraff,
       &baraff_asked,
       &baraff_scheme},
  };
  return list;
}

const Entry& entry_of(const Settings& settings) {
  return *std::ranges::find(entries(), settings.variant,
                            [](const Entry& e) { return e.variant.name; });
}

}  // namespace

Expected<void> refuse_friction(const World& world, const Settings& settings) {
  if (knob(settings, "ignore_friction") == 1.0) return {};
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double friction = contact_law(world, j, i).friction;
      if (friction == 0.0 || (world.bodies[i].fixed && world.bodies[j].fixed)) continue;
      return fail(Fault::unsupported,
                  fmt::format("friction {} between '{}' and '{}': the law of this variant is "
                              "frictionless; ignore_friction = 1 runs without friction",
                              friction, world.bodies[j].name, world.bodies[i].name));
    }
  }
  return {};
}

Adapter ourengine_adapter() {
  Adapter adapter{
      .name = "ourengine",
      .version = ourengine::k_version,
      .variants = {},
      .knobs = {},
      .build = [](const World& world, const Settings& s) { return entry_of(s).build(world, s); },
      .scheme = [](const Settings& s) { return entry_of(s).scheme(s); },
      .asked = [](const World& world, const Settings& s) { return entry_of(s).asked(world, s); },
      .own = true};
  for (const Entry& entry : entries()) {
    adapter.variants.push_back(entry.variant);
    for (const Knob& knob : entry.knobs) {
      const auto known = std::ranges::find(adapter.knobs, knob.name, &Knob::name);
      if (known == adapter.knobs.end()) adapter.knobs.push_back(knob);
    }
  }
  return adapter;
}

}  // namespace brickbench
