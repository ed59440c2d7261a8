// What this build knows: every catalogue, and the engines that it was configured without.
#pragma once

#include <string>
#include <vector>

#include "experiments/run/catalogues.hpp"

namespace brickbench {

// All that is linked.
Catalogues all_catalogues();

struct AbsentEngine {
  std::string name;
  std::string packages;  // Debian packages that hold it; empty: it was switched off on purpose
  std::string why;       // its program is no use; empty for engines that are linked or not
};

// Known engines that the catalogues have no adapter for.
std::vector<AbsentEngine> absent_engines(const Catalogues& catalogues);

}  // namespace brickbench
