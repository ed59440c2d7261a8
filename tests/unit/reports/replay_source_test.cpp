// Recorded trajectories become replays: which cells, which frames, what is refused.
#include "reports/src/replay_source.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "experiments/record/trajectory.hpp"

namespace brickbench::testing {
namespace {

namespace fs = std::filesystem;

Row row_of(const std::string& engine, std::uint64_t seed) {
  Row row;
  row.experiment = "wall";
  row.cell = engine + std::to_string(seed);
  row.engine = engine;
  row.variant = "v";
  row.step_s = 0.001;
  row.duration_s = 1.0;
  row.seed = seed;
  return row;
}

class ReplaySource : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_trajectories()) GTEST_SKIP() << no_trajectories_reason();
    folder_ = fs::temp_directory_path() / ("brickbench_replays." + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override {
    if (!folder_.empty()) fs::remove_all(folder_);
  }

  // A ball that falls from the height of its seed; one contact point in every odd frame.
  void record(const Row& row, const std::string& file_of, std::size_t frames,
              const TrajectoryEnd& end = {}) const {
    TrajectoryHeader header;
    header.cell = row.cell;
    header.contacts = true;
    header.bodies = {{"ground", PlaneShape{}, BodyRole::fixed, 0.0},
                     {"ball", SphereShape{0.25}, BodyRole::projectile, 1.0},
                     {"brick", BoxShape{{0.1, 0.2, 0.3}}, BodyRole::brick, 1.0}};
    auto writer = TrajectoryWriter::create(trajectory_path(folder_, file_of), header);
    ASSERT_TRUE(writer.has_value()) << writer.error().reason;
    for (std::size_t f = 0; f < frames; ++f) {
      std::vector<State> states(3);
      states[1].position_m.z() = static_cast<double>(row.seed) - static_cast<double>(f);
      states[2].orientation = Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5);
      std::vector<Contact> contacts(f % 2);
      if (f % 2 == 1) contacts[0].position_m = {1.0, 2.0, static_cast<double>(f)};
      ASSERT_TRUE(writer->append(f, 0.1 * static_cast<double>(f), states, &contacts).has_value());
    }
    ASSERT_TRUE(writer->commit(end).has_value());
  }
  fs::path folder_;
};

TEST_F(ReplaySource, ShowsTheLowestSeedOfEachContender) {
  const std::vector<Row> rows = {row_of("a", 5), row_of("a", 2), row_of("b", 3), row_of("c", 1),
                                 row_of("a", 5)};
  for (std::size_t i = 0; i < 3; ++i) record(rows[i], rows[i].cell, 4, {});
  const auto recorded = read_replays(folder_, rows);
  ASSERT_TRUE(recorded.has_value()) << recorded.error().reason;
  EXPECT_EQ(recorded->cells, 3U);
  ASSERT_EQ(recorded->replays.size(), 2U);
  const Replay& first = recorded->replays[0];
  EXPECT_EQ(first.cell, "a2");
  EXPECT_EQ(recorded->replays[1].cell, "b3");
  EXPECT_EQ(first.times_s.size(), 4U);
  EXPECT_EQ(first.positions_m[3 * (2 * 3 + 1) + 2], 0.0);  // frame 2, ball, z
  EXPECT_EQ(first.orientations[4 * (1 * 3 + 2) + 3], 0.5);
  EXPECT_EQ(first.contact_offsets, (std::vector<std::size_t>{0, 0, 1, 1, 2}));
  EXPECT_EQ(first.contact_points_m, (std::vector<double>{1, 2, 1, 1, 2, 3}));
  EXPECT_EQ(first.bodies[0].shape, ReplayShape::plane);
  EXPECT_EQ(first.bodies[1].role, ReplayRole::projectile);
  EXPECT_EQ(first.bodies[1].half_extents_m, (std::array<double, 3>{0.25, 0.25, 0.25}));
}

TEST_F(ReplaySource, ThinsLongRecordsAndSaysHowLongTheyWere) {
  const Row row = row_of("a", 1);
  record(row, row.cell, 2 * k_most_frames + 1, {"diverged", "it flew away"});
  const auto recorded = read_replays(folder_, std::vector<Row>{row});
  ASSERT_TRUE(recorded.has_value()) << recorded.error().reason;
  const Replay& replay = recorded->replays.at(0);
  EXPECT_EQ(replay.times_s.size(), k_most_frames);
  EXPECT_EQ(replay.recorded_frames, 2 * k_most_frames + 1);
  EXPECT_EQ(replay.times_s.back(), 0.1 * static_cast<double>(2 * k_most_frames));
  EXPECT_EQ(replay.note, "diverged: it flew away");
  const Replay fewer = thinned(replay, 5);
  EXPECT_EQ(fewer.times_s.size(), 5U);
  EXPECT_EQ(fewer.recorded_frames, replay.recorded_frames);
  EXPECT_EQ(fewer.contact_offsets.size(), 6U);
  EXPECT_TRUE(check(fewer).has_value());
}

TEST_F(ReplaySource, SaysSinceWhenARunIsNotToBeTrusted) {
  Row flagged = row_of("a", 1);
  flagged.validity =
      "unsolved in 3 of 9 steps from step 250; clamped in 1 of 9 steps from step 240";
  const Row sound = row_of("b", 1);
  for (const Row& row : {flagged, sound}) record(row, row.cell, 3);
  const auto recorded = read_replays(folder_, std::vector<Row>{flagged, sound});
  ASSERT_TRUE(recorded.has_value()) << recorded.error().reason;
  EXPECT_EQ(recorded->replays[0].note, "! " + flagged.validity);
  EXPECT_DOUBLE_EQ(recorded->replays[0].flagged_from_s.value_or(-1.0), 0.24);
  EXPECT_EQ(recorded->replays[1].note, "");
  EXPECT_FALSE(recorded->replays[1].flagged_from_s.has_value());
}

TEST_F(ReplaySource, NamesFilesThatAreDamagedOrOfAnotherCell) {
  const Row a = row_of("a", 1);
  const Row b = row_of("b", 1);
  record(a, b.cell, 3);
  const auto swapped = read_replays(folder_, std::vector<Row>{b});
  ASSERT_FALSE(swapped.has_value());
  EXPECT_NE(swapped.error().reason.find("b1.h5: the trajectory of another cell, a1"),
            std::string::npos)
      << swapped.error().reason;
  fs::resize_file(trajectory_path(folder_, b.cell), 3000);
  const auto cut = read_replays(folder_, std::vector<Row>{b});
  ASSERT_FALSE(cut.has_value());
  EXPECT_NE(cut.error().reason.find("b1.h5: not a readable trajectory"), std::string::npos);
}

TEST_F(ReplaySource, HoldsAPageToItsSize) {
  EXPECT_EQ(frames_within_page(404, 240), 240U);
  EXPECT_EQ(frames_within_page(4 * 2001, 240), k_page_body_frames / 8004);
  EXPECT_EQ(frames_within_page(1'000'000, 240), k_fewest_frames);
  EXPECT_EQ(frames_within_page(0, 7), 7U);
}

}  // namespace
}  // namespace brickbench::testing
