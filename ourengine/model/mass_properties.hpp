// Bodies of uniform density, with the mass and the inertia that follow from their shape.
#pragma once

#include "ourengine/model/body_model.hpp"

namespace ourengine {

// A box with half edges half_m (m, > 0) along its body axes; I_xx = m (h_y^2 + h_z^2) / 3.
BodyModel uniform_box(const Eigen::Vector3d& half_m, double density_kgpm3);

// A ball; I = 2/5 m r^2 about every axis.
BodyModel uniform_sphere(double radius_m, double density_kgpm3);

// The half space z <= 0 of the body frame, which never moves.
BodyModel fixed_plane();

// The same body, never moving.
BodyModel fixed(BodyModel model);

}  // namespace ourengine
