// Summary: the rows of a run, ordered as a reader compares them: one block per experiment, scene,
// step and metric group, engines down, numbers across.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/record/row.hpp"
#include "experiments/statistics/bootstrap.hpp"
#include "reports/src/table.hpp"

namespace brickbench {

// Differences up to this, in a number's SI unit, are rounding: nobody is better by them.
inline constexpr double k_rounding = 1e-11;

// What one engine reached in one number of a block, over all cells (seeds) of it: the mean, with
// its bootstrap interval where statistics::k_least_for_interval cells are at hand. They are of the
// cells with a valid value; where every value is flagged they are of those, for show.
struct Score {
  std::optional<double> mean;
  std::optional<statistics::Interval> interval;  // of the mean, at statistics::k_interval_level
  double lowest = 0.0;
  double highest = 0.0;
  std::size_t with_value = 0;  // valid
  std::size_t flagged = 0;     // with a value that is not to be trusted
  std::size_t cells = 0;
  std::string validity;  // of the first flagged cell
  std::string note;      // of the first cell with a value
  std::string outcome;   // of the first cell without one
  std::string reason;

  // A number that may be ranked, averaged and compared.
  bool is_valid() const { return mean.has_value() && with_value > 0; }
};

struct Number {
  std::string name;
  std::string unit;
  std::string better;  // lower, higher or neither
  std::optional<std::size_t>
      best;  // index of an engine; none where nothing is better, or all equal up to rounding
  std::optional<std::size_t> worst;
};

struct Contender {
  std::string engine;
  std::string variant;
  std::string knobs;  // "knob.iterations=50", may be empty

  std::string label() const;
  bool operator==(const Contender&) const = default;
};

struct Block {
  std::string experiment;
  std::string scenario;
  std::string axes;  // without knobs
  double step_s = 0.0;
  double duration_s = 0.0;
  std::string group;
  std::vector<Number> numbers;
  std::vector<Contender> contenders;
  std::vector<std::vector<Score>> scores;  // (contenders, numbers)
};

// The column `axes` parted into what describes the scene and what describes the engine, each
// "name=value, name=value".
struct AxesParts {
  std::string scene;
  std::string knobs;
};
AxesParts split_axes(const std::string& axes);

// In the order of the rows.
std::vector<Block> summarize(std::span<const Row> rows);

// Whether contender c is as good as the best of number n, up to rounding.
bool is_best(const Block& block, std::size_t c, std::size_t n);
bool is_worst(const Block& block, std::size_t c, std::size_t n);

// The scores of a block; cells without value show the outcome. A number that is not applicable to
// this scene is left out; no rows if none is left.
Table to_table(const Block& block);

// "brick_wall: friction=0.5, step 0.001 s"
std::string scene_label(const Block& block);

// Four significant digits.
std::string short_number(double value);
// "0.0123", "mean 0.0123, 95 % 0.01 .. 0.02 (9 of 9)", "mean 0.0123, range 0.01 .. 0.02 (3 of 4)"
// or the outcome. A flag is a "!": "0.0123 !", "mean 0.0123, range 0.01 .. 0.02 (2 of 4, 2 !)", and
// flag_lines() says what it means.
std::string score_text(const Score& score);

// One line per flagged contender of the blocks, which are those of one scene: "! bee/v: unsolved
// in 31 of 240 steps from step 12 (the first of 2 flagged among 8 cells)".
std::vector<std::string> flag_lines(std::span<const Block> blocks);

}  // namespace brickbench
