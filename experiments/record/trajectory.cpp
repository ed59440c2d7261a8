#include "experiments/record/trajectory.hpp"

#include "adapters/seam/shape.hpp"

namespace brickbench {

bool TrajectoryBody::operator==(const TrajectoryBody& other) const {
  return name == other.name && size_difference_m(shape, other.shape) == 0.0 && role == other.role &&
         mass_kg == other.mass_kg;
}

std::string_view no_trajectories_reason() {
  return "this build has no HDF5: install the Debian package libhdf5-dev and build again";
}

std::filesystem::path trajectory_path(const std::filesystem::path& folder, std::string_view cell) {
  return folder / "trajectories" / (std::string(cell) + ".h5");
}

}  // namespace brickbench
