// Linear and angular part of a SoftVector in double precision.
#pragma once

#include <Eigen/Core>

#include "ourengine/fast/soft_batch.hpp"

namespace ourengine {

inline Eigen::Vector3d linear_part(const SoftVector& v) { return {v[0], v[1], v[2]}; }
inline Eigen::Vector3d angular_part(const SoftVector& v) { return {v[4], v[5], v[6]}; }

}  // namespace ourengine
