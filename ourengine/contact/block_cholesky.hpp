// Sparse Cholesky of H = M + J^T D J in 6x6 blocks, on the pattern kept by a ContactSystem.
#pragma once

#include <vector>

#include "ourengine/contact/kernels.hpp"
#include "ourengine/contact/system.hpp"

namespace ourengine {

class BlockCholesky {
 public:
  explicit BlockCholesky(const Kernels& kernels = simd_kernels()) : kernels_(&kernels) {}

  // Assembles and factors H for the weights D (layout: Kernels::assemble). The buffers are kept
  // from call to call. False if H is not positive definite to rounding.
  bool factor(const ContactSystem& system, const AlignedDoubles& d);
  // x = H^-1 x; per-body layout.
  void solve(AlignedDoubles& x) const;

  int factorisations() const { return factorisations_; }

 private:
  const Kernels* kernels_;
  const BlockPattern* pattern_ = nullptr;
  AlignedDoubles blocks_;
  std::vector<int> scratch_;
  int factorisations_ = 0;
};

}  // namespace ourengine
