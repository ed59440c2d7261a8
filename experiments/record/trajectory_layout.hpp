// Names in the file of a trajectory, for the writer and the reader alike.
#pragma once

#include <array>

#include "experiments/record/hdf5.hpp"

namespace brickbench::trajectory_layout {

inline constexpr const char* k_format = "brickbench trajectory";

// A data set of numbers (frames, bodies, width) or (points, width).
struct Quantity {
  const char* name;
  std::size_t width;  // 0: one number
  const char* unit;
  const char* meaning;
};

inline constexpr std::array<Quantity, 4> k_motion = {{
    {"position", 3, "m", "x y z of the centre of mass, world frame"},
    {"quaternion", 4, "1", "w x y z, body to world"},
    {"linear_velocity", 3, "m/s", "of the centre of mass, world frame"},
    {"angular_velocity", 3, "rad/s", "world frame"},
}};

inline constexpr std::array<Quantity, 4> k_contacts = {{
    {"position", 3, "m", "x y z of the point, world frame"},
    {"normal", 3, "1", "from the first body towards the second, world frame"},
    {"gap", 0, "m", "negative: penetration, as the engine tells it"},
    {"impulse", 3, "N s", "on the second body during the last step, world frame"},
}};

inline constexpr std::array k_roles = {"brick", "projectile", "fixed", "other"};
inline constexpr std::array k_shapes = {"box", "sphere", "plane"};
inline constexpr std::array k_precisions = {"f64", "f32"};

}  // namespace brickbench::trajectory_layout
