#include "ourengine/linear/block_lu.hpp"

#include <cassert>

namespace ourengine {

bool BlockLu::factor(const SystemView& system, std::span<const PairTarget> targets,
                     const BlockPattern& pattern, const AlignedDoubles& d) {
  assert(system.components == 3);
  pattern_ = &pattern;
  const std::size_t doubles = static_cast<std::size_t>(kBlockSize) * pattern_->row.size();
  if (lower_.size() < doubles) {
    lower_.resize(doubles);
    upper_.resize(doubles);
  }
  scratch_.resize(static_cast<std::size_t>(pattern_->columns));
  kernels_->assemble_general(system, d.data(), targets.data(), *pattern_, lower_.data(),
                             upper_.data());
  ++factorisations_;
  return kernels_->factor_general(*pattern_, scratch_.data(), lower_.data(), upper_.data());
}

void BlockLu::solve(AlignedDoubles& x) const {
  assert(pattern_ != nullptr);
  kernels_->solve_general(*pattern_, lower_.data(), upper_.data(), x.data());
}

}  // namespace ourengine
