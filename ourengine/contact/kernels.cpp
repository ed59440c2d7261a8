#include "ourengine/contact/kernels.hpp"

#include "ourengine/contact/kernels_simd.hpp"

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
