#include "ourengine/exact/flight.hpp"

#include <algorithm>
#include <cmath>

namespace ourengine {

Motion flown(const BodyModel& body, const Motion& motion, const Load& load,
             const Eigen::Vector3d& gravity_mps2, RotationScheme scheme, double time_s) {
  if (body.fixed) return motion;
  const Eigen::Vector3d acceleration_mps2 = gravity_mps2 + load.force_n / body.mass_kg;
  Motion end = motion;
  end.position_m += time_s * (motion.velocity_mps + 0.5 * time_s * acceleration_mps2);
  end.velocity_mps += time_s * acceleration_mps2;
  end.angular_momentum_kgm2ps += time_s * load.torque_nm;
  end.attitude =
      rotate(scheme, motion.attitude, body.inertia_kgm2, end.angular_momentum_kgm2ps, time_s);
  return end;
}

Touch first_touch(double gap_m, double velocity_mps, double acceleration_mps2, double span_s) {
  if (gap_m <= 0.0 && velocity_mps <= 0.0) return {0.0, -velocity_mps};
  const double from_m = std::max(0.0, gap_m);
  const double discriminant = velocity_mps * velocity_mps - 2.0 * acceleration_mps2 * from_m;
  if (!(discriminant >= 0.0)) return {};
  const double root_mps = std::sqrt(discriminant);
  // From above a gap closes at the root whose speed is -root_mps. Of the two forms of its time the
  // one that subtracts nothing.
  const double time_s = velocity_mps < 0.0 ? 2.0 * from_m / (root_mps - velocity_mps)
                                           : -(velocity_mps + root_mps) / acceleration_mps2;
  if (!(time_s >= 0.0 && time_s <= span_s)) return {};
  return {time_s, root_mps};
}

}  // namespace ourengine
