// An adapter made of a running program: an engine in another process, like any other engine.
//
// Its choices: one process per simulation; the CPU time of a step is what the engine says, so that
// transport is not billed to it; a program without set-state is built anew by the seam. No scheme
// is published, and no setting is demanded of its audit: the protocol states neither.
#pragma once

#include <string>

#include "adapters/remote/process.hpp"
#include "adapters/seam/adapter.hpp"

namespace brickbench::remote {

// Starts the program once to learn what it is; `name` is the engine's in selectors and tables.
// Fails as EngineProcess::ask() does, with the program's own words in the reason.
Expected<Adapter> remote_adapter(const std::string& name, const Command& command);

// Runs a program to its end, within the limits of the command; the first line of its standard
// output. Fault::crashed where there is none.
Expected<std::string> first_line_of(const Command& command);

}  // namespace brickbench::remote
