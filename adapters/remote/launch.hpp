// Starting a program with a channel to it.
#pragma once

#include <string>
#include <vector>

#include "adapters/seam/failure.hpp"

namespace brickbench::remote {

struct Child {
  int pid = -1;      // leader of a process group of its own
  int channel = -1;  // socket that is the program's standard input and output
  int errors = -1;   // read end of its standard error; does not block
};

// Runs `words` (program and arguments) in `folder` with NAME=value of `environment` on top of the
// environment of this process. A program without '/' is looked for in PATH. Signals are at their
// defaults, no other descriptor stays open, and the program dies when the starting thread ends.
// Fault::crashed where it does not start, with what the system says.
Expected<Child> start_program(const std::vector<std::string>& words, const std::string& folder,
                              const std::vector<std::string>& environment);

}  // namespace brickbench::remote
