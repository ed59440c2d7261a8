// Verdicts of the gate's statistics on ensembles that reports collected.
#pragma once

#include "reports/src/ensembles.hpp"

namespace brickbench {

// Judges every pair by itself: energy distance with p-values by relabelling, equivalence of the
// means. No verdict depends on what other pairs there are.
void judge(Ensembles& ensembles);

}  // namespace brickbench
