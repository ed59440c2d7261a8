// Sparse LU of H = M + J^T D J in 6x6 blocks for weights D that are not symmetric, on a given
// pattern. No pivoting between blocks: the caller checks what it gets.
#pragma once

#include <span>
#include <vector>

#include "ourengine/linear/kernels.hpp"
#include "ourengine/linear/ordering.hpp"

namespace ourengine {

class BlockLu {
 public:
  explicit BlockLu(const Kernels& kernels = simd_kernels()) : kernels_(&kernels) {}

  // D per contact: D_kl at (3 k + l) * stride; targets: where each pair of bodies is in the
  // pattern, which must outlive the solves. False if a diagonal block was singular.
  bool factor(const SystemView& system, std::span<const PairTarget> targets,
              const BlockPattern& pattern, const AlignedDoubles& d);
  // x = H^-1 x; per-body layout.
  void solve(AlignedDoubles& x) const;

  int factorisations() const { return factorisations_; }

 private:
  const Kernels* kernels_;
  const BlockPattern* pattern_ = nullptr;
  AlignedDoubles lower_, upper_;
  std::vector<int> scratch_;
  int factorisations_ = 0;
};

}  // namespace ourengine
