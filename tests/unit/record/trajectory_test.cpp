// What is written is what is read: every bit in f64, the nearest float in f32.
#include <cstdlib>
#include <fstream>

#include "experiments/record/file.hpp"
#include "tests/support/tolerance.hpp"
#include "tests/unit/record/sample.hpp"

namespace brickbench::testing {
namespace {

constexpr std::size_t k_frames = 600;  // more than two chunks

// All numbers of a frame in one order.
std::vector<double> numbers(const TrajectoryFrame& frame) {
  std::vector<double> out = {frame.time_s, static_cast<double>(frame.step)};
  const auto add = [&](const Eigen::Vector3d& v) { out.insert(out.end(), v.data(), v.data() + 3); };
  for (const State& s : frame.states) {
    add(s.position_m);
    out.insert(out.end(),
               {s.orientation.w(), s.orientation.x(), s.orientation.y(), s.orientation.z()});
    add(s.velocity_mps);
    add(s.angular_velocity_radps);
  }
  for (const Contact& c : frame.contacts) {
    out.push_back(static_cast<double>(c.body_a));
    out.push_back(static_cast<double>(c.body_b));
    add(c.position_m);
    add(c.normal);
    out.push_back(c.gap_m);
    add(c.impulse_ns);
  }
  return out;
}

TEST_F(Trajectories, ComeBackBitByBit) {
  TrajectoryHeader header = sample_header();
  header.contacts = true;
  header.every = 3;
  const fs::path file = trajectory_path(folder_, header.cell);
  const TrajectoryEnd end = {"diverged", "body 'brick' is not finite"};
  const auto written = write_sample(file, header, k_frames, end);
  ASSERT_TRUE(written.has_value()) << written.error().reason;
  const auto back = Trajectory::open(file);
  ASSERT_TRUE(back.has_value()) << back.error().reason;
  EXPECT_EQ(back->header(), header);
  EXPECT_EQ(back->end(), end);
  ASSERT_EQ(back->times_s().size(), k_frames);
  std::size_t different = 0;
  for (std::size_t f = 0; f < k_frames; ++f) {
    const auto frame = back->read(f);
    ASSERT_TRUE(frame.has_value()) << frame.error().reason;
    const TrajectoryFrame original = sample_frame(header, f);
    if (numbers(*frame) != numbers(original)) ++different;
    if (hash_states(frame->states) != hash_states(original.states)) ++different;
  }
  EXPECT_EQ(different, 0U);
}

// Half the distance of neighbouring floats, relative to the number.
const Tolerance k_float_rounding = {"float rounding", 6.0e-8, 5.96e-8,
                                    "2^-24 relative: rounding to the nearest of 24 bits"};

TEST_F(Trajectories, KeepTheNearestFloatWhereAsked) {
  TrajectoryHeader header = sample_header();
  header.precision = TrajectoryPrecision::f32;
  const fs::path file = folder_ / "f32.h5";
  ASSERT_TRUE(write_sample(file, header, k_frames).has_value());
  const auto back = Trajectory::open(file);
  ASSERT_TRUE(back.has_value()) << back.error().reason;
  Worst worst;
  std::size_t no_floats = 0;
  for (std::size_t f = 0; f < k_frames; ++f) {
    const auto read = numbers(*back->read(f));
    const auto original = numbers(sample_frame(header, f));
    ASSERT_EQ(read.size(), original.size());
    EXPECT_EQ(read[0], original[0]) << "times stay exact";
    for (std::size_t i = 2; i < read.size(); ++i) {
      if (read[i] != static_cast<double>(static_cast<float>(original[i]))) ++no_floats;
      if (original[i] != 0.0) worst.see(read[i] / original[i] - 1.0, std::to_string(i));
    }
  }
  EXPECT_EQ(no_floats, 0U);
  EXPECT_TRUE(worst.within(k_float_rounding));
}

TEST_F(Trajectories, HaveEqualBytesForEqualContent) {
  ASSERT_TRUE(write_sample(folder_ / "a.h5", sample_header(), 50).has_value());
  ::sleep(1);
  ASSERT_TRUE(write_sample(folder_ / "b.h5", sample_header(), 50).has_value());
  EXPECT_EQ(*read_file(folder_ / "a.h5"), *read_file(folder_ / "b.h5"));
}

TEST_F(Trajectories, AppearWholeAndReplaceNothing) {
  const fs::path file = folder_ / "a.h5";
  {
    auto writer = TrajectoryWriter::create(file, sample_header());
    ASSERT_TRUE(writer.has_value()) << writer.error().reason;
    const TrajectoryFrame frame = sample_frame(sample_header(), 0);
    ASSERT_TRUE(writer->append(0, 0.0, frame.states, nullptr).has_value());
    EXPECT_FALSE(fs::exists(file)) << "a half file under the final name";
  }
  EXPECT_EQ(files(), 0U) << "an abandoned writer leaves something";
  ASSERT_TRUE(write_sample(file, sample_header(), 2).has_value());
  const std::string before = *read_file(file);
  const auto again = TrajectoryWriter::create(file, sample_header());
  ASSERT_FALSE(again.has_value());
  EXPECT_NE(again.error().reason.find("exists already"), std::string::npos);
  auto late = TrajectoryWriter::create(folder_ / "b.h5", sample_header());
  ASSERT_TRUE(late.has_value());
  std::ofstream(folder_ / "b.h5") << "somebody else's";
  EXPECT_FALSE(late->commit().has_value());
  EXPECT_EQ(*read_file(folder_ / "b.h5"), "somebody else's");
  EXPECT_EQ(*read_file(file), before);
  EXPECT_EQ(files(), 2U);
}

TEST_F(Trajectories, RefuseAWrongNumberOfBodies) {
  auto writer = TrajectoryWriter::create(folder_ / "a.h5", sample_header());
  ASSERT_TRUE(writer.has_value());
  const std::vector<State> states(2);
  EXPECT_FALSE(writer->append(0, 0.0, states, nullptr).has_value());
  EXPECT_FALSE(writer->commit().has_value()) << "a writer that failed must not commit";
}

// The script sees the motion as h5py users see it, and prints what it found.
constexpr const char* k_script = R"(
import sys, h5py
f = h5py.File(sys.argv[1], 'r')
assert f.attrs['format'].decode() if isinstance(f.attrs['format'], bytes) else f.attrs['format']
assert f['position'].shape == (5, 4, 3), f['position'].shape
assert f['position'].attrs['unit'] in ('m', b'm')
assert f['quaternion'].shape == (5, 4, 4)
assert f['contacts/offset'][-1] == f['contacts/position'].shape[0]
assert abs(f['time'][1] - f.attrs['step_s']) == 0.0
assert list(f['bodies/name'].asstr()) == ['ground', 'brick', 'ball', '']
)";

TEST_F(Trajectories, AreReadableByH5py) {
  if (std::system("/usr/bin/python3 -c 'import h5py' 2>/dev/null") != 0) {
    GTEST_SKIP() << "h5py is not installed (in Debian the package python3-h5py)";
  }
  TrajectoryHeader header = sample_header();
  header.contacts = true;
  ASSERT_TRUE(write_sample(folder_ / "a.h5", header, 5).has_value());
  std::ofstream(folder_ / "check.py") << k_script;
  const std::string command = "/usr/bin/python3 '" + (folder_ / "check.py").string() + "' '" +
                              (folder_ / "a.h5").string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

}  // namespace
}  // namespace brickbench::testing
