// Timing: what a cell cost. Kept apart from the rows, which are the same from run to run.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "experiments/record/schema.hpp"

namespace brickbench {

struct Timing {
  std::string experiment;
  std::string cell;
  std::string engine;
  std::string variant;
  double step_s = 0.0;
  std::uint64_t seed = 0;
  std::string axes;
  std::string machine;
  std::uint64_t steps = 0;
  double build_cpu_s = 0.0;
  double step_median_cpu_s = 0.0;
  double step_max_cpu_s = 0.0;
  double steps_total_cpu_s = 0.0;
  double cell_wall_s = 0.0;
  std::string outcome;
  std::string validity;
};

template <>
struct Schema<Timing> {
  static constexpr int version = 2;
  static constexpr std::size_t size = 16;
  static std::array<Column<Timing>, size> columns() {
    return {
        text_column<&Timing::experiment, Timing>("experiment", "name of the experiment"),
        text_column<&Timing::cell, Timing>("cell", "identity of the run, as in the rows"),
        text_column<&Timing::engine, Timing>("engine", "name of the engine"),
        text_column<&Timing::variant, Timing>("variant", "variant of the engine"),
        number_column<&Timing::step_s, Timing>("step_s", "time step in s"),
        count_column<&Timing::seed, Timing>("seed", "seed of the perturbation"),
        text_column<&Timing::axes, Timing>("axes", "as in the rows"),
        text_column<&Timing::machine, Timing>("machine", "as in the rows"),
        count_column<&Timing::steps, Timing>("steps", "steps that were done"),
        number_column<&Timing::build_cpu_s, Timing>("build_cpu_s",
                                                    "CPU time to build the simulation, s"),
        optional_number_column<&Timing::step_median_cpu_s, Timing>(
            "step_median_cpu_s", "median CPU time of the engine per step, s; empty without steps"),
        number_column<&Timing::step_max_cpu_s, Timing>("step_max_cpu_s",
                                                       "largest CPU time of one step, s"),
        number_column<&Timing::steps_total_cpu_s, Timing>(
            "steps_total_cpu_s", "CPU time of the engine over all steps, s"),
        number_column<&Timing::cell_wall_s, Timing>(
            "cell_wall_s", "wall time of the whole cell, measuring included, s"),
        text_column<&Timing::outcome, Timing>("outcome", "as in the rows"),
        text_column<&Timing::validity, Timing>("validity", "as in the rows"),
    };
  }
};

}  // namespace brickbench
