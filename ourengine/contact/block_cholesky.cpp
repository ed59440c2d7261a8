#include "ourengine/contact/block_cholesky.hpp"

#include <cassert>

namespace ourengine {

bool BlockCholesky::factor(const ContactSystem& system, const AlignedDoubles& d) {
  pattern_ = &system.symbolic().pattern;
  const std::size_t doubles = static_cast<std::size_t>(kBlockSize) * pattern_->row.size();
  if (blocks_.size() < doubles) blocks_.resize(doubles);
  scratch_.resize(static_cast<std::size_t>(pattern_->columns));
  kernels_->assemble(system.view(), d.data(), system.targets().data(), *pattern_, blocks_.data());
  ++factorisations_;
  return kernels_->factor(*pattern_, scratch_.data(), blocks_.data());
}

void BlockCholesky::solve(AlignedDoubles& x) const {
  assert(pattern_ != nullptr);
  kernels_->solve(*pattern_, blocks_.data(), x.data());
}

}  // namespace ourengine
