// The open questions of the project: failures of exact cases that are known.
#pragma once

#include <string>
#include <vector>

#include "experiments/exact/validation/open_questions.hpp"

namespace brickbench {

// Those of the file asked for, or, if that is empty, of the tree that the plans come from; none,
// and a word on standard error, where that has no such file.
Expected<std::vector<exact::OpenQuestion>> known_questions(const std::string& asked = "");

}  // namespace brickbench
