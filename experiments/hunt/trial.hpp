// Trial: one scene in one engine, small enough to be run in a moment: what a hunt draws, judges and
// shrinks.
#pragma once

#include <string>
#include <vector>

#include "experiments/run/catalogues.hpp"
#include "experiments/run/selector.hpp"

namespace brickbench::hunt {

// Where the scene comes from.
enum class Source {
  scenario,    // of the catalogue: a plan reproduces it
  exact_case,  // that is drawn within its domain; step and duration are parameters of it
};

struct Trial {
  Source source = Source::scenario;
  std::string scene;           // name of the scenario or id of the exact case
  ParameterValues parameters;  // only those that differ from their defaults
  double step_s = 0.001;
  std::size_t steps = 1;
  EngineVariant engine;
  KnobValues knobs;  // only those that are turned

  bool operator==(const Trial&) const = default;
};

// The settings with which an engine runs the trial.
Settings settings_of(const Trial& trial);

// The parameters of its scenario or exact case; empty where there is none of that name.
std::vector<Parameter> parameters_of(const Trial& trial, const Catalogues& catalogues);

// The scene of a trial from a scenario. Fault::invalid where the parameters make none.
Expected<Scene> scene_of(const Trial& trial, const Catalogues& catalogues);

// Sets the parameter, or forgets it where the value is the default.
void set_parameter(Trial& trial, const Parameter& parameter, const ParameterValue& value);

// One line for people: scene, parameters, step, number of steps, engine, knobs.
std::string label(const Trial& trial);

}  // namespace brickbench::hunt
