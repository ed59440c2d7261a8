// A sweep's folder: identities, checked files, shards, merging, and what is refused.
#include <algorithm>
#include <fstream>
#include <set>

#include "experiments/record/trajectory.hpp"
#include "experiments/sweep/claims.hpp"
#include "experiments/sweep/line_difference.hpp"
#include "tests/support/sweep_folder.hpp"

namespace brickbench::testing {
namespace {

namespace fs = std::filesystem;

const std::string k_mixed = fall_plan(
    R"(["good", "nan", "segfault", "refuser", "good/fancy"])",
    "parameters = { balls = [1, 2, 3], mass_kg = [1.0, 2.5] }\n"
    "except = [{ engine = \"good/fancy\", when = \"balls > 2\", why = \"not, today\" }]\n");

class SweepFolder : public TemporaryFolder {};

TEST(CellIdentity, FollowsEverythingThatDecidesAResult) {
  const auto ids = [](const std::string& text, const std::string& revision = "rev") {
    const SweepOfFakes fakes(text, revision);
    std::set<std::string> found;
    for (const auto& cell : planned_cells(fakes.cells, fakes.catalogues, revision)) {
      found.insert(cell.cell);
    }
    return found;
  };
  const auto plan = [](const std::string& rest) { return fall_plan(R"(["good"])", rest); };
  const std::vector<std::set<std::string>> variations = {
      ids(plan("")),
      ids(plan(""), "another"),
      ids(plan("duration_s = 0.2")),
      ids(plan("time_limit_s = 5")),
      ids(plan("name = \"n\"")),
      ids(plan("parameters = { mass_kg = 2.0 }")),
      ids(plan("metrics = [\"fall\"]\nseeds = [1]\nperturb = { position_m = 0.1 }")),
      ids(plan("seeds = [2]\nperturb = { position_m = 0.1 }")),
      ids(plan("seeds = [2]\nperturb = { position_m = 0.2 }")),
      ids(fall_plan(R"(["good/fancy"])")),
      ids(fall_plan(R"([{ engine = "good", knobs = { iterations = 3 } }])"))};
  std::set<std::string> all;
  for (const auto& variation : variations) all.insert(variation.begin(), variation.end());
  EXPECT_EQ(all.size(), variations.size());
  // A default that is written out and words that do not matter change nothing.
  EXPECT_EQ(ids(plan("parameters = { mass_kg = 1.0 }  # the default")), variations[0]);
  EXPECT_EQ(ids(k_mixed).size(), 30U);
}

TEST(ShardText, IsReadOrRefused) {
  const auto shard = parse_shard("2/5");
  ASSERT_TRUE(shard.has_value());
  EXPECT_EQ(shard->text(), "2/5");
  EXPECT_TRUE(shard->holds(7));
  EXPECT_FALSE(shard->holds(8));
  for (const char* text : {"", "1", "5/5", "1/0", "-1/2", "1/2/3", "a/b", "0/1000001"}) {
    EXPECT_FALSE(parse_shard(text).has_value()) << text;
  }
}

TEST(LineDifference, NamesWhatWentAndWhatCame) {
  EXPECT_EQ(line_difference("a\nb\nc\n", "a\nc\nd\n"), "- b\n+ d\n");
  EXPECT_EQ(line_difference("a\nb\n", "a\nb\n"), "");
  EXPECT_EQ(line_difference("", "a\n"), "+ a\n");
}

TEST(ResultFile, ComesBackAndAnyDamageIsSeen) {
  const CellFile file = {std::string(32, 'a'), "crashed", "two\nlines", "r1\nr2\n", "t\n", "s\n"};
  const std::string text = to_text(file);
  const auto back = parse_cell_file(text, file.id);
  ASSERT_TRUE(back.has_value()) << back.error().reason;
  EXPECT_EQ(to_text(*back), text);
  EXPECT_EQ(back->reason, file.reason);
  EXPECT_FALSE(parse_cell_file(text, std::string(32, 'b')).has_value());
  std::string taken_for_whole;
  for (std::size_t size = 0; size < text.size(); ++size) {
    if (parse_cell_file(text.substr(0, size), file.id)) taken_for_whole = text.substr(0, size);
  }
  for (std::size_t at = 0; at < text.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string changed = text;
      changed[at] = static_cast<char>(changed[at] ^ (1 << bit));
      if (parse_cell_file(changed, file.id)) taken_for_whole = changed;
    }
  }
  EXPECT_EQ(taken_for_whole, "");
  EXPECT_FALSE(parse_cell_file(text + "x", file.id).has_value());
}

TEST_F(SweepFolder, RowsAreTheSameBytesHoweverTheWorkIsShared) {
  const SweepOfFakes fakes(k_mixed);
  ASSERT_TRUE(fakes.run(folder_ / "whole").has_value());
  const std::string whole = merged(folder_ / "whole");
  for (std::size_t index : {2U, 0U, 1U}) {
    const auto summary =
        fakes.run(folder_ / "shards", {.jobs = 3, .shard = {.index = index, .count = 3}});
    ASSERT_TRUE(summary.has_value()) << summary.error().reason;
    EXPECT_EQ(summary->ran, 10U);
  }
  EXPECT_EQ(merged(folder_ / "shards"), whole);
  // The rows are those of the cells run in this process, one after the other.
  Catalogues harmless = fakes.catalogues;
  const auto good = run_cells({fakes.cells[0]}, harmless, k_origin);
  EXPECT_TRUE(whole.starts_with(to_csv<Row>(good.rows)));
  EXPECT_EQ(std::ranges::count(whole, '\n'), 1 + 30 * 4);
  const auto again = fakes.run(folder_ / "whole");
  EXPECT_EQ(again->found, 30U);
  EXPECT_EQ(again->ran, 0U);
  EXPECT_EQ(again->failed, 12U);
}

TEST_F(SweepFolder, DamagedFilesAreRunAgainAndMissingOnesNamed) {
  const SweepOfFakes fakes(k_mixed);
  const auto sweep = fakes.open(folder_ / "s");
  ASSERT_TRUE(fakes.run(folder_ / "s").has_value());
  const std::string whole = merged(folder_ / "s");
  const auto file = [&](std::size_t cell) {
    return result_path(folder_ / "s", sweep->cells[cell].cell);
  };
  fs::resize_file(file(3), fs::file_size(file(3)) - 1);
  fs::resize_file(file(8), 0);
  std::fstream(file(12), std::ios::in | std::ios::out).seekp(200).put('#');
  fs::remove(file(20));
  std::ofstream(file(21).string() + ".tmp.host.1.0") << "half";
  std::ofstream(folder_ / "s" / "sweep.json.tmp.host.1.0") << "half";
  fs::remove(folder_ / "s" / "plan.toml");
  const auto summary = merge(*sweep, {folder_ / "m.csv", folder_ / "m.timings.csv"});
  ASSERT_TRUE(summary.has_value());
  EXPECT_EQ(summary->missing, (std::vector<std::size_t>{3, 8, 12, 20}));
  EXPECT_EQ(summary->damage.size(), 3U);
  EXPECT_FALSE(fs::exists(folder_ / "m.csv")) << "an incomplete table was written";
  const auto again = fakes.run(folder_ / "s");
  ASSERT_TRUE(again.has_value());
  EXPECT_EQ(again->damaged, 3U);
  EXPECT_EQ(again->ran, 4U);
  EXPECT_EQ(merged(folder_ / "s"), whole);
  EXPECT_FALSE(fs::exists(folder_ / "s" / "sweep.json.tmp.host.1.0"));
  EXPECT_EQ(read_file(folder_ / "s" / "plan.toml").value_or(""), k_mixed);
}

TEST_F(SweepFolder, FailedCellsAreRunAgainOnlyOnRequest) {
  const SweepOfFakes fakes(k_mixed);
  ASSERT_TRUE(fakes.run(folder_ / "s").has_value());
  const std::string whole = merged(folder_ / "s");
  EXPECT_EQ(fakes.run(folder_ / "s")->ran, 0U);
  const auto retried = fakes.run(folder_ / "s", {.retry_failed = true});
  EXPECT_EQ(retried->ran, 12U);
  EXPECT_EQ(merged(folder_ / "s"), whole);
}

TEST_F(SweepFolder, AnotherPlanOrProgramIsRefusedWithTheDifference) {
  const std::string plan = fall_plan(R"(["good"])", "duration_s = 0.1\n");
  ASSERT_TRUE(SweepOfFakes(plan).run(folder_ / "s").has_value());
  EXPECT_TRUE(SweepOfFakes(plan + "# a comment\n").open(folder_ / "s").has_value());

  const auto longer =
      SweepOfFakes(fall_plan(R"(["good"])", "duration_s = 0.2\n")).open(folder_ / "s");
  ASSERT_FALSE(longer.has_value());
  EXPECT_EQ(longer.error().fault, Fault::invalid);
  EXPECT_NE(longer.error().reason.find("- duration_s = 0.1\n+ duration_s = 0.2\n"),
            std::string::npos)
      << longer.error().reason;
  EXPECT_NE(longer.error().reason.find("0 of the 1 asked for now"), std::string::npos);

  const auto newer = SweepOfFakes(plan, "newer").open(folder_ / "s");
  ASSERT_FALSE(newer.has_value());
  EXPECT_NE(newer.error().reason.find("made by revision rev of the program, this one is newer"),
            std::string::npos)
      << newer.error().reason;

  fs::create_directories(folder_ / "other");
  std::ofstream(folder_ / "other" / "thesis.tex") << "x";
  const auto other = SweepOfFakes(plan).open(folder_ / "other");
  ASSERT_FALSE(other.has_value());
  EXPECT_NE(other.error().reason.find("it holds 'thesis.tex'"), std::string::npos);
}

TEST_F(SweepFolder, DamagedListOfCellsIsRefused) {
  const auto sweep = SweepOfFakes(k_mixed).open(folder_ / "s");
  ASSERT_TRUE(sweep.has_value());
  std::ofstream(folder_ / "s" / sweep->list, std::ios::app) << "x\n";
  const auto back = read_sweep(folder_ / "s");
  ASSERT_FALSE(back.has_value());
  EXPECT_NE(back.error().reason.find("checksum"), std::string::npos) << back.error().reason;
}

TEST_F(SweepFolder, MergedTableIsNeverWrittenOver) {
  const SweepOfFakes fakes(k_mixed);
  ASSERT_TRUE(fakes.run(folder_ / "s").has_value());
  const auto sweep = read_sweep(folder_ / "s");
  const auto to = [&] { return merge(*sweep, {folder_ / "m.csv", folder_ / "m.timings.csv"}); };
  EXPECT_TRUE(to().has_value());
  EXPECT_TRUE(to().has_value()) << "the same content again is fine";
  std::ofstream(folder_ / "m.csv", std::ios::app) << "x";
  const auto refused = to();
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().fault, Fault::invalid);
}

