// Sparse Cholesky of H = M + J^T D J in 6x6 blocks, on given fronts.
#pragma once

#include <memory>
#include <utility>

#include "ourengine/linear/kernels.hpp"
#include "ourengine/parallel/worker_pool.hpp"

namespace ourengine {

class BlockCholesky {
 public:
  explicit BlockCholesky(const Kernels& kernels = simd_kernels()) : kernels_(&kernels) {}

  // Assembles and factors H for the weights D (layout: Kernels::factor_fronts). The buffers are
  // kept from call to call. False if H is not positive definite to rounding.
  bool factor(const SystemView& system, const FrontalView& fronts, const AlignedDoubles& d);
  // x = H^-1 x; per-body layout. What the views of the last factor() look at must be alive.
  void solve(AlignedDoubles& x);

  // Threads that share the work from now on; null: none. They change no bit of a result.
  void share(std::shared_ptr<WorkerPool> workers) { workers_ = std::move(workers); }

  int factorisations() const { return factorisations_; }

 private:
  // work(subtree, thread) for each subtree.
  template <class Work>
  void for_subtrees(Work&& work) const;
  int threads() const { return workers_ == nullptr ? 1 : workers_->threads(); }

  const Kernels* kernels_;
  std::shared_ptr<WorkerPool> workers_;
  FrontalView fronts_;
  AlignedDoubles panels_, updates_, scratch_, vectors_;

  int factorisations_ = 0;
};

}  // namespace ourengine
