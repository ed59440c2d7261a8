// Trajectory: the recorded motion of one cell, as an HDF5 file (docs/format.md describes it).
//
// Metadata and data carry checksums, and files of equal content have equal bytes. A build without
// HDF5 has the same functions; those that touch files fail and name the missing package.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adapters/seam/simulation.hpp"

namespace brickbench {

inline constexpr int k_trajectory_schema = 1;

enum class TrajectoryPrecision { f64, f32 };

enum class BodyRole { brick, projectile, fixed, other };

struct TrajectoryBody {
  std::string name;
  Shape shape = PlaneShape{};
  BodyRole role = BodyRole::other;
  double mass_kg = 0.0;  // 0: fixed

  bool operator==(const TrajectoryBody& other) const;
};

// What stands in the file besides the motion.
struct TrajectoryHeader {
  std::string cell;  // as in the rows, like the next seven
  std::string experiment;
  std::string scenario;
  std::string axes;
  std::string engine;
  std::string variant;
  std::string engine_version;
  std::string revision;
  double step_s = 0.0;
  double duration_s = 0.0;
  std::uint64_t seed = 0;
  std::uint64_t every = 1;  // steps from one frame to the next; the last step is there in any case
  TrajectoryPrecision precision = TrajectoryPrecision::f64;
  bool contacts = false;  // whether contact points are recorded
  std::vector<TrajectoryBody> bodies;

  bool operator==(const TrajectoryHeader&) const = default;
};

// How the run ended: "ok", or the outcome and reason of the rows; then the frames end before it.
struct TrajectoryEnd {
  std::string outcome = "ok";
  std::string reason;

  bool operator==(const TrajectoryEnd&) const = default;
};

// Whether this build can write and read trajectories.
bool has_trajectories();
// "this build has no HDF5 ..." with the name of the package; for messages.
std::string_view no_trajectories_reason();

// <folder>/trajectories/<cell>.h5
std::filesystem::path trajectory_path(const std::filesystem::path& folder, std::string_view cell);

// Writes frame by frame; memory does not grow with their number. The file appears under its name
// whole, at commit(), and never in place of another; without commit() nothing is left behind.
class TrajectoryWriter {
 public:
  // Makes the parent folder where it is missing. Fault::invalid if `file` exists, Fault::crashed if
  // the disk refuses, Fault::unsupported without HDF5.
  static Expected<TrajectoryWriter> create(const std::filesystem::path& file,
                                           const TrajectoryHeader& header);
  TrajectoryWriter(TrajectoryWriter&&) noexcept;
  TrajectoryWriter& operator=(TrajectoryWriter&&) = delete;
  ~TrajectoryWriter();

  // `states`: (bodies), order of the header. `contacts` is used if the header wants contacts;
  // nullptr: the engine tells none of this frame. After a failure only destruction is allowed.
  Expected<void> append(std::uint64_t step, double time_s, std::span<const State> states,
                        const std::vector<Contact>* contacts);
  Expected<void> commit(const TrajectoryEnd& end = {});

 private:
  struct Impl;
  explicit TrajectoryWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// One frame as it was recorded; numbers of f32 files are those floats.
struct TrajectoryFrame {
  std::uint64_t step = 0;
  double time_s = 0.0;
  std::vector<State> states;      // (bodies)
  std::vector<Contact> contacts;  // empty unless recorded
};

// An open file. All failures are Fault::invalid and name the file and the reason.
class Trajectory {
 public:
  // Checks the form: that it is a trajectory of this schema, that sizes fit each other.
  static Expected<Trajectory> open(const std::filesystem::path& file);
  Trajectory(Trajectory&&) noexcept;
  Trajectory& operator=(Trajectory&&) noexcept;
  ~Trajectory();

  const TrajectoryHeader& header() const;
  const TrajectoryEnd& end() const;
  // (frames), ascending.
  const std::vector<double>& times_s() const;
  const std::vector<std::uint64_t>& steps() const;

  // `frame` < times_s().size(). Fails where the stored bytes do not match their checksum.
  Expected<TrajectoryFrame> read(std::size_t frame) const;

 private:
  struct Impl;
  explicit Trajectory(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace brickbench