TEST_F(SweepFolder, MotionIsRecordedWhereThePlanSaysSo) {
  if (!has_trajectories()) GTEST_SKIP() << no_trajectories_reason();
  const SweepOfFakes fakes(
      fall_plan(R"(["good", "segfault"])", "[trajectory]\nengines = [\"good\"]\n"));
  const auto sweep = fakes.open(folder_ / "s");
  ASSERT_TRUE(fakes.run(folder_ / "s").has_value());
  const auto file = trajectory_path(folder_ / "s", sweep->cells[0].cell);
  EXPECT_TRUE(fs::exists(file));
  EXPECT_FALSE(fs::exists(trajectory_path(folder_ / "s", sweep->cells[1].cell)));
  // A cell that is run again replaces what it had recorded.
  fs::resize_file(result_path(folder_ / "s", sweep->cells[0].cell), 0);
  fs::resize_file(file, 0);
  ASSERT_TRUE(fakes.run(folder_ / "s").has_value());
  EXPECT_GT(fs::file_size(file), 0U);
}

// What `brickbench report` reads besides the rows.
TEST_F(SweepFolder, ResultsFolderHoldsCurvesAndMotionWhateverTheSharding) {
  if (!has_trajectories()) GTEST_SKIP() << no_trajectories_reason();
  const SweepOfFakes fakes(fall_plan(R"(["good", "good/fancy", "nan"])",
                                     "seeds = 3\nperturb = { position_m = 0.1 }\n"
                                     "[trajectory]\nengines = [\"good\"]\n"));
  ASSERT_TRUE(fakes.run(folder_ / "whole").has_value());
  for (const std::size_t index : {1U, 0U}) {
    ASSERT_TRUE(fakes.run(folder_ / "shards", {.shard = {.index = index, .count = 2}}).has_value());
  }
  std::map<std::string, std::string> files;
  for (const char* name : {"whole", "shards"}) {
    const auto summary =
        merge_to_folder(*read_sweep(folder_ / name), folder_ / ("merged-" + std::string(name)));
    ASSERT_TRUE(summary.has_value()) << summary.error().reason;
    EXPECT_EQ(summary->recorded, 3U);
  }
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "merged-whole")) {
    const auto name = fs::relative(entry.path(), folder_ / "merged-whole");
    if (!entry.is_regular_file() || name == "timings.csv") continue;
    const auto whole = read_file(entry.path());
    const auto shards = read_file(folder_ / "merged-shards" / name);
    ASSERT_TRUE(whole && shards) << name;
    EXPECT_TRUE(*whole == *shards) << name << " differs";
    files[name.string()] = *whole;
  }
  EXPECT_EQ(files.size(), 4U + 3U) << "rows, series, plan, provenance and the motion of 3 cells";

  // The curves are those of the recorded cells, as one process would have them.
  std::vector<Cell> recorded;
  for (const Cell& cell : fakes.cells) {
    if (cell.recording) recorded.push_back(cell);
  }
  ASSERT_EQ(recorded.size(), 3U);
  const auto alone = run_cells(recorded, fakes.catalogues, k_origin);
  EXPECT_GT(alone.series.size(), 0U);
  EXPECT_EQ(files["series.csv"], to_csv<SeriesPoint>(alone.series));
}

