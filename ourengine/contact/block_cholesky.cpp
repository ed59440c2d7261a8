#include "ourengine/contact/block_cholesky.hpp"

#include <cassert>

namespace ourengine {
namespace {

void make_room(AlignedDoubles& store, std::size_t doubles) {
  if (store.size() < doubles) store.resize(doubles);
}

}  // namespace

bool BlockCholesky::factor(const ContactSystem& system, const AlignedDoubles& d) {
  fronts_ = system.fronts();
  make_room(panels_, fronts_.fronts->panel_doubles);
  make_room(updates_, fronts_.fronts->update_doubles);
  make_room(vectors_, fronts_.fronts->vector_doubles);
  ++factorisations_;
  bool positive = true;
  for (const FrontTask& task : fronts_.fronts->task) {
    positive = kernels_->factor_fronts(system.view(), fronts_, d.data(), task, panels_.data(),
                                       updates_.data()) &&
               positive;
  }
  return positive;
}

void BlockCholesky::solve(AlignedDoubles& x) {
  assert(fronts_.fronts != nullptr);
  const auto& tasks = fronts_.fronts->task;
  for (const FrontTask& task : tasks) {
    kernels_->solve_fronts_forward(fronts_, task, panels_.data(), vectors_.data(), x.data());
  }
  for (auto task = tasks.rbegin(); task != tasks.rend(); ++task) {
    kernels_->solve_fronts_backward(fronts_, *task, panels_.data(), vectors_.data(), x.data());
  }
}

}  // namespace ourengine
