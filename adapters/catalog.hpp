// The engines linked into this build. The definition is generated from the enabled CMake targets.
#pragma once

#include <vector>

#include "adapters/seam/adapter.hpp"

namespace brickbench {

// In the order of adapters/CMakeLists.txt.
std::vector<Adapter> adapters();

}  // namespace brickbench
