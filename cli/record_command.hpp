// The command that makes a run again with its motion recorded.
#pragma once

#include <string>
#include <vector>

#include "experiments/record/provenance.hpp"

namespace brickbench {

// `words` of a `brickbench run`, quoted for the shell, without --out and with --record.
std::string record_command(const std::vector<std::string>& words);

// Of the run whose folder has this provenance; empty if another verb made it.
std::string record_command(const Provenance& provenance);

}  // namespace brickbench
