// Trajectories of a build without HDF5: every file is refused with the reason.
#include "experiments/record/trajectory.hpp"

namespace brickbench {
namespace {

tl::unexpected<Failure> refused() {
  return fail(Fault::unsupported, std::string(no_trajectories_reason()));
}

}  // namespace

struct TrajectoryWriter::Impl {};
struct Trajectory::Impl {
  TrajectoryHeader header;
  TrajectoryEnd end;
  std::vector<double> times_s;
  std::vector<std::uint64_t> steps;
};

bool has_trajectories() { return false; }

TrajectoryWriter::TrajectoryWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
TrajectoryWriter::TrajectoryWriter(TrajectoryWriter&&) noexcept = default;
TrajectoryWriter::~TrajectoryWriter() = default;
Expected<TrajectoryWriter> TrajectoryWriter::create(const std::filesystem::path&,
                                                    const TrajectoryHeader&) {
  return refused();
}
Expected<void> TrajectoryWriter::append(std::uint64_t, double, std::span<const State>,
                                        const std::vector<Contact>*) {
  return refused();
}
Expected<void> TrajectoryWriter::commit(const TrajectoryEnd&) { return refused(); }

Trajectory::Trajectory(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Trajectory::Trajectory(Trajectory&&) noexcept = default;
Trajectory& Trajectory::operator=(Trajectory&&) noexcept = default;
Trajectory::~Trajectory() = default;
Expected<Trajectory> Trajectory::open(const std::filesystem::path& file) {
  return fail(Fault::unsupported, file.string() + ": " + std::string(no_trajectories_reason()));
}
const TrajectoryHeader& Trajectory::header() const { return impl_->header; }
const TrajectoryEnd& Trajectory::end() const { return impl_->end; }
const std::vector<double>& Trajectory::times_s() const { return impl_->times_s; }
const std::vector<std::uint64_t>& Trajectory::steps() const { return impl_->steps; }
Expected<TrajectoryFrame> Trajectory::read(std::size_t) const { return refused(); }

}  // namespace brickbench
