// Blows: impulses of a sub-step that no load explains.
//
// An impulse up to twice what the sub-step began with, and the weight of both bodies, is a load and
// goes on to the next sub-step. What is beyond was a blow: it needs more sweeps than a load, since
// it runs through all that touches within one sub-step, and carried on it would throw the bodies
// apart again. Plain code: both passes are short beside a sweep.
#pragma once

#include <span>

#include "ourengine/fast/soft_batch.hpp"

namespace ourengine {

bool soft_has_blow(std::span<const SoftBatch> batches);

// Leaves the batches with their loads, friction in proportion. The rest is added to the velocity
// (bodies + 1) that the bodies would have without contact, from which the next sub-step's start is
// counted.
void soft_drop_blows(std::span<SoftBatch> batches, std::span<SoftVector> free_velocity);

}  // namespace ourengine
