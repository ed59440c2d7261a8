// PlannedCell: one line of a sweep's list of cells: what is to be run, known before anything is.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "experiments/record/schema.hpp"

namespace brickbench {

struct PlannedCell {
  std::string cell;
  std::string experiment;
  std::string engine;
  std::string variant;
  double step_s = 0.0;
  std::uint64_t seed = 0;
  std::string axes;
  std::string excluded;
  std::string expected;

  bool operator==(const PlannedCell&) const = default;
};

template <>
struct Schema<PlannedCell> {
  static constexpr int version = 1;
  static constexpr std::size_t size = 9;
  static std::array<Column<PlannedCell>, size> columns() {
    using P = PlannedCell;
    return {
        text_column<&P::cell, P>("cell", "identity of the run, as in the rows"),
        text_column<&P::experiment, P>("experiment", "name of the experiment"),
        text_column<&P::engine, P>("engine", "name of the engine"),
        text_column<&P::variant, P>("variant", "variant of the engine"),
        number_column<&P::step_s, P>("step_s", "time step in s"),
        count_column<&P::seed, P>("seed", "seed of the perturbation"),
        text_column<&P::axes, P>("axes", "as in the rows"),
        text_column<&P::excluded, P>("excluded", "why the plan leaves the cell out; else empty"),
        text_column<&P::expected, P>("expected", "the outcome that the plan expects; else empty"),
    };
  }
};

}  // namespace brickbench