TEST_F(SweepFolder, DamagedMotionIsNamedBeforeAnythingIsMerged) {
  if (!has_trajectories()) GTEST_SKIP() << no_trajectories_reason();
  const SweepOfFakes fakes(fall_plan(R"(["good"])", "[trajectory]\n"));
  const auto sweep = fakes.open(folder_ / "s");
  ASSERT_TRUE(fakes.run(folder_ / "s").has_value());
  const auto file = trajectory_path(folder_ / "s", sweep->cells[0].cell);
  fs::resize_file(file, fs::file_size(file) / 2);
  const auto refused = merge_to_folder(*sweep, folder_ / "m");
  ASSERT_FALSE(refused.has_value());
  EXPECT_NE(refused.error().reason.find(file.string()), std::string::npos)
      << refused.error().reason;
  EXPECT_FALSE(fs::exists(folder_ / "m"));
  // What the message advises helps.
  fs::remove(result_path(folder_ / "s", sweep->cells[0].cell));
  ASSERT_TRUE(fakes.run(folder_ / "s").has_value());
  EXPECT_TRUE(merge_to_folder(*sweep, folder_ / "m").has_value());
}

TEST_F(SweepFolder, ClaimIsHadByOneAtATime) {
  auto first = Claims::open(folder_);
  auto second = Claims::open(folder_);
  ASSERT_TRUE(first && second);
  EXPECT_TRUE(first->take(7));
  EXPECT_FALSE(second->take(7));
  EXPECT_TRUE(second->take(8));
  first->give_back(7);
  EXPECT_TRUE(second->take(7));
  { const auto gone = std::move(*second); }
  EXPECT_TRUE(first->take(8)) << "the claim outlives its holder";
}

}  // namespace
}  // namespace brickbench::testing
