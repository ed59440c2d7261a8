// Adapter: an engine as the harness knows it before anything is built.
#pragma once

#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "adapters/seam/scheme.hpp"
#include "adapters/seam/simulation.hpp"

namespace brickbench {

// Name -> value of the knobs that the user turned; the rest follows the variant.
using KnobValues = std::map<std::string, double, std::less<>>;

struct Settings {
  double step_s = 0.001;  // > 0
  std::string variant;    // empty: the adapter's first variant
  KnobValues knobs;
  int threads = 1;  // an engine that cannot have more than one refuses more
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
};

struct Adapter {
  std::string name;
  std::string version;            // as the library reports it: the receipt that it is linked
  std::vector<Variant> variants;  // the first is what the bare engine name means
  std::vector<Knob> knobs;
  // The world is valid and the settings name a variant and knobs of this adapter: build() below
  // has checked. Achieves the facts of the World or refuses with Fault::unsupported.
  Expected<std::unique_ptr<Simulation>> (*build)(const World&, const Settings&) = nullptr;
  // Optional: the scheme that the engine documents for these settings (variant filled in); nullptr
  // or nullopt where none is stated, and then no discrete truth is claimed.
  std::optional<Scheme> (*scheme)(const Settings&) = nullptr;
  // Optional: what Audit::settings of the world built with these settings (variant filled in) must
  // hold, by name and to the letter: step, solver, and every knob that reaches the engine.
  std::vector<AuditFact> (*asked)(const World&, const Settings&) = nullptr;
  bool own = false;  // an engine of this project: reports print its losses first
};

// The value that the user gave the knob, else `otherwise`.
double knob_or(const Settings& settings, std::string_view name, double otherwise);

// The variant of that name, which the adapter has; an empty name means the first.
const Variant& variant_of(const Adapter& adapter, std::string_view name);

// The precision of the adapter's variants in one text: "f64", or "f64; fast f32" where they differ.
std::string precision_text(const Adapter& adapter);

// What the knob may be, in words: "whole numbers from 0 to 3".
std::string range_text(const Knob& knob);

// Fault::invalid where the value is not finite or out of the knob's range.
Expected<void> validate(const Knob& knob, double value);

// Fault::invalid unless the settings fit the adapter: positive step, known variant, known knobs,
// each in its range.
Expected<void> validate(const Adapter& adapter, const Settings& settings);

// Validates world and settings, fills in the default variant, builds. An exception out of the
// engine becomes Fault::crashed. The way to get a Simulation.
Expected<std::unique_ptr<Simulation>> build(const Adapter& adapter, const World& world,
                                            Settings settings);

}  // namespace brickbench
