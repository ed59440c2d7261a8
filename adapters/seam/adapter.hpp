// Adapter: an engine as the harness knows it before anything is built.
#pragma once

#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "adapters/seam/scheme.hpp"
#include "adapters/seam/simulation.hpp"

namespace brickbench {

// Name -> value of knobs.
using KnobValues = std::map<std::string, double, std::less<>>;

struct Settings {
  double step_s = 0.001;     // > 0
  std::string variant = {};  // empty: the adapter's first variant
  KnobValues knobs = {};     // that the user turned; the rest follows the variant
  int threads = 1;           // a variant that cannot have so many refuses them
};

struct Knob {
  std::string name;  // snake_case with SI suffix
  std::string unit;  // "1" for pure numbers
  double engine_default = 0.0;
  std::string meaning;  // one line
  // Allowed range, both ends included.
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool whole = false;  // only whole numbers
};

// A named set of solver and settings, selected as engine/variant.
struct Variant {
  std::string name;
  std::string meaning;  // one line: solver, and whether tuned or the library's own defaults
  std::string precision = "f64";  // "f64", or "f32" if anything in a step is single precision
  // Every knob that acts in this variant, with the value that it has when nobody turns it.
  KnobValues knobs = {};
  int max_threads = 1;
};

struct Adapter {
  std::string name;
  std::string version;            // as the library reports it: the receipt that it is linked
  std::vector<Variant> variants;  // the first is what the bare engine name means
  std::vector<Knob> knobs;        // of all variants, each once
  // The functions below take settings that are valid and settled: they name a variant, and hold
  // the value of each of its knobs. Achieves the facts of the World, which is valid, or refuses
  // with Fault::unsupported.
  std::function<Expected<std::unique_ptr<Simulation>>(const World&, const Settings&)> build = {};
  // Optional: the scheme that the engine documents for these settings; nullopt where none is
  // stated, and then no discrete truth is claimed.
  std::function<std::optional<Scheme>(const Settings&)> scheme = {};
  // Optional: what Audit::settings of the world built with these settings must hold, by name and
  // to the letter: step, solver, and every knob that reaches the engine.
  std::function<std::vector<AuditFact>(const World&, const Settings&)> asked = {};
  bool own = false;  // an engine of this project: reports print its losses first
};

// The variant of that name, which the adapter has; an empty name means the first.
const Variant& variant_of(const Adapter& adapter, std::string_view name);

// The precision of the adapter's variants in one text: "f64", or "f64; fast f32" where they differ.
std::string precision_text(const Adapter& adapter);

// What the knob may be, in words: "whole numbers from 0 to 3".
std::string range_text(const Knob& knob);

// Fault::invalid where the value is not finite or out of the knob's range.
Expected<void> validate(const Knob& knob, double value);

// Fault::invalid unless the settings fit the adapter: positive step, known variant, knobs that the
// variant has, each in its range. Fault::unsupported for more threads than the variant can have.
Expected<void> validate(const Adapter& adapter, const Settings& settings);

// Valid settings with the name of their variant and the value of each of its knobs filled in.
Settings settled(const Adapter& adapter, Settings settings);

// The knob's value in settled settings of a variant that has it.
double knob(const Settings& settings, std::string_view name);

// Validates world and settings, settles them, builds. The way to get a Simulation: it lets no
// exception out of the engine (the step fails with Fault::crashed or Fault::out_of_memory), fails
// the step after which a state is not finite with Fault::diverged, and has a StateView, which
// builds the engine anew where the engine has none of its own.
Expected<std::unique_ptr<Simulation>> build(const Adapter& adapter, const World& world,
                                            const Settings& settings);

// What the adapter states of valid settings, which need not be settled; nullopt or nothing where it
// states none.
std::optional<Scheme> scheme_of(const Adapter& adapter, const Settings& settings);
std::vector<AuditFact> asked_of(const Adapter& adapter, const World& world,
                                const Settings& settings);

}  // namespace brickbench
