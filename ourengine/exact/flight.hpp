// What free motion does within a step: when contacts close, and which islands simply fall.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "ourengine/integration/rotation.hpp"
#include "ourengine/model/body_model.hpp"

namespace ourengine {

// The body after time_s of free flight under constant gravity and load: the exact parabola, the
// attitude by the scheme. A fixed body stays.
Motion flown(const BodyModel& body, const Motion& motion, const Load& load,
             const Eigen::Vector3d& gravity_mps2, RotationScheme scheme, double time_s);

// When and how fast a gap closes.
struct Touch {
  double time_s = std::numeric_limits<double>::infinity();  // infinite: it does not
  double speed_mps = 0.0;                                   // of approach then, >= 0
};

// The first time in 0 .. span_s at which gap_m + velocity_mps t + acceleration_mps2 t^2 / 2 falls
// to zero or below. An overlap that does not grow is a gap of zero.
Touch first_touch(double gap_m, double velocity_mps, double acceleration_mps2, double span_s);

}  // namespace ourengine
