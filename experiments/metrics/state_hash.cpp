#include "experiments/metrics/state_hash.hpp"

#include <fmt/core.h>

namespace brickbench {

void StateHash::observe(const Sample& sample) {
  all_ = hash_states(sample.states, all_);
  last_ = hash_states(sample.states);
}

std::string StateHash::hex() const { return fmt::format("{:016x}", all_); }

std::string StateHash::final_hex() const { return fmt::format("{:016x}", last_); }

}  // namespace brickbench
