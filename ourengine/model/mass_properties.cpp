#include "ourengine/model/mass_properties.hpp"

#include <numbers>

namespace ourengine {

BodyModel uniform_box(const Eigen::Vector3d& half_m, double density_kgpm3) {
  BodyModel model;
  model.geometry = BoxGeometry{half_m};
  model.mass_kg = density_kgpm3 * 8.0 * half_m.prod();
  const Eigen::Vector3d squares_m2 = half_m.cwiseAbs2();
  model.inertia_kgm2 =
      model.mass_kg / 3.0 * (Eigen::Vector3d::Constant(squares_m2.sum()) - squares_m2);
  return model;
}

BodyModel uniform_sphere(double radius_m, double density_kgpm3) {
  BodyModel model;
  model.geometry = SphereGeometry{radius_m};
  model.mass_kg = density_kgpm3 * 4.0 / 3.0 * std::numbers::pi * radius_m * radius_m * radius_m;
  model.inertia_kgm2.setConstant(0.4 * model.mass_kg * radius_m * radius_m);
  return model;
}

BodyModel fixed_plane() {
  BodyModel model;
  model.geometry = PlaneGeometry{};
  model.fixed = true;
  return model;
}

BodyModel fixed(BodyModel model) {
  model.fixed = true;
  return model;
}

}  // namespace ourengine
