// A small invented trajectory, and a folder for it.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "experiments/record/trajectory.hpp"

namespace brickbench::testing {

namespace fs = std::filesystem;

inline TrajectoryHeader sample_header() {
  TrajectoryHeader header;
  header.cell = "0123456789abcdef0123456789abcdef";
  header.experiment = "wall, \"quoted\"";
  header.scenario = "brick_wall";
  header.axes = "friction=0.5";
  header.engine = "good";
  header.variant = "plain";
  header.engine_version = "1.0";
  header.revision = "0000000";
  header.step_s = 1.0 / 3.0;
  header.duration_s = 40.0 / 3.0;
  header.seed = 7;
  header.bodies = {{"ground", PlaneShape{}, BodyRole::fixed, 0.0},
                   {"brick", BoxShape{{0.1, 0.05, 1.0 / 30.0}}, BodyRole::brick, 4.0},
                   {"ball", SphereShape{0.1}, BodyRole::projectile, 0.3},
                   {"", BoxShape{{1.0, 2.0, 3.0}}, BodyRole::other, 1e-300}};
  return header;
}

// Numbers that have all bits in use.
inline TrajectoryFrame sample_frame(const TrajectoryHeader& header, std::size_t frame) {
  TrajectoryFrame out;
  out.step = frame * header.every;
  out.time_s = static_cast<double>(out.step) * header.step_s;
  for (std::size_t b = 0; b < header.bodies.size(); ++b) {
    const double x = std::sin(static_cast<double>(100 * frame + b) + 0.1);
    State state;
    state.position_m = {x, -x * 1e-7, frame == 0 ? -0.0 : x * 1e7};
    state.orientation = Eigen::Quaterniond(x, std::cos(x), 1.0 / 3.0, -x / 3.0);
    state.velocity_mps = {1.0 / x, 1e-12 * x, -x};
    state.angular_velocity_radps = {x * x, 3.0 * x, -7.0};
    out.states.push_back(state);
  }
  for (std::size_t c = 0; header.contacts && c < frame % 3; ++c) {
    const double x = std::cos(static_cast<double>(10 * frame + c));
    out.contacts.push_back(
        {c, c + 1, {x, 2.0 * x, 1.0 / 3.0}, {0.0, x, 1.0}, -x * 1e-3, {x, 0.0, 1.0 / x}});
  }
  return out;
}

inline Expected<void> write_sample(const fs::path& file, const TrajectoryHeader& header,
                                   std::size_t frames, const TrajectoryEnd& end = {}) {
  auto writer = TrajectoryWriter::create(file, header);
  if (!writer) return tl::unexpected(writer.error());
  for (std::size_t f = 0; f < frames; ++f) {
    const TrajectoryFrame frame = sample_frame(header, f);
    if (auto ok = writer->append(frame.step, frame.time_s, frame.states, &frame.contacts); !ok) {
      return ok;
    }
  }
  return writer->commit(end);
}

class Trajectories : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_trajectories()) GTEST_SKIP() << no_trajectories_reason();
    folder_ = fs::temp_directory_path() / ("brickbench_trajectory." + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override {
    if (!folder_.empty()) fs::remove_all(folder_);
  }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  fs::path folder_;
};

}  // namespace brickbench::testing
