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
#include <map>

#include "adapters/ourengine_variants.hpp"
#include "ourengine/baraff/simulator.hpp"
#include "ourengine/version.hpp"

namespace brickbench {
namespace {

using Rows = std::vector<KnobRow>;

template <std::size_t... sizes>
Rows rows(const std::array<KnobRow, sizes>&... tables) {
  Rows all;
  all.reserve((sizes + ...));
  (all.insert(all.end(), tables.begin(), tables.end()), ...);
  return all;
}

struct Entry {
  Variant variant;
  Rows knobs;
  Expected<std::unique_ptr<Simulation>> (*build)(const World&, const Settings&);
};

// One entry per variant; the first is the default.
std::vector<Entry> entries() {
  return {
      {{"exact", "Coulomb friction and restitution at velocity level, solved to a stated residual"},
       rows(k_exact_knobs),
       &build_ourengine_exact},
      {{"lcp", "the paper's frictionless law at velocity level; solver selectable"},
       rows(k_exact_knobs, k_lcp_knobs),
       &build_ourengine_lcp},
      {{"fast", "soft contacts in small sub-steps, sixteen manifolds at a time", "f32"},
       rows(k_fast_knobs),
       &build_ourengine_fast},
      {{"baraff", "the paper's system; overlaps are undone; Dantzig pivoting, frictionless"},
       rows(k_baraff_knobs),
       &build_ourengine_baraff},
      {{"paper", "the paper's plain choices: no overlap handling; frictionless"},
       rows(k_baraff_knobs),
       &build_ourengine_baraff},
  };
}

// Knobs of all variants; one that several variants have is listed once.
std::vector<Knob> all_knobs() {
  std::vector<Knob> knobs;
  for (const Entry& entry : entries()) {
    for (const Knob& knob : to_knobs(entry.knobs)) {
      if (std::ranges::find(knobs, knob.name, &Knob::name) == knobs.end()) knobs.push_back(knob);
    }
  }
  return knobs;
}

// A knob that belongs to another variant would have no effect: it is refused instead.
Expected<void> check_knobs(const Entry& entry, const Settings& settings) {
  for (const auto& [name, value] : settings.knobs) {
    const bool known = std::ranges::any_of(
        entry.knobs, [&name = name](const KnobRow& row) { return name == row.name; });
    if (!known) {
      return fail(Fault::invalid, fmt::format("variant '{}' has no knob '{}'; other variants do",
                                              entry.variant.name, name));
    }
  }
  return {};
}

Expected<std::unique_ptr<Simulation>> build_ourengine(const World& world,
                                                      const Settings& settings) {
  const bool velocity_level =
      settings.variant == "fast" || settings.variant == "exact" || settings.variant == "lcp";
  if (settings.threads > 1 && !velocity_level) {
    return fail(Fault::unsupported,
                fmt::format("variant '{}' runs on one thread; fast, exact and lcp can have more",
                            settings.variant));
  }
  const auto all = entries();
  const auto entry =
      std::ranges::find(all, settings.variant, [](const Entry& e) { return e.variant.name; });
  if (auto knobs = check_knobs(*entry, settings); !knobs) {
    return tl::make_unexpected(knobs.error());
  }
  return entry->build(world, settings);
}

// ignore_friction is a permission, no setting of the engine.
std::vector<AuditFact> asked_of_ourengine(const World&, const Settings& settings) {
  const auto all = entries();
  const auto entry =
      std::ranges::find(all, settings.variant, [](const Entry& e) { return e.variant.name; });
  std::vector<AuditFact> facts = {number_fact("step_s", "s", settings.step_s)};
  for (const KnobRow& row : entry->knobs) {
    const std::string_view name = row.name;
    if (name == "ignore_friction" || name == "substep_s") continue;
    const double own = settings.variant == "paper" ? row.library : row.tuned;
    facts.push_back(number_fact(row.name, row.unit, knob_or(settings, name, own)));
  }
  if (settings.variant == "exact") facts.push_back({"solver", "1", "exact"});
  if (settings.variant == "exact" || settings.variant == "lcp") {
    facts.push_back(number_fact("frictionless", "1", settings.variant == "lcp" ? 1 : 0));
    facts.push_back(number_fact("threads", "1", settings.threads));
  }
  if (settings.variant == "fast") {
    facts.push_back(number_fact("substeps", "1", fast_contact(settings).substeps));
    facts.push_back(number_fact("threads", "1", settings.threads));
  }
  return facts;
}

// The paper's system as ourengine/baraff/simulator.hpp states it; steps that bisection cuts at the
// time of contact have no map in Scheme.
Scheme baraff_scheme(const Settings& settings) {
  const auto value = [&](std::string_view name) {
    const auto row = std::ranges::find_if(
        k_baraff_knobs, [&](const KnobRow& r) { return std::string_view(r.name) == name; });
    return knob_or(settings, name, settings.variant == "paper" ? row->library : row->tuned);
  };
  Scheme scheme;
  scheme.source =
      "Darji & Alur, Explosion Simulator, \"Rigid body physics\"; Baraff, Rigid Body Simulation I; "
      "Hairer & Vilmart 2006";
  const bool forward_euler = value("forward_euler") == 1.0;
  scheme.position = forward_euler ? PositionRule::old_velocity : PositionRule::middle_momentum;
  scheme.gyroscopic = GyroscopicRule::spatial_momentum;
  scheme.attitude = forward_euler ? AttitudeRule::normalised_euler : AttitudeRule::moser_veselov;
  if (value("max_bisections") > 0.0) return scheme;
  scheme.sequential =
      SequentialContact{.margin_m = value("contact_tolerance_m"),
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

// The velocity-level engine as ourengine/dynamics/dynamics.hpp and normal_bias_mps() state it.
std::optional<Scheme> velocity_scheme(const Settings& settings) {
  const auto value = [&](std::string_view name) {
    const auto row = std::ranges::find_if(
        k_exact_knobs, [&](const KnobRow& r) { return std::string_view(r.name) == name; });
    return knob_or(settings, name, row->tuned);
  };
  const double integrator = value("integrator");
  if (integrator == 1.0) return std::nullopt;  // CF4 has no rule in Scheme
  Scheme scheme;
  scheme.source = "Moreau 1999; Stewart & Trinkle 1996; ourengine/dynamics, ourengine/contact";
  scheme.position = PositionRule::mean_unless_pushed;
  scheme.gyroscopic = GyroscopicRule::spatial_momentum;
  scheme.attitude = integrator == 0.0 ? AttitudeRule::exponential : AttitudeRule::moser_veselov;
  scheme.impulse = ImpulseContact{.margin_m = std::numeric_limits<double>::infinity(),
                                  .approach_allowed = true,
                                  .bounces_before_touch = true,
                                  .restitution_threshold_steps = value("resting_approach_steps"),
                                  .error_reduction = value("overlap_recovery"),
                                  .max_correction_mps = value("recovery_limit_mps")};
  return scheme;
}

// As ourengine/fast/fast_dynamics.hpp, soft_batch.hpp and manifold_set.hpp state it.
Scheme fast_scheme(const Settings& settings) {
  Scheme scheme;
  scheme.source = "Catto, Solver2D 2024; Macklin et al., Small Steps, 2019; ourengine/fast";
  scheme.position = PositionRule::mean_velocity;  // of bodies that nothing touches
  scheme.gyroscopic = GyroscopicRule::spatial_momentum;
  scheme.attitude = AttitudeRule::moser_veselov;
  scheme.soft = fast_contact(settings);
  return scheme;
}

std::optional<Scheme> ourengine_scheme(const Settings& settings) {
  const std::string& variant = settings.variant;
  if (variant == "baraff" || variant == "paper") return baraff_scheme(settings);
  if (variant == "exact" || variant == "lcp") return velocity_scheme(settings);
  return fast_scheme(settings);
}

}  // namespace

Expected<void> refuse_friction(const World& world, const Settings& settings) {
  if (knob_or(settings, "ignore_friction", 0.0) == 1.0) return {};
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
  Adapter adapter{.name = "ourengine",
                  .version = ourengine::k_version,
                  .variants = {},
                  .knobs = all_knobs(),
                  .build = &build_ourengine,
                  .scheme = &ourengine_scheme,
                  .asked = &asked_of_ourengine,
                  .own = true};
  for (const Entry& entry : entries()) adapter.variants.push_back(entry.variant);
  return adapter;
}

}  // namespace brickbench
