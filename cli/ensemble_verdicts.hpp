// Verdicts of the gate's statistics on ensembles that reports collected.
#pragma once

#include "reports/src/ensembles.hpp"

namespace brickbench {

// Judges every pair: energy distance with permutation p-values, all pairs one family under Holm's
// procedure; two one-sided tests of the means for those that are not different.
void judge(Ensembles& ensembles);

}  // namespace brickbench
