// Per-contact loops of the interior-point methods, over whole arrays.
//
// Arrays are component by component with the stride of the system; cones are second-order cones
// { (x0, x1, x2): |(x1, x2)| <= x0 }, obtained from Coulomb's by scaling with (1, mu, mu). The
// arithmetic is element by element and without fused operations, the same on every processor.
#pragma once

#include <cstddef>

namespace ourengine {

// State of a second-order-cone interior-point iteration; 3 x stride unless said.
struct ConeArrays {
  std::size_t stride = 0;
  const double* friction = nullptr;          // stride
  double *s = nullptr, *z = nullptr;         // slack (velocity) and multiplier (impulse)
  double *jw = nullptr, *vv = nullptr;       // Nesterov-Todd scaling point, reflected, and root
  double* beta = nullptr;                    // stride: length of the scaling
  double *lambda = nullptr, *rhs = nullptr;  // scaled point, complementarity right-hand side
  double* primal = nullptr;                  // J v + b - s
  double *y = nullptr, *jd = nullptr;        // work; J dv
  double *a = nullptr, *b = nullptr;         // scaled directions W^-1 ds, W dz
  double *ds = nullptr, *dz = nullptr;
  double* ratio = nullptr;  // stride: largest 1 / step
  double* d = nullptr;      // 6 x stride: weights of H
};

// Arrays of the frictionless interior point; `stride` each.
struct OrthantArrays {
  std::size_t stride = 0;
  double *f = nullptr, *w = nullptr, *primal = nullptr;
  double *inverse_f = nullptr, *inverse_w = nullptr;
  double* rhs = nullptr;  // complementarity right-hand side over f
  double *y = nullptr, *jd = nullptr, *df = nullptr, *dw = nullptr, *ratio = nullptr;
  double* d = nullptr;
  const double* regular = nullptr;  // proximal term per contact
};

// One proximal evaluation of Coulomb's law at all contacts; 3 x stride unless said:
//   f = P_K(centre - K (w + shift e_n)),   K = 1 / (softness * A).
struct ProximalArrays {
  std::size_t stride = 0;
  double softness = 1.0;
  const double* friction = nullptr;  // stride
  const double* delassus = nullptr;  // stride: A
  const double* centre = nullptr;
  const double* w = nullptr;
  const double* shift = nullptr;  // stride; null: mu |w_t| of w itself
  double* f = nullptr;
  double* d = nullptr;  // -df/dw: 6 x stride (symmetric) with `shift`, else 9 x stride
};

struct ConeKernels {
  // w (Coulomb's frame) -> scaled by (1, mu, mu), in place.
  void (*scale)(std::size_t stride, const double* friction, double* x);
  // jw, vv, beta, lambda and d from s and z; rhs = -lambda.
  void (*scaling)(const ConeArrays& arrays);
  // y = (1, mu, mu) * (W^-1 rhs - W^-2 primal), for J^T.
  void (*right_side)(const ConeArrays& arrays);
  // ds, dz, a, b, ratio from y, jd.
  void (*direction)(const ConeArrays& arrays);
  // rhs of the corrector with centring `target` and correction clipped at `limit`.
  void (*corrector)(const ConeArrays& arrays, double target, double limit);
  // The orthant's: d, inverses and the predictor's rhs; y; directions; corrector.
  void (*orthant_scaling)(const OrthantArrays& arrays);
  void (*orthant_right_side)(const OrthantArrays& arrays);
  void (*orthant_direction)(const OrthantArrays& arrays);
  void (*orthant_corrector)(const OrthantArrays& arrays, double target, double limit);
  // f alone, and f with its derivative.
  void (*proximal)(const ProximalArrays& arrays);
  void (*proximal_derivative)(const ProximalArrays& arrays);
};

const ConeKernels& cone_kernels();

// Scalar product and maximum in a fixed order over `n` (multiple of 8) entries.
double ordered_dot(const double* x, const double* y, std::size_t n);
double ordered_max(const double* x, std::size_t n);

}  // namespace ourengine
