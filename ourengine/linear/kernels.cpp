#include "ourengine/linear/kernels.hpp"

#include "ourengine/linear/kernels_simd.hpp"

namespace ourengine {

const Kernels& simd_kernels() {
  static const Kernels chosen = [] {
    Kernels kernels{};
    linear::add_products(kernels);
    linear::add_factorisations(kernels);
    linear::add_fronts(kernels);
    return kernels;
  }();
  return chosen;
}

}  // namespace ourengine
