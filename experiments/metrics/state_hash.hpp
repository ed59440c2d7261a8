// StateHash: one fingerprint for all states of a run, for the `state_hash` column. Two runs with
// equal fingerprints went through bitwise equal states.
#pragma once

#include <cstdint>
#include <string>

#include "experiments/metrics/metric.hpp"

namespace brickbench {

class StateHash {
 public:
  // Called for step 0 and after every step.
  void observe(const Sample& sample);
  // 16 hexadecimal digits: all states of all steps so far, in order.
  std::string hex() const;

 private:
  std::uint64_t hash_ = 0;
};

}  // namespace brickbench
