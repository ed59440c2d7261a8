// The parts of the scalar twin that are in files of their own.
#pragma once

#include "ourengine/linear/kernels.hpp"

namespace ourengine::scalar {

bool factor_fronts(const SystemView& system, const FrontalView& view, const double* d,
                   FrontTask task, const FrontStores& stores);
void solve_fronts_forward(const FrontalView& view, FrontTask task, const double* panels,
                          double* vectors, double* x);
void solve_fronts_backward(const FrontalView& view, FrontTask task, const double* panels,
                           double* vectors, double* x);

}  // namespace ourengine::scalar
