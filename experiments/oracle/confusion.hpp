// Confusion matrix: which of many labelled assemblies stand in an engine, against static truth.
#pragma once

#include <map>
#include <span>
#include <string>

#include "adapters/seam/adapter.hpp"
#include "experiments/oracle/assemblies.hpp"

namespace brickbench::gate {

// Whether a brick is further than a fifth of its smallest edge from its start at some moment in
// `steps` steps, looked at 20 times. Fails as the engine does, or with Fault::diverged.
Expected<bool> moves(const Adapter& adapter, const Settings& settings, const World& world,
                     std::size_t steps);

struct Confusion {
  int stands_stood = 0;
  int stands_moved = 0;
  int falls_stood = 0;
  int falls_moved = 0;
  std::map<std::string, int> wrong;   // "stands but moved, tower": how many
  std::map<std::string, int> failed;  // outcome: how many
  std::string reason;                 // of the last failure
};

Confusion confusion(const Adapter& adapter, const Settings& settings,
                    std::span<const LabelledAssembly> assemblies, std::size_t steps);

}  // namespace brickbench::gate
