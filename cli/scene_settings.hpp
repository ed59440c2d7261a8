// key=value settings of one scene's parameters, as verbs without a plan take them.
#pragma once

#include <string>
#include <vector>

#include "experiments/scenarios/scenario.hpp"

namespace brickbench {

// Numbers, true and false, words. Fault::invalid for what is no key=value.
Expected<ParameterValues> scene_settings(const std::vector<std::string>& settings);

}  // namespace brickbench
