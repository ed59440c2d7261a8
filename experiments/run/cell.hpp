// Cell: one run of one scene in one engine: the unit of work, of failure and of resumption.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/run/plan.hpp"

namespace brickbench {

struct Cell {
  std::size_t index = 0;  // in the plan's order, excluded cells included
  std::string experiment;
  std::string scenario;
  FileScene file_scene;  // null: a scene of the catalogue
  EngineVariant engine;
  ParameterValues parameters;  // complete
  KnobValues knobs;            // that the plan turns
  double step_s = 0.0;
  double duration_s = 0.0;
  double time_limit_s = 0.0;  // CPU time; 0: none
  std::uint64_t seed = 0;
  Perturbation perturb;
  std::vector<std::string> metrics;
  std::string axes;              // what the plan says: "name=value;name=value", sorted by name
  std::string excluded_why;      // not empty: the plan leaves this cell out
  std::string expected_outcome;  // not empty: the plan expects this instead of ok
  std::optional<Recording> recording;  // none: the motion is not recorded; no part of the key
};

// All cells of the plan, in its order: experiment, then parameters (in the order of the file, the
// last one fastest), step, seed, engine (fastest), knobs. An InputError if a combination of
// parameters that is not left out makes no scene.
Checked<std::vector<Cell>> expand(const Plan& plan, const Catalogues& catalogues);

// The quantities that a rule may name, with the cell's values.
ParameterValues quantities(const Cell& cell, const Catalogues& catalogues);

// duration / step, rounded; the plan's reader has checked that it is whole.
std::uint64_t step_count(const Cell& cell);

// A number in its shortest exact form, or the text.
std::string text_of(const ParameterValue& value);

// Everything that decides the cell's result, as text with fixed order and shortest numbers.
// `engine_version` as the adapter reports it; `revision` of this source.
std::string cell_key(const Cell& cell, const std::string& engine_version,
                     const std::string& revision);
// XXH3-128 of the key, 32 hexadecimal digits.
std::string cell_id(const std::string& key);

}  // namespace brickbench
