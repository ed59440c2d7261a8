// Plan: what is to be run, as a TOML file says it. docs/format.md describes the file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/input/input.hpp"
#include "experiments/run/catalogues.hpp"
#include "experiments/run/condition.hpp"
#include "experiments/run/scene_choice.hpp"
#include "experiments/run/selector.hpp"
#include "experiments/run/trajectory_choice.hpp"

namespace brickbench {

// A cell of more steps is refused: at a microsecond each, a quarter of an hour, and rows with a
// time per step would no longer fit in memory.
inline constexpr double k_most_steps = 1e9;

// One name with the values that it takes in turn.
struct Axis {
  std::string name;
  std::vector<ParameterValue> values;
  SourcePosition at;
};

struct EngineChoice {
  Selector selector;
  std::vector<Axis> knobs;  // numbers
};

// Cells of these engines under this condition are left out, or expected to end in `outcome`.
struct Rule {
  std::optional<Selector> selector;  // none: any engine
  Condition when;
  std::string outcome;
  std::string why;
};

// Random changes of the initial state of every body that can move: standard deviation for the
// normal distribution, half width for the uniform one; per component, zero mean.
struct Perturbation {
  double position_m = 0.0;
  double angle_rad = 0.0;  // of a rotation vector in the world frame
  double velocity_mps = 0.0;
  double angular_velocity_radps = 0.0;
  std::string distribution = "normal";  // or "uniform"
};

struct Experiment {
  std::string name;  // unique in the plan; the scenario's unless the plan says otherwise
  std::string scenario;
  FileScene file_scene;  // null: a scene of the catalogue
  SourcePosition at;
  SourcePosition parameters_at;
  std::vector<EngineChoice> engines;
  std::vector<double> step_s;
  double duration_s = 0.0;
  double time_limit_s = 0.0;  // CPU time of a cell; 0: none
  std::vector<Axis> parameters;
  // Groups of names of parameters that take their values together, first with first and so on.
  std::vector<std::vector<std::string>> zip;
  std::vector<std::uint64_t> seeds = {0};  // 0: unperturbed
  Perturbation perturb;
  std::vector<Rule> except;
  std::vector<Rule> expected;
  std::vector<std::string> metrics;  // names, in the order of the catalogue
};

// How `bench` times the plan's cells.
struct BenchChoice {
  Selector base;           // the engine that the others are compared with
  std::size_t repeat = 3;  // rounds
};

struct Plan {
  std::filesystem::path file;
  std::string name;  // the file's stem
  std::string title;
  std::string analysis;
  std::string text;  // the file as read
  std::vector<Experiment> experiments;
  std::optional<BenchChoice> bench;
  std::optional<TrajectoryChoice> trajectory;  // none: no cell is recorded
};

// From the command line: "key=value" for every experiment, or "experiment.key=value".
struct Overrides {
  std::vector<std::string> set;
  std::vector<std::string> engines;  // selectors instead of the plan's
  std::string only;                  // the name of the one experiment to keep; empty: all
};

// Reads and checks a plan against the catalogues; everything in it is then known and in range.
Checked<Plan> read_plan(const std::filesystem::path& file, const Catalogues& catalogues,
                        const Overrides& overrides = {});
Checked<Plan> parse_plan(const std::string& text, const std::filesystem::path& file,
                         const Catalogues& catalogues, const Overrides& overrides = {});

}  // namespace brickbench
