// The checks of `validate` that take a scene instead of a case.
#pragma once

#include <string>
#include <vector>

#include "experiments/run/catalogues.hpp"
#include "experiments/run/selector.hpp"

namespace brickbench {

// Scenes against their images under the symmetries of mechanics: how far they part, and how fast.
// `scene`: a scenario with its default parameters except those given, or "all". Prints; returns the
// exit code.
int compare_symmetries(const std::vector<EngineVariant>& engines, const Catalogues& catalogues,
                       const std::string& scene, const ParameterValues& given, bool json);

// The largest step with which each engine keeps a scene at rest for 2 s.
int search_stable_steps(const std::vector<EngineVariant>& engines, const Catalogues& catalogues,
                        const std::string& scene, bool json);

}  // namespace brickbench
