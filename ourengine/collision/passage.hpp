// Overlaps of two bodies: where they are, and between the two ends of their ways, where nobody
// looked.
#pragma once

#include "ourengine/collision/collide.hpp"
#include "ourengine/model/body_model.hpp"

namespace ourengine {

// How deep the two overlap where they are, m >= 0.
double deepest_overlap_m(const BodyModel& a, const Motion& at_a, const BodyModel& b,
                         const Motion& at_b);

// A way of a body: straight, turning at a constant rate.
struct Way {
  Motion start;
  Motion end;
  Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();  // rotation vector, world frame
};

// How deep the bodies overlap on their ways, m, in the first place where that is a quarter of the
// thinner one more than at both ends; 0 if nowhere. Ways too short for one to pass the other are
// not looked at; those further than sixteen thicknesses are looked at in 64 places.
double passage_m(const BodyModel& a, const Way& way_a, const BodyModel& b, const Way& way_b);
bool passes(const BodyModel& a, const Way& way_a, const BodyModel& b, const Way& way_b);

}  // namespace ourengine
