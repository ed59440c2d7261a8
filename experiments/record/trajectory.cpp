#include "experiments/record/trajectory.hpp"

namespace brickbench {
namespace {

std::array<double, 4> numbers_of(const Shape& shape) {
  if (const auto* box = std::get_if<BoxShape>(&shape)) {
    return {0.0, box->half_extents_m.x(), box->half_extents_m.y(), box->half_extents_m.z()};
  }
  if (const auto* sphere = std::get_if<SphereShape>(&shape)) {
    return {1.0, sphere->radius_m, sphere->radius_m, sphere->radius_m};
  }
  return {2.0, 0.0, 0.0, 0.0};
}

}  // namespace

bool TrajectoryBody::operator==(const TrajectoryBody& other) const {
  return name == other.name && numbers_of(shape) == numbers_of(other.shape) && role == other.role &&
         mass_kg == other.mass_kg;
}

std::string_view no_trajectories_reason() {
  return "this build has no HDF5: install the Debian package libhdf5-dev and build again";
}

std::filesystem::path trajectory_path(const std::filesystem::path& folder, std::string_view cell) {
  return folder / "trajectories" / (std::string(cell) + ".h5");
}

}  // namespace brickbench
