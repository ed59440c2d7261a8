// Audit: what the live engine objects hold against the facts of the World, before any score.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "adapters/seam/simulation.hpp"
#include "adapters/seam/world.hpp"

namespace brickbench::exact {

// One sentence per fact that did not arrive: gravity, and for each body fixedness, mass, inertia,
// shape, damping (must be 0), sleeping (must be off); and the law of every pair with a moving body.
// Masses and the like may differ by 1e-12 of their size. Each of the `asked` settings must stand in
// the audit under its name with the same text. Empty: all arrived.
std::vector<std::string> audit_differences(const World& world, const AuditView& view,
                                           std::span<const AuditFact> asked = {});

}  // namespace brickbench::exact
