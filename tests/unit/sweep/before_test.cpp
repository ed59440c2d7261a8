// What comes before a sweep runs: its estimate, and the scripts for a cluster.
#include "experiments/sweep/estimate.hpp"
#include "experiments/sweep/slurm.hpp"
#include "tests/support/sweep_folder.hpp"

namespace brickbench::testing {
namespace {

TEST(SweepEstimate, TriesEachKindOnceAndWarnsOfWhatWillFail) {
  const SweepOfFakes fakes(fall_plan(
      R"(["good", "slow", "nan", "segfault", "refuser", "good/fancy"])",
      "seeds = 5\nperturb = { position_m = 0.1 }\nparameters = { balls = [1, 2] }\n"
      "except = [{ engine = \"good/fancy\", when = \"seed > 0\", why = \"not now\" }]\n"));
  const auto found = estimate(fakes.cells, fakes.catalogues, k_origin);
  ASSERT_TRUE(found.has_value()) << found.error().reason;
  EXPECT_EQ(found->cells, 50U);
  EXPECT_EQ(found->excluded, 10U);
  EXPECT_EQ(found->kinds, 10U);
  EXPECT_EQ(found->tried, 10U);
  std::map<std::string, std::size_t> warned;
  for (const TrialFailure& failure : found->failures) {
    warned[failure.cell.engine.engine + ": " + failure.outcome] += failure.cells;
  }
  EXPECT_EQ(warned,
            (std::map<std::string, std::size_t>{
                {"nan: diverged", 10}, {"refuser: refused", 10}, {"segfault: crashed", 10}}));
  // Ten cells of ten steps that sleep 0.4 ms each; the rest is quick.
  EXPECT_GT(found->work_s, 10 * 10 * 0.4e-3);
  EXPECT_GT(found->size_bytes, 50.0 * 100.0);
  EXPECT_EQ(found->motion_bytes, 0.0);
}

TEST(SweepEstimate, CountsTheMotionOfTheRecordedCells) {
  const SweepOfFakes fakes(fall_plan(
      R"(["good", "slow"])",
      "seeds = 3\nperturb = { position_m = 0.1 }\nparameters = { balls = 2 }\n[trajectory]\n"
      "engines = [\"good\"]\nevery = 3\nprecision = \"f32\"\n"));
  const auto found = estimate(fakes.cells, fakes.catalogues, k_origin);
  ASSERT_TRUE(found.has_value()) << found.error().reason;
  // Three cells, the frames 0, 3, 6, 9 and 10, two balls.
  EXPECT_EQ(found->motion_bytes, 3 * 5 * (2 * 13 * 4 + 8 + 8));
}

TEST(SweepEstimate, TriesNoMoreThanItMay) {
  const SweepOfFakes fakes(
      fall_plan(R"(["good"])", "parameters = { mass_kg = { from = 1, to = 9, count = 40 } }\n"));
  const auto found = estimate(fakes.cells, fakes.catalogues, k_origin, {.most = 4});
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->kinds, 40U);
  EXPECT_EQ(found->tried, 4U);
}

TEST(SlurmScripts, NameTheOpenShardsOfAllAndSurviveFailedCells) {
  const SlurmJob job{.run = {"/bin/b", "sweep", "run", "my plan.toml", "--out", "/d/s"},
                     .merge = {"/bin/b", "sweep", "merge", "/d/s", "--out", "/d/s/rows.csv"},
                     .folder = "/d/s",
                     .shards = 8,
                     .open_shards = {1, 5},
                     .cpus_per_task = 2,
                     .partition = "long",
                     .options = {"--mem=4G"}};
  const std::string script = array_script(job);
  const auto has = [&](const std::string& line) {
    return script.find('\n' + line + '\n') != std::string::npos;
  };
  EXPECT_TRUE(has("#SBATCH --array=1,5")) << script;
  EXPECT_TRUE(has("#SBATCH --requeue"));
  EXPECT_TRUE(has("#SBATCH --open-mode=append"));
  EXPECT_TRUE(has("#SBATCH --partition=long"));
  EXPECT_TRUE(has("#SBATCH --mem=4G"));
  EXPECT_TRUE(
      has("/bin/b sweep run 'my plan.toml' --out /d/s --shard \"$SLURM_ARRAY_TASK_ID/8\" "
          "--jobs 2 || status=$?"))
      << script;
  EXPECT_TRUE(has("if [ $status -eq 1 ]; then status=0; fi"));
  EXPECT_NE(merge_script(job).find("\n/bin/b sweep merge /d/s --out /d/s/rows.csv\n"),
            std::string::npos);
}

}  // namespace
}  // namespace brickbench::testing
