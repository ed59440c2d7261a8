// SeriesPoint: one point of a decimated curve over time.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "experiments/record/schema.hpp"

namespace brickbench {

struct SeriesPoint {
  std::string experiment;
  std::string cell;
  std::string engine;
  std::string variant;
  double step_s = 0.0;
  std::string curve;
  std::string unit;
  std::uint64_t stride = 1;
  double time_s = 0.0;
  double value = 0.0;
};

template <>
struct Schema<SeriesPoint> {
  static constexpr int version = 1;
  static constexpr std::size_t size = 10;
  static std::array<Column<SeriesPoint>, size> columns() {
    using P = SeriesPoint;
    return {
        text_column<&P::experiment, P>("experiment", "name of the experiment"),
        text_column<&P::cell, P>("cell", "identity of the run, as in the rows"),
        text_column<&P::engine, P>("engine", "name of the engine"),
        text_column<&P::variant, P>("variant", "variant of the engine"),
        number_column<&P::step_s, P>("step_s", "time step in s"),
        text_column<&P::curve, P>("curve", "name of the curve, with its SI suffix"),
        text_column<&P::unit, P>("unit", "SI unit; 1 for pure numbers"),
        count_column<&P::stride, P>("stride", "steps from one point to the next"),
        number_column<&P::time_s, P>("time_s", "simulated time in s"),
        number_column<&P::value, P>("value", "the curve at that time"),
    };
  }
};

}  // namespace brickbench
