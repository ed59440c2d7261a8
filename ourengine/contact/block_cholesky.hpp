// Sparse Cholesky of H = M + J^T D J in 6x6 blocks, on the fronts kept by a ContactSystem.
#pragma once

#include "ourengine/contact/kernels.hpp"
#include "ourengine/contact/system.hpp"

namespace ourengine {

class BlockCholesky {
 public:
  explicit BlockCholesky(const Kernels& kernels = simd_kernels()) : kernels_(&kernels) {}

  // Assembles and factors H for the weights D (layout: Kernels::factor_fronts). The buffers are
  // kept from call to call. False if H is not positive definite to rounding.
  bool factor(const ContactSystem& system, const AlignedDoubles& d);
  // x = H^-1 x; per-body layout. `system` of the last factor() must be alive.
  void solve(AlignedDoubles& x);

  int factorisations() const { return factorisations_; }

 private:
  const Kernels* kernels_;
  FrontalView fronts_;
  AlignedDoubles panels_, updates_, vectors_;
  int factorisations_ = 0;
};

}  // namespace ourengine
