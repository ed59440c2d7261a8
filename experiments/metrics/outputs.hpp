// What the metrics share: emitting their declared outputs, and refusing states that are none.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "experiments/metrics/metric.hpp"

namespace brickbench {

struct Value {
  double value = 0.0;
  std::string note = {};
};

// Appends one measurement per output, in the order of `outputs`; the two have the same length.
void emit(std::vector<Measurement>& out, const std::vector<OutputInfo>& outputs,
          std::initializer_list<Value> values);
// Appends NaN with this note for every output.
void emit_none(std::vector<Measurement>& out, const std::vector<OutputInfo>& outputs,
               const std::string& note);

// NaN and "not applicable: reason".
Value not_applicable(const std::string& reason);
// "at 0.25 s"
std::string at_time(double time_s);

// Lets a metric see only states that are states. Comparisons with NaN are false, so a maximum would
// silently keep its last good value: after the first bad sample a metric reports no number at all.
class StateGuard {
 public:
  explicit StateGuard(const World& world);
  // False from the first sample on in which a number is not finite or a quaternion's length is
  // further than 1 % from 1.
  bool admits(const Sample& sample);
  bool intact() const { return note_.empty(); }
  // "not finite: body 'b' at 0.007 s"; empty while intact.
  const std::string& note() const { return note_; }

 private:
  std::vector<std::string> names_;
  std::string note_;
};

// Whether a metric of bricks has no number, because there are no bricks or because a state was
// none; `out` then says which for every output.
bool is_silent(const std::vector<std::size_t>& bricks, const StateGuard& guard,
               std::vector<Measurement>& out, const std::vector<OutputInfo>& outputs);

}  // namespace brickbench
