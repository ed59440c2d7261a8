#include "ourengine/contact/cone_kernels.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ourengine/contact/cone_kernels.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway demands.
#include <hwy/highway.h>

// Plain loops, compiled once per instruction set: the compiler vectorises them (for this file,
// CMakeLists.txt reads `omp simd` and switches errno and floating-point traps off; none of the
// three changes a value).
HWY_BEFORE_NAMESPACE();
namespace ourengine::cones::HWY_NAMESPACE {

void scale(std::size_t n, const double* friction, double* x) {
#pragma omp simd
  for (std::size_t i = 0; i < n; ++i) {
    x[n + i] *= friction[i];
    x[2 * n + i] *= friction[i];
  }
}

// x0^2 - |(x1, x2)|^2 without cancellation.
HWY_INLINE double cone_determinant(double x0, double x1, double x2) {
  const double t = std::sqrt(x1 * x1 + x2 * x2);
  const double det = (x0 - t) * (x0 + t);
  return det > 1e-300 ? det : 1e-300;
}

void scaling(const ConeArrays& c) {
  const std::size_t n = c.stride;
  const double *s = c.s, *z = c.z, *mu = c.friction;
  double *jw = c.jw, *vv = c.vv, *lambda = c.lambda;
  double *rhs = c.rhs, *d = c.d, *beta = c.beta;
#pragma omp simd
  for (std::size_t i = 0; i < n; ++i) {
    const double qs = std::sqrt(cone_determinant(s[i], s[n + i], s[2 * n + i]));
    const double qz = std::sqrt(cone_determinant(z[i], z[n + i], z[2 * n + i]));
    const double is = 1.0 / qs, iz = 1.0 / qz;
    const double s0 = s[i] * is, s1 = s[n + i] * is, s2 = s[2 * n + i] * is;
    const double z0 = z[i] * iz, z1 = z[n + i] * iz, z2 = z[2 * n + i] * iz;
    const double half = 0.5 / std::sqrt(0.5 * (1.0 + (s0 * z0 + s1 * z1 + s2 * z2)));
    const double w0 = (s0 + z0) * half, w1 = (s1 - z1) * half, w2 = (s2 - z2) * half;
    const double q = 1.0 / std::sqrt(2.0 * (w0 + 1.0));
    const double v0 = (w0 + 1.0) * q, v1 = w1 * q, v2 = w2 * q;
    const double be = std::sqrt(qs * iz);
    const double vz = 2.0 * (v0 * z[i] + v1 * z[n + i] + v2 * z[2 * n + i]);
    const double l0 = be * (vz * v0 - z[i]), l1 = be * (vz * v1 + z[n + i]),
                 l2 = be * (vz * v2 + z[2 * n + i]);
    jw[i] = w0;
    jw[n + i] = -w1;
    jw[2 * n + i] = -w2;
    vv[i] = v0;
    vv[n + i] = v1;
    vv[2 * n + i] = v2;
    beta[i] = be;
    lambda[i] = l0;
    lambda[n + i] = l1;
    lambda[2 * n + i] = l2;
    rhs[i] = -l0;
    rhs[n + i] = -l1;
    rhs[2 * n + i] = -l2;
    const double g = 1.0 / (be * be), gm = g * mu[i], gmm = gm * mu[i];
    d[i] = g * (2.0 * w0 * w0 - 1.0);
    d[n + i] = -gm * (2.0 * w0 * w1);
    d[2 * n + i] = -gm * (2.0 * w0 * w2);
    d[3 * n + i] = gmm * (2.0 * w1 * w1 + 1.0);
    d[4 * n + i] = gmm * (2.0 * w1 * w2);
    d[5 * n + i] = gmm * (2.0 * w2 * w2 + 1.0);
  }
}

void right_side(const ConeArrays& c) {
  const std::size_t n = c.stride;
  const double *jw = c.jw, *vv = c.vv, *beta = c.beta;
  const double *r = c.rhs, *p = c.primal, *mu = c.friction;
  double* y = c.y;
#pragma omp simd
  for (std::size_t i = 0; i < n; ++i) {
    const double ib = 1.0 / beta[i], ibb = ib * ib;
    // W^-1 = (2 (Jv)(Jv)^T - J) / beta,  W^-2 = (2 (Jw)(Jw)^T - J) / beta^2
    const double vr = 2.0 * (vv[i] * r[i] - vv[n + i] * r[n + i] - vv[2 * n + i] * r[2 * n + i]);
    const double wp = 2.0 * (jw[i] * p[i] + jw[n + i] * p[n + i] + jw[2 * n + i] * p[2 * n + i]);
    y[i] = ib * (vr * vv[i] - r[i]) - ibb * (wp * jw[i] - p[i]);
    y[n + i] = mu[i] * (ib * (r[n + i] - vr * vv[n + i]) - ibb * (wp * jw[n + i] + p[n + i]));
    y[2 * n + i] = mu[i] * (ib * (r[2 * n + i] - vr * vv[2 * n + i]) -
                            ibb * (wp * jw[2 * n + i] + p[2 * n + i]));
  }
}

// max(0, 1 / largest step) along the scaled direction x from lambda inside the cone.
HWY_INLINE double inverse_step(double l0, double l1, double l2, double x0, double x1, double x2) {
  const double il = 1.0 / std::sqrt(cone_determinant(l0, l1, l2));
  const double b0 = l0 * il, b1 = l1 * il, b2 = l2 * il;
  const double r0 = b0 * x0 - b1 * x1 - b2 * x2;
  const double k = (r0 + x0) / (b0 + 1.0);
  const double t1 = x1 - k * b1, t2 = x2 - k * b2;
  return il * (std::sqrt(t1 * t1 + t2 * t2) - r0);
}

void direction(const ConeArrays& c) {
  const std::size_t n = c.stride;
  const double *vv = c.vv, *beta = c.beta;
  const double *r = c.rhs, *p = c.primal, *jd = c.jd;
  const double* lambda = c.lambda;
  double *ds = c.ds, *dz = c.dz, *a = c.a;
  double *b = c.b, *ratio = c.ratio;
#pragma omp simd
  for (std::size_t i = 0; i < n; ++i) {
    const double ib = 1.0 / beta[i];
    const double d0 = jd[i] + p[i], d1 = jd[n + i] + p[n + i], d2 = jd[2 * n + i] + p[2 * n + i];
    const double vd = 2.0 * (vv[i] * d0 - vv[n + i] * d1 - vv[2 * n + i] * d2);
    const double a0 = ib * (vd * vv[i] - d0), a1 = ib * (d1 - vd * vv[n + i]),
                 a2 = ib * (d2 - vd * vv[2 * n + i]);
    const double b0 = r[i] - a0, b1 = r[n + i] - a1, b2 = r[2 * n + i] - a2;
    const double vb = 2.0 * (vv[i] * b0 - vv[n + i] * b1 - vv[2 * n + i] * b2);
    dz[i] = ib * (vb * vv[i] - b0);
    dz[n + i] = ib * (b1 - vb * vv[n + i]);
    dz[2 * n + i] = ib * (b2 - vb * vv[2 * n + i]);
    ds[i] = d0;
    ds[n + i] = d1;
    ds[2 * n + i] = d2;
    a[i] = a0;
    a[n + i] = a1;
    a[2 * n + i] = a2;
    b[i] = b0;
    b[n + i] = b1;
    b[2 * n + i] = b2;
    const double l0 = lambda[i], l1 = lambda[n + i], l2 = lambda[2 * n + i];
    const double ra = inverse_step(l0, l1, l2, a0, a1, a2);
    const double rb = inverse_step(l0, l1, l2, b0, b1, b2);
    ratio[i] = ra > rb ? ra : rb;
  }
}

void corrector(const ConeArrays& c, double target, double limit) {
  const std::size_t n = c.stride;
  const double *a = c.a, *b = c.b, *l = c.lambda;
  double* r = c.rhs;
#pragma omp simd
  for (std::size_t i = 0; i < n; ++i) {
    const double c0 = a[i] * b[i] + a[n + i] * b[n + i] + a[2 * n + i] * b[2 * n + i];
    const double c1 = a[i] * b[n + i] + b[i] * a[n + i];
    const double c2 = a[i] * b[2 * n + i] + b[i] * a[2 * n + i];
    const double size = std::abs(c0) + std::abs(c1) + std::abs(c2);
    const double clip = size > limit ? limit / size : 1.0;
    const double l0 = l[i], l1 = l[n + i], l2 = l[2 * n + i];
    const double d0 = target - (l0 * l0 + l1 * l1 + l2 * l2) - clip * c0;
    const double d1 = -2.0 * l0 * l1 - clip * c1;
    const double d2 = -2.0 * l0 * l2 - clip * c2;
    const double x0 = (l0 * d0 - l1 * d1 - l2 * d2) / cone_determinant(l0, l1, l2);
    const double il = 1.0 / l0;
    r[i] = x0;
    r[n + i] = (d1 - x0 * l1) * il;
    r[2 * n + i] = (d2 - x0 * l2) * il;
  }
}

void orthant_scaling(const OrthantArrays& o) {
  const double *f = o.f, *w = o.w, *regular = o.regular;
  double *inverse_f = o.inverse_f, *inverse_w = o.inverse_w;
  double *rhs = o.rhs, *d = o.d;
#pragma omp simd
  for (std::size_t i = 0; i < o.stride; ++i) {
    inverse_f[i] = 1.0 / f[i];
    inverse_w[i] = 1.0 / w[i];
    rhs[i] = w[i];
    d[i] = 1.0 / (w[i] * inverse_f[i] + regular[i]);
  }
}

void orthant_right_side(const OrthantArrays& o) {
  const double *rhs = o.rhs, *primal = o.primal, *d = o.d;
  double* y = o.y;
#pragma omp simd
  for (std::size_t i = 0; i < o.stride; ++i) y[i] = -(rhs[i] + primal[i]) * d[i];
}

void orthant_direction(const OrthantArrays& o) {
  const double *rhs = o.rhs, *primal = o.primal, *d = o.d;
  const double *jd = o.jd, *w = o.w;
  const double *inverse_f = o.inverse_f, *inverse_w = o.inverse_w;
  double *df = o.df, *dw = o.dw, *ratio = o.ratio;
#pragma omp simd
  for (std::size_t i = 0; i < o.stride; ++i) {
    const double step_f = -(rhs[i] + primal[i] + jd[i]) * d[i];
    const double relative_f = step_f * inverse_f[i];
    const double step_w = -rhs[i] - w[i] * relative_f;
    const double relative_w = step_w * inverse_w[i];
    df[i] = step_f;
    dw[i] = step_w;
    ratio[i] = -(relative_f < relative_w ? relative_f : relative_w);
  }
}

void orthant_corrector(const OrthantArrays& o, double target, double limit) {
  const double *df = o.df, *dw = o.dw, *w = o.w;
  const double* inverse_f = o.inverse_f;
  double* rhs = o.rhs;
#pragma omp simd
  for (std::size_t i = 0; i < o.stride; ++i) {
    double q = df[i] * dw[i];
    q = q > limit ? limit : q;
    q = q < -limit ? -limit : q;
    rhs[i] = w[i] + (q - target) * inverse_f[i];
  }
}

// Projection on Coulomb's cone, branch-free, and what its derivative needs.
struct Projection {
  double n, t1, t2;    // projected
  double h1, h2;       // direction of the tangential part
  double stick, slip;  // 1 or 0: inside the cone, on its surface; neither: at the apex
  double round;        // derivative across the tangential direction, on the surface
};

HWY_INLINE Projection project(double mu, double p0, double p1, double p2) {
  const double t = std::sqrt(p1 * p1 + p2 * p2);
  const double it = 1.0 / (t > 1e-300 ? t : 1e-300);
  const double inside = p0 >= 0.0 ? mu * p0 - t : -1.0;
  const double stick = inside >= 0.0 ? 1.0 : 0.0;
  const double slip = mu * t + p0 > 0.0 ? 1.0 - stick : 0.0;
  const double n = (p0 + mu * t) / (1.0 + mu * mu);
  const double round = mu * n * it;
  const double scale = stick + slip * round;
  return {stick * p0 + slip * n, scale * p1, scale * p2, p1 * it, p2 * it, stick, slip, round};
}

template <bool kLagged>
HWY_INLINE void proximal_loop(const ProximalArrays& x) {
  const std::size_t n = x.stride;
  const double *w = x.w, *centre = x.centre, *mu = x.friction, *delassus = x.delassus;
  const double* shift = x.shift;
  double* f = x.f;
  const double softness = x.softness;
#pragma omp simd
  for (std::size_t i = 0; i < n; ++i) {
    const double k = 1.0 / (softness * delassus[i]);
    const double w1 = w[n + i], w2 = w[2 * n + i];
    const double lift = kLagged ? shift[i] : mu[i] * std::sqrt(w1 * w1 + w2 * w2);
    const Projection p = project(mu[i], centre[i] - k * (w[i] + lift), centre[n + i] - k * w1,
                                 centre[2 * n + i] - k * w2);
    f[i] = p.n;
    f[n + i] = p.t1;
    f[2 * n + i] = p.t2;
  }
}

void proximal(const ProximalArrays& x) {
  if (x.shift != nullptr)
    proximal_loop<true>(x);
  else
    proximal_loop<false>(x);
}

void proximal_derivative_lagged(const ProximalArrays& x) {
  const std::size_t n = x.stride;
  const double *w = x.w, *centre = x.centre, *mu = x.friction, *delassus = x.delassus;
  const double* shift = x.shift;
  double *f = x.f, *d = x.d;
  const double softness = x.softness;
#pragma omp simd
  for (std::size_t i = 0; i < n; ++i) {
    const double k = 1.0 / (softness * delassus[i]);
    const Projection p =
        project(mu[i], centre[i] - k * (w[i] + shift[i]), centre[n + i] - k * w[n + i],
                centre[2 * n + i] - k * w[2 * n + i]);
    f[i] = p.n;
    f[n + i] = p.t1;
    f[2 * n + i] = p.t2;
    const double c = p.slip * k / (1.0 + mu[i] * mu[i]), cm = c * mu[i], radial = cm * mu[i];
    const double round = p.slip * k * p.round, stick = k * p.stick;
    d[i] = stick + c;
    d[n + i] = cm * p.h1;
    d[2 * n + i] = cm * p.h2;
    d[3 * n + i] = stick + radial * p.h1 * p.h1 + round * p.h2 * p.h2;
    d[4 * n + i] = (radial - round) * p.h1 * p.h2;
    d[5 * n + i] = stick + radial * p.h2 * p.h2 + round * p.h1 * p.h1;
  }
}

void proximal_derivative_exact(const ProximalArrays& x) {
  const std::size_t n = x.stride;
  const double *w = x.w, *centre = x.centre, *mu = x.friction, *delassus = x.delassus;
  double *f = x.f, *d = x.d;
  const double softness = x.softness;
#pragma omp simd
  for (std::size_t i = 0; i < n; ++i) {
    const double k = 1.0 / (softness * delassus[i]);
    const double w1 = w[n + i], w2 = w[2 * n + i];
    const double slide = std::sqrt(w1 * w1 + w2 * w2);
    const Projection p = project(mu[i], centre[i] - k * (w[i] + mu[i] * slide),
                                 centre[n + i] - k * w1, centre[2 * n + i] - k * w2);
    f[i] = p.n;
    f[n + i] = p.t1;
    f[2 * n + i] = p.t2;
    const double per_slide = slide > 1e-300 ? mu[i] / slide : 0.0;
    const double s1 = per_slide * w1, s2 = per_slide * w2;  // d(mu |w_t|) / dw_t
    const double c = p.slip * k / (1.0 + mu[i] * mu[i]), cm = c * mu[i], radial = cm * mu[i];
    const double round = p.slip * k * p.round, stick = k * p.stick;
    const double d00 = stick + c, d01 = cm * p.h1, d02 = cm * p.h2;
    const double d12 = (radial - round) * p.h1 * p.h2;
    d[i] = d00;
    d[n + i] = d01 + d00 * s1;
    d[2 * n + i] = d02 + d00 * s2;
    d[3 * n + i] = d01;
    d[4 * n + i] = stick + radial * p.h1 * p.h1 + round * p.h2 * p.h2 + d01 * s1;
    d[5 * n + i] = d12 + d01 * s2;
    d[6 * n + i] = d02;
    d[7 * n + i] = d12 + d02 * s1;
    d[8 * n + i] = stick + radial * p.h2 * p.h2 + round * p.h1 * p.h1 + d02 * s2;
  }
}

void proximal_derivative(const ProximalArrays& x) {
  if (x.shift != nullptr)
    proximal_derivative_lagged(x);
  else
    proximal_derivative_exact(x);
}

ConeKernels kernels() {
  return {scale,
          scaling,
          right_side,
          direction,
          corrector,
          orthant_scaling,
          orthant_right_side,
          orthant_direction,
          orthant_corrector,
          proximal,
          proximal_derivative};
}

}  // namespace ourengine::cones::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ourengine {

namespace cones {
HWY_EXPORT(kernels);
ConeKernels best() { return HWY_DYNAMIC_DISPATCH(kernels)(); }
}  // namespace cones

const ConeKernels& cone_kernels() {
  static const ConeKernels chosen = cones::best();
  return chosen;
}

double ordered_dot(const double* x, const double* y, std::size_t n) {
  double lane[8] = {};
  for (std::size_t i = 0; i < n; i += 8) {
    for (std::size_t k = 0; k < 8; ++k) lane[k] += x[i + k] * y[i + k];
  }
  return ((lane[0] + lane[1]) + (lane[2] + lane[3])) + ((lane[4] + lane[5]) + (lane[6] + lane[7]));
}

double ordered_max(const double* x, std::size_t n) {
  double lane[8] = {};
  for (std::size_t k = 0; k < 8 && k < n; ++k) lane[k] = x[k];
  for (std::size_t i = 8; i < n; i += 8) {
    for (std::size_t k = 0; k < 8; ++k) lane[k] = x[i + k] > lane[k] ? x[i + k] : lane[k];
  }
  double worst = lane[0];
  for (std::size_t k = 1; k < 8; ++k) worst = std::max(worst, lane[k]);
  return worst;
}

}  // namespace ourengine
#endif
