// The guard around every simulation: what the seam promises of engines, done once for all of them.
#pragma once

#include "adapters/seam/adapter.hpp"

namespace brickbench {

// What build() of adapter.hpp returns for a valid world and settled settings.
Expected<std::unique_ptr<Simulation>> build_guarded(const Adapter& adapter, const World& world,
                                                    const Settings& settings);

}  // namespace brickbench
