// The axes of an experiment: what a plan varies, as values of parameters and of an engine's knobs.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/input/input.hpp"
#include "experiments/run/plan.hpp"
#include "experiments/run/selector.hpp"

namespace brickbench {

// Makes one value of an axis; throws InputError.
using Converter = std::function<ParameterValue(const InputValue&)>;

// One value, a list or a range (range.hpp), each converted; throws InputError, also for a value
// that stands twice.
Axis axis(const std::string& name, const InputValue& value, const Converter& convert);

// The table `parameters`: an axis for each entry, checked against the scenario; throws InputError.
std::vector<Axis> parameter_axes(const Scenario& scenario, const InputValue& table);

// The table `knobs` of the engines that `selector` chooses, each value in the knob's range; throws
// InputError.
std::vector<Axis> knob_axes(const InputValue& table, const Selector& selector,
                            const Catalogues& catalogues);

// The list `zip`: groups of axes of equal length, each axis in one group at most; throws
// InputError.
std::vector<std::vector<std::string>> zip_groups(const InputValue& list,
                                                 const std::vector<Axis>& axes);

}  // namespace brickbench
