// The table `trajectory` of a plan: what it selects, what it refuses, and what the cells then
// record.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "experiments/run/run_plan.hpp"
#include "tests/unit/run/fakes.hpp"

namespace brickbench::testing {
namespace {

namespace fs = std::filesystem;

const std::string k_plan = R"(title = "t"
[[experiment]]
scenario = "fall"
engines = ["good/*", "nan", "refuser"]
step_s = [0.01, 0.005]
parameters = { balls = [1, 3] }
[[experiment]]
name = "other"
scenario = "fall"
engines = "good"
step_s = 0.01
[trajectory]
)";

Checked<std::vector<Cell>> recorded_cells(const std::string& table) {
  const Catalogues catalogues = fake_catalogues();
  const auto plan = parse_plan(k_plan + table, "p.toml", catalogues);
  if (!plan) return tl::unexpected(plan.error());
  return expand(*plan, catalogues);
}

std::size_t recorded(const std::string& table) {
  const auto cells = recorded_cells(table);
  EXPECT_TRUE(cells.has_value()) << cells.error().text();
  if (!cells) return 0;
  return static_cast<std::size_t>(
      std::ranges::count_if(*cells, [](const Cell& cell) { return cell.recording.has_value(); }));
}

std::string refusal(const std::string& table) {
  const auto cells = recorded_cells(table);
  return cells ? "" : cells.error().text();
}

TEST(TrajectoryChoice, SelectsCells) {
  EXPECT_EQ(recorded(""), 17U);
  EXPECT_EQ(recorded("engines = \"good/fancy\""), 4U);
  EXPECT_EQ(recorded("engines = [\"good\", \"nan\"]"), 9U);
  EXPECT_EQ(recorded("cells = \"balls == 3 and step_s < 0.01\""), 4U);
  EXPECT_EQ(recorded("cells = \"experiment == other\""), 1U);
  EXPECT_EQ(recorded("cells = \"balls == 3\"\nengines = \"refuser\""), 2U);
}

TEST(TrajectoryChoice, TurnsSecondsIntoStepsOfEachCell) {
  const auto cells = recorded_cells("every_s = 0.02\nprecision = \"f32\"\ncontacts = true");
  ASSERT_TRUE(cells.has_value()) << cells.error().text();
  for (const Cell& cell : *cells) {
    ASSERT_TRUE(cell.recording.has_value());
    EXPECT_EQ(cell.recording->every, cell.step_s == 0.01 ? 2U : 4U);
    EXPECT_EQ(cell.recording->precision, TrajectoryPrecision::f32);
    EXPECT_TRUE(cell.recording->contacts);
  }
}

TEST(TrajectoryChoice, NamesWhatIsWrongAndWhere) {
  const auto expect = [](const std::string& table, const std::string& part) {
    const std::string text = refusal(table);
    EXPECT_TRUE(text.starts_with("p.toml:13:")) << text;
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  expect("evry = 2", "trajectory has no key 'evry'; did you mean 'every'?");
  expect("every = 0", "every = 0 must be at least 1");
  expect("every = 1.5", "every must be a whole number");
  expect("every_s = 0.015", "every_s = 0.015 is not a whole number of steps of 0.01 s");
  expect("every_s = 0.001", "not a whole number of steps");
  expect("precision = \"f16\"", "no precision 'f16'; did you mean");
  expect("engines = \"god\"", "did you mean 'good'?");
  expect("cells = \"bals == 1\"", "no quantity 'bals'; did you mean 'balls'?");
  expect("contacts = 1", "contacts must be true or false");
  EXPECT_NE(refusal("every = 2\nevery_s = 0.02").find("p.toml:14:"), std::string::npos);
}

TEST(TrajectoryChoice, DoesNotChangeTheIdentityOfACell) {
  const auto with = recorded_cells("every = 3");
  ASSERT_TRUE(with.has_value());
  Cell without = with->front();
  without.recording.reset();
  EXPECT_EQ(cell_key(with->front(), "1", "r"), cell_key(without, "1", "r"));
}

class Recorded : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_trajectories()) GTEST_SKIP() << no_trajectories_reason();
    folder_ = fs::temp_directory_path() / ("brickbench_recorded." + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override {
    if (!folder_.empty()) fs::remove_all(folder_);
  }
  RunResult run(const std::string& table) const {
    return run_cells(*recorded_cells(table), fake_catalogues(), {"rev", "machine"}, {}, folder_);
  }
  fs::path folder_;
};

TEST_F(Recorded, EveryKthStepAndTheLastOfEachCell) {
  const RunResult result = run("every = 4");
  std::size_t frames = 0;
  for (const CellOutcome& cell : result.cells) {
    EXPECT_EQ(cell.unrecorded, "");
    const fs::path file = trajectory_path(folder_, cell.id);
    if (cell.outcome == "refused") {
      EXPECT_FALSE(fs::exists(file)) << "a run that never began has no motion";
      continue;
    }
    const auto trajectory = Trajectory::open(file);
    ASSERT_TRUE(trajectory.has_value()) << trajectory.error().reason;
    EXPECT_EQ(trajectory->header().cell, cell.id);
    EXPECT_EQ(trajectory->end().outcome, cell.outcome);
    const auto& steps = trajectory->steps();
    // 10 or 20 steps; the one that diverges does so in step 7.
    const std::vector<std::uint64_t> expected =
        cell.outcome == "diverged" ? std::vector<std::uint64_t>{0, 4}
        : cell.cell.step_s == 0.01 ? std::vector<std::uint64_t>{0, 4, 8, 10}
                                   : std::vector<std::uint64_t>{0, 4, 8, 12, 16, 20};
    EXPECT_EQ(steps, expected) << cell.cell.engine.label();
    const auto last = trajectory->read(steps.size() - 1);
    ASSERT_TRUE(last.has_value()) << last.error().reason;
    if (cell.outcome == "ok") {
      // Symplectic Euler: z = -g h^2 n (n + 1) / 2.
      const double n = static_cast<double>(steps.back());
      const double h_s = cell.cell.step_s;
      EXPECT_NEAR(last->states[0].position_m.z(), -9.81 * h_s * h_s * n * (n + 1) / 2, 1e-15);
    }
    frames += steps.size();
  }
  EXPECT_GT(frames, 0U);
}

TEST_F(Recorded, ChangesNoRow) {
  const RunResult with = run("");
  const RunResult without = run_cells(*recorded_cells(""), fake_catalogues(), {"rev", "machine"});
  EXPECT_EQ(with.rows, without.rows);
}

TEST_F(Recorded, SaysWhatCouldNotBeRecorded) {
  (void)run("engines = \"good\"");
  const RunResult again = run("engines = \"good\"");
  for (const CellOutcome& cell : again.cells) {
    const bool chosen = cell.cell.engine.label() == "good/plain";
    EXPECT_EQ(!cell.unrecorded.empty(), chosen) << cell.unrecorded;
    if (chosen) {
      EXPECT_NE(cell.unrecorded.find("exists already"), std::string::npos);
      EXPECT_EQ(cell.outcome, "ok") << "the cell itself is fine";
    }
  }
}

}  // namespace
}  // namespace brickbench::testing
