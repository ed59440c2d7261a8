// Parts of a SoftVector, and one lane of vectors, in double precision.
#pragma once

#include <Eigen/Core>

#include "ourengine/fast/soft_batch.hpp"

namespace ourengine {

inline Eigen::Vector3d linear_part(const SoftVector& v) { return {v[0], v[1], v[2]}; }
inline Eigen::Vector3d lane_of(const Lane3& lanes, std::size_t i) {
  return {lanes[0][i], lanes[1][i], lanes[2][i]};
}
inline Eigen::Vector3d angular_part(const SoftVector& v) { return {v[4], v[5], v[6]}; }

}  // namespace ourengine
