// Any engine of the seam, offered over docs/protocol.md.
#pragma once

#include "adapters/seam/adapter.hpp"

namespace brickbench::remote {

// Answers the requests that come in on descriptor `in`, with frames on `out`, until there are no
// more. Fault::crashed where they are not those of the protocol, or cannot be answered.
Expected<void> serve(const Adapter& adapter, int in, int out);

}  // namespace brickbench::remote
