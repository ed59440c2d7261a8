#include "ourengine/linear/block_cholesky.hpp"

#include <atomic>
#include <cassert>

namespace ourengine {
namespace {

void make_room(AlignedDoubles& store, std::size_t doubles) {
  if (store.size() < doubles) store.resize(doubles);
}

}  // namespace

bool BlockCholesky::factor(const SystemView& system, const FrontalView& fronts,
                           const AlignedDoubles& d) {
  fronts_ = fronts;
  make_room(panels_, fronts_.fronts->panel_doubles);
  make_room(updates_, fronts_.fronts->update_doubles);
  make_room(scratch_, fronts_.fronts->scratch_doubles * static_cast<std::size_t>(threads()));
  make_room(vectors_, fronts_.fronts->vector_doubles);
  ++factorisations_;
  std::atomic<bool> positive = true;
  const auto factor = [&](const FrontTask& task, std::size_t thread) {
    const FrontStores stores = {panels_.data(), updates_.data(),
                                scratch_.data() + thread * fronts_.fronts->scratch_doubles};
    if (!kernels_->factor_fronts(system, fronts_, d.data(), task, stores))
      positive.store(false, std::memory_order_relaxed);
  };
  for_subtrees(factor);
  for (const FrontTask& part : fronts_.fronts->rest) factor(part, 0);
  return positive;
}

void BlockCholesky::solve(AlignedDoubles& x) {
  assert(fronts_.fronts != nullptr);
  const auto forward = [&](const FrontTask& task, std::size_t) {
    kernels_->solve_fronts_forward(fronts_, task, panels_.data(), vectors_.data(), x.data());
  };
  const auto backward = [&](const FrontTask& task, std::size_t) {
    kernels_->solve_fronts_backward(fronts_, task, panels_.data(), vectors_.data(), x.data());
  };
  for_subtrees(forward);
  const std::vector<FrontTask>& rest = fronts_.fronts->rest;
  for (const FrontTask& part : rest) forward(part, 0);
  for (auto part = rest.rbegin(); part != rest.rend(); ++part) backward(*part, 0);
  for_subtrees(backward);
}

template <class Work>
void BlockCholesky::for_subtrees(Work&& work) const {
  const std::vector<FrontTask>& subtrees = fronts_.fronts->subtree;
  std::atomic<std::size_t> left = subtrees.size();
  const auto serve = [&](std::size_t thread) {
    for (std::size_t i = left.load(); i > 0;) {
      if (left.compare_exchange_weak(i, i - 1)) work(subtrees[--i], thread);
      i = left.load();
    }
  };
  if (workers_ == nullptr || subtrees.empty()) return serve(0);
  workers_->for_ranges(static_cast<std::size_t>(threads()), 1,
                       [&](std::size_t begin, std::size_t) noexcept { serve(begin); });
}

}  // namespace ourengine
