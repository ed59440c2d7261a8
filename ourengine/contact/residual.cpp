#include "ourengine/contact/residual.hpp"

#include <cmath>
#include <limits>

#include "ourengine/contact/cone.hpp"

namespace ourengine {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

double contact_residual(const ContactSystem& system, const AlignedDoubles& f,
                        const AlignedDoubles& w, ContactLaw law) {
  const std::size_t n = system.stride();
  const std::size_t count = at(system.contacts());
  double worst = 0.0;
  bool finite = true;
  if (system.components() == 1) {
    for (std::size_t i = 0; i < count; ++i) {
      const double loaded = system.delassus()[i] * f[i];
      finite = finite && std::abs(loaded) < kInfinity && std::abs(w[i]) < kInfinity;
      worst = std::max(worst, std::abs(std::min(loaded, w[i])));
    }
    return finite ? worst / system.scale_mps() : kInfinity;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double mu = system.friction()[i];
    const Eigen::Vector3d force =
        system.delassus()[i] * Eigen::Vector3d(f[i], f[n + i], f[2 * n + i]);
    Eigen::Vector3d slip(w[i], w[n + i], w[2 * n + i]);
    if (law == ContactLaw::kCoulomb)
      slip[0] += mu * std::sqrt(slip[1] * slip[1] + slip[2] * slip[2]);
    const Eigen::Vector3d gap = force - project_on_cone(mu, force - slip);
    for (int k = 0; k < 3; ++k) {
      const double size = std::abs(gap[k]);
      finite = finite && size < kInfinity;  // a comparison with NaN is false
      worst = std::max(worst, size);
    }
  }
  return finite ? worst / system.scale_mps() : kInfinity;
}

double contact_residual_of(const ContactSystem& system, const AlignedDoubles& f, ContactLaw law,
                           AlignedDoubles& v, AlignedDoubles& w) {
  system.velocity_of(f, v);
  w.resize(system.rows());
  simd_kernels().multiply_j(system.view(), v.data(), true, w.data());
  return contact_residual(system, f, w, law);
}

double contact_residual(const ContactProblem& problem, std::span<const Eigen::Vector3d> impulses_ns,
                        ContactLaw law) {
  if (impulses_ns.size() != problem.contacts.size()) return kInfinity;
  SymbolicCache cache;
  const ContactSystem system(problem, 3, cache);
  AlignedDoubles f, v, w;
  system.load_impulses(impulses_ns, f);
  return contact_residual_of(system, f, law, v, w);
}

}  // namespace ourengine
