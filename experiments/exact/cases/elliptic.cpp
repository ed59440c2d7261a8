#include "experiments/exact/cases/elliptic.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace brickbench::exact {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// Gauss-Legendre, five points on -1 .. 1 (Abramowitz & Stegun 25.4.30).
constexpr std::array<double, 5> k_nodes = {-0.90617984593866399, -0.53846931010568309, 0.0,
                                           0.53846931010568309, 0.90617984593866399};
constexpr std::array<double, 5> k_weights = {0.23692688505618909, 0.47862867049936647,
                                             0.56888888888888889, 0.47862867049936647,
                                             0.23692688505618909};
// Panels per period of the integrand: the five-point rule then errs below 1e-14 for m < 0.999.
constexpr int k_panels = 64;

}  // namespace

double complete_elliptic_k(double m) {
  double a = 1.0;
  double b = std::sqrt(1.0 - m);
  while (std::abs(a - b) > 1e-15 * a) {
    const double mean = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = mean;
  }
  return std::numbers::pi / (a + b);
}

JacobiValues jacobi(double u, double m) {
  // Whole periods are taken off first: the phase doubles at every level and would lose digits.
  const double period = 4.0 * complete_elliptic_k(m);
  u = std::remainder(u, period);
  constexpr int k_levels = 16;
  std::array<double, k_levels> a{};
  std::array<double, k_levels> c{};
  a[0] = 1.0;
  double b = std::sqrt(1.0 - m);
  c[0] = std::sqrt(m);
  int n = 0;
  while (n + 1 < k_levels && std::abs(c[static_cast<std::size_t>(n)]) > 1e-16) {
    const auto i = static_cast<std::size_t>(n);
    a[i + 1] = 0.5 * (a[i] + b);
    c[i + 1] = 0.5 * (a[i] - b);
    b = std::sqrt(a[i] * b);
    ++n;
  }
  double phi = std::ldexp(a[static_cast<std::size_t>(n)] * u, n);
  for (int i = n; i > 0; --i) {
    const auto j = static_cast<std::size_t>(i);
    phi = 0.5 * (phi + std::asin(c[j] / a[j] * std::sin(phi)));
  }
  JacobiValues values;
  values.sn = std::sin(phi);
  values.cn = std::cos(phi);
  values.dn = std::sqrt(1.0 - m * values.sn * values.sn);
  return values;
}

TorqueFree::TorqueFree(const Vector3d& inertia_kgm2, double w1_radps, double w3_radps)
    : inertia_(inertia_kgm2) {
  const double i1 = inertia_[0], i2 = inertia_[1], i3 = inertia_[2];
  const double twice_energy = i1 * w1_radps * w1_radps + i3 * w3_radps * w3_radps;
  const double momentum2 = i1 * i1 * w1_radps * w1_radps + i3 * i3 * w3_radps * w3_radps;
  momentum_ = std::sqrt(momentum2);
  const double over1 = momentum2 - twice_energy * i1;   // M^2 - 2 E I1
  const double under3 = twice_energy * i3 - momentum2;  // 2 E I3 - M^2
  about_third_ = momentum2 > twice_energy * i2;
  const double product = i1 * i2 * i3;
  if (about_third_) {
    rate_ = std::sqrt((i3 - i2) * over1 / product);
    m_ = (i2 - i1) * under3 / ((i3 - i2) * over1);
    amplitude_ = {w1_radps, std::sqrt(under3 / (i2 * (i3 - i2))), w3_radps};
  } else {
    rate_ = std::sqrt((i2 - i1) * under3 / product);
    m_ = (i3 - i2) * over1 / ((i2 - i1) * under3);
    amplitude_ = {w1_radps, std::sqrt(over1 / (i2 * (i2 - i1))), w3_radps};
  }
}

Vector3d TorqueFree::spin_radps(double time_s) const {
  const JacobiValues j = jacobi(rate_ * time_s, m_);
  const double first = about_third_ ? j.cn : j.dn;
  const double third = about_third_ ? j.dn : j.cn;
  return {amplitude_[0] * first, amplitude_[1] * j.sn, amplitude_[2] * third};
}

double TorqueFree::flip_s() const { return 2.0 * complete_elliptic_k(m_) / rate_; }

double TorqueFree::precession_rate_radps(double time_s) const {
  const Vector3d w = spin_radps(time_s);
  const double l1 = inertia_[0] * w[0], l2 = inertia_[1] * w[1];
  return momentum_ * (l1 * w[0] + l2 * w[1]) / (l1 * l1 + l2 * l2);
}

double TorqueFree::precession_rad(double time_s) const {
  // The rate depends on squares alone, so its period is flip_s(); whole periods are counted off.
  const double period = flip_s();
  const double whole = std::floor(time_s / period);
  const auto integral = [&](double end) {
    const double half = 0.5 * end / k_panels;
    double sum = 0.0;
    for (int panel = 0; panel < k_panels; ++panel) {
      for (std::size_t i = 0; i < k_nodes.size(); ++i) {
        sum += k_weights[i] * precession_rate_radps(half * (2.0 * panel + 1.0 + k_nodes[i]));
      }
    }
    return sum * half;
  };
  const double rest = integral(time_s - whole * period);
  return whole > 0.0 ? whole * integral(period) + rest : rest;
}

Quaterniond TorqueFree::relative_to_momentum(double time_s) const {
  const Vector3d momentum = inertia_.cwiseProduct(spin_radps(time_s));
  const double across = std::hypot(momentum[0], momentum[1]);
  const double theta = std::atan2(across, momentum[2]);
  const double psi = std::atan2(momentum[0], momentum[1]);
  using Eigen::AngleAxisd;
  return AngleAxisd(precession_rad(time_s), Vector3d::UnitZ()) *
         AngleAxisd(theta, Vector3d::UnitX()) * AngleAxisd(psi, Vector3d::UnitZ());
}

Quaterniond TorqueFree::orientation(double time_s) const {
  return (relative_to_momentum(0.0).conjugate() * relative_to_momentum(time_s)).normalized();
}

}  // namespace brickbench::exact
