// Condition: "columns > 15 and step_s < 0.001", a test of a cell's numbers and words.
#pragma once

#include <string>
#include <vector>

#include "experiments/input/input.hpp"
#include "experiments/scenarios/scenario.hpp"

namespace brickbench {

enum class Relation { less, at_most, greater, at_least, equal, unequal };

struct Term {
  std::string name;
  Relation relation = Relation::equal;
  ParameterValue value;
};

// All terms must hold; none: always true.
using Condition = std::vector<Term>;

// Throws InputError unless the text is `name op value [and name op value]...` with op one of
// < <= > >= == != and the name in `known`.
Condition parse_condition(const std::string& text, const SourcePosition& at,
                          const std::vector<std::string>& known);

// A term about a name that `values` lacks (a knob of another engine) does not hold. Words can only
// be equal or unequal; other comparisons of words do not hold.
bool holds(const Condition& condition, const ParameterValues& values);

}  // namespace brickbench
