// Fingerprint of a run: one hash over all states of a small wall that is hit by a brick.
#pragma once

#include <cstdint>
#include <string>

#include "adapters/seam/adapter.hpp"

namespace brickbench::testing {

// A 3 x 3 stack-bond wall, hit after a few steps by a brick at 8 m/s, friction as given.
World hit_wall(double friction);

// The hash of all states of the first 0.2 s of a world at 1/1000 s; 0 where it is refused. A
// failure later in the run is part of the fingerprint, with its reason. `what` says how it went.
std::uint64_t fingerprint(const Adapter& adapter, const std::string& variant, const World& world,
                          std::string& what);

// That of the hit wall with friction, or without for an engine that refuses friction.
std::uint64_t wall_fingerprint(const Adapter& adapter, const std::string& variant,
                               std::string& what);

}  // namespace brickbench::testing
