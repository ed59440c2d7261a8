// The parts of the SIMD kernels, each dispatched in its own file.
#pragma once

#include "ourengine/linear/kernels.hpp"

namespace ourengine::linear {

void add_products(Kernels& kernels);
void add_factorisations(Kernels& kernels);
void add_fronts(Kernels& kernels);

}  // namespace ourengine::linear
