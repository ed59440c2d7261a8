// Symptoms of settings: knobs that do not arrive, variants that are another one.
#include <fmt/format.h>

#include <algorithm>

#include "adapters/seam/unit.hpp"
#include "experiments/conformance/diagnosis.hpp"

namespace brickbench::conformance {
namespace {

// A brick is thrown at two that lie on each other on a floor.
World busy_floor(double friction) {
  World world;
  world.law.friction = friction;
  const BoxShape brick{{0.1, 0.05, 0.05}};
  world.bodies.push_back(fixed_body("floor", BoxShape{{5, 5, 1}}, at(0, 0, -1)));
  world.bodies.push_back(solid_body("lower", brick, 2000.0, at(0, 0, 0.05)));
  world.bodies.push_back(solid_body("upper", brick, 2000.0, at(0.02, 0, 0.15)));
  world.bodies.push_back(solid_body("thrown", brick, 4000.0, at(-0.35, 0.01, 0.17)));
  world.bodies.back().initial.velocity_mps = {5.0, 0.1, 0.0};
  world.bodies.back().initial.angular_velocity_radps = {1.0, 2.0, 3.0};
  return world;
}

Settings settings_with(const std::string& variant, const KnobValues& knobs = {}) {
  return {.step_s = k_step_s, .variant = variant, .knobs = knobs};
}

// The hash of the states after each of 100 steps; shorter where the engine fails, empty where it
// refuses.
std::vector<std::uint64_t> trace(const Adapter& adapter, const Settings& settings,
                                 double friction) {
  const World world = busy_floor(friction);
  std::vector<std::uint64_t> hashes;
  const auto simulation = build(adapter, world, settings);
  for (int step = 0; simulation && step < 100; ++step) {
    if (!(*simulation)->step()) break;
    hashes.push_back(hash_states(read(**simulation, world)));
  }
  return hashes;
}

// A value of the knob that is allowed and not this one.
std::optional<double> other_value(const Knob& knob, double now) {
  for (const double value : {2.0 * now, 0.5 * now, now + 1.0, knob.max, knob.min}) {
    if (value != now && validate(knob, value)) return value;
  }
  return std::nullopt;
}

// Where the live engine shows a knob under its name and with another value than was set.
std::string read_back_symptom(const Subject& subject, const Knob& knob, double value) {
  const auto simulation =
      build(subject.adapter, busy_floor(0.0), settings_with(subject.variant, {{knob.name, value}}));
  const AuditView* view = simulation ? (*simulation)->audit_view() : nullptr;
  if (view == nullptr) return {};
  const Audit audit = view->audit();
  const auto fact = std::ranges::find(audit.settings, knob.name, &AuditFact::name);
  const std::string wanted = fmt::format("{}", value);
  if (fact == audit.settings.end() || fact->value == wanted) return {};
  return fmt::format("knob {} does not arrive: set to {}{}, it reads back as {}", knob.name, wanted,
                     unit_suffix(knob.unit), fact->value);
}

// Whether turning this knob changes any bit.
bool moves_bits(const Subject& subject, const Knob& knob, double value,
                const std::vector<std::uint64_t>& usual) {
  const auto turned =
      trace(subject.adapter, settings_with(subject.variant, {{knob.name, value}}), 0.0);
  return turned != usual;
}

Symptoms knob_symptoms(const Subject& subject) {
  Symptoms symptoms;
  const Variant& variant = variant_of(subject.adapter, subject.variant);
  const auto usual = trace(subject.adapter, settings_with(subject.variant), 0.0);
  int turned = 0, moved = 0;
  for (const auto& [name, now] : variant.knobs) {
    const auto knob = std::ranges::find(subject.adapter.knobs, name, &Knob::name);
    const auto value = other_value(*knob, now);
    if (!value) continue;
    if (auto words = read_back_symptom(subject, *knob, *value); !words.empty()) {
      symptoms.push_back(words);
    }
    ++turned;
    if (moves_bits(subject, *knob, *value, usual)) ++moved;
  }
  if (turned > 0 && moved == 0 && !usual.empty()) {
    symptoms.push_back(
        fmt::format("knobs do not arrive: turning any of {} changes no bit of the "
                    "motion",
                    turned));
  }
  return symptoms;
}

// The settings that the live engine shows, in one text; empty where it shows none.
std::string shown_settings(const Adapter& adapter, const std::string& variant) {
  const auto simulation = build(adapter, busy_floor(0.0), settings_with(variant));
  const AuditView* view = simulation ? (*simulation)->audit_view() : nullptr;
  std::string text;
  if (view == nullptr) return text;
  for (const AuditFact& fact : view->audit().settings) text += fact.name + '=' + fact.value + ' ';
  return text;
}

// Other variants that move to the same bits, and show the same settings if they show any. Without
// friction different solvers may well be the same: there the settings must speak, too.
Symptoms variant_symptoms(const Subject& subject) {
  Symptoms symptoms;
  for (const double friction : {0.5, 0.0}) {
    const auto own = trace(subject.adapter, settings_with(subject.variant), friction);
    if (own.empty()) continue;
    const std::string shown = shown_settings(subject.adapter, subject.variant);
    if (friction == 0.0 && shown.empty()) break;
    for (const Variant& other : subject.adapter.variants) {
      if (other.name == subject.variant) continue;
      if (trace(subject.adapter, settings_with(other.name), friction) != own) continue;
      if (shown_settings(subject.adapter, other.name) != shown) continue;
      symptoms.push_back(fmt::format("variants {} and {} move to the same bits: is it one of them?",
                                     std::min(subject.variant, other.name),
                                     std::max(subject.variant, other.name)));
    }
    break;
  }
  return symptoms;
}

}  // namespace

Symptoms setting_symptoms(const Subject& subject) {
  Symptoms symptoms = variant_symptoms(subject);
  for (const std::string& words : knob_symptoms(subject)) symptoms.push_back(words);
  return symptoms;
}

}  // namespace brickbench::conformance
