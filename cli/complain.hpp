// How every verb says on standard error what went wrong.
#pragma once

#include <string>

#include "adapters/seam/failure.hpp"

namespace brickbench {

// Prints the message on standard error; returns `code`.
int complain(const std::string& message, int code);
// The exit code that the failure asks for.
int complain(const Failure& failure);

}  // namespace brickbench
