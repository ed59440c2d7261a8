// Row: one measured number of one cell. The schema of rows.csv, stated here and nowhere else;
// docs/format.md repeats it and a test compares the two.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "experiments/record/schema.hpp"

namespace brickbench {

struct Row {
  std::string experiment;
  std::string cell;
  std::string scenario;
  std::string engine;
  std::string variant;
  std::string engine_version;
  std::string precision;
  std::string revision;
  std::string machine;
  double step_s = 0.0;
  double duration_s = 0.0;
  std::uint64_t seed = 0;
  std::string axes;
  std::string group;
  std::string metric;
  std::string unit;
  std::string better;
  std::optional<double> value;  // finite or infinite, never NaN
  std::string note;
  std::string outcome;
  std::string reason;
  std::string validity;  // empty, or the flags that the run raised
  std::string state_hash;

  bool operator==(const Row&) const = default;
};

template <>
struct Schema<Row> {
  static constexpr int version = 2;
  static constexpr std::size_t size = 23;
  static std::array<Column<Row>, size> columns() {
    return {
        text_column<&Row::experiment, Row>("experiment", "name of the experiment in its plan"),
        text_column<&Row::cell, Row>(
            "cell", "identity of the run: 128-bit hash of everything that decides its result"),
        text_column<&Row::scenario, Row>("scenario", "name of the scenario"),
        text_column<&Row::engine, Row>("engine", "name of the engine"),
        text_column<&Row::variant, Row>("variant", "variant of the engine: solver and settings"),
        text_column<&Row::engine_version, Row>("engine_version",
                                               "version as the engine itself reports it"),
        text_column<&Row::precision, Row>("precision", "f64 or f32"),
        text_column<&Row::revision, Row>("revision", "revision of this project's source"),
        text_column<&Row::machine, Row>("machine", "CPU model and architecture"),
        number_column<&Row::step_s, Row>("step_s", "time step in s"),
        number_column<&Row::duration_s, Row>("duration_s", "simulated time in s"),
        count_column<&Row::seed, Row>("seed", "seed of the perturbation; 0: unperturbed"),
        text_column<&Row::axes, Row>(
            "axes", "what the plan says about this cell: name=value;name=value, sorted by name"),
        text_column<&Row::group, Row>("group", "the metric that yields this number"),
        text_column<&Row::metric, Row>("metric", "name of the number, with its SI suffix"),
        text_column<&Row::unit, Row>("unit", "SI unit; 1 for pure numbers"),
        text_column<&Row::better, Row>("better", "lower, higher or neither"),
        Column<Row>{"value", "the number; empty where there is none (see outcome)", true,
                    [](const Row& row) { return row.value ? shortest(*row.value) : ""; },
                    [](Row& row, std::string_view text) -> Expected<void> {
                      row.value.reset();
                      if (text.empty()) return {};
                      auto value = parse_number(text);
                      if (!value) return tl::unexpected(value.error());
                      row.value = *value;
                      return {};
                    }},
        text_column<&Row::note, Row>("note", "where and when the number arose; may be empty"),
        text_column<&Row::outcome, Row>("outcome", "ok, or why there is no number"),
        text_column<&Row::reason, Row>("reason", "one sentence; empty if the outcome is ok"),
        text_column<&Row::validity, Row>(
            "validity", "empty, or why the number is not to be trusted: flags, steps, first step"),
        text_column<&Row::state_hash, Row>(
            "state_hash", "hash of all states of the run; empty if the run did not finish"),
    };
  }
};

}  // namespace brickbench
