#include "experiments/metrics/state_hash.hpp"

#include <fmt/core.h>

namespace brickbench {

void StateHash::observe(const Sample& sample) { hash_ = hash_states(sample.states, hash_); }

std::string StateHash::hex() const { return fmt::format("{:016x}", hash_); }

}  // namespace brickbench
