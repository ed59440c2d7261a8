// Whatever an engine does to its process is a row, with an outcome and a reason.
#include "tests/support/sweep_folder.hpp"

namespace brickbench::testing {
namespace {

class Isolation : public TemporaryFolder {
 protected:
  // engine -> "outcome: reason" of its first row, after a sweep of these engines.
  std::map<std::string, std::string> outcomes(const std::string& engines,
                                              const Limits& limits = {}) {
    const SweepOfFakes fakes(fall_plan(engines));
    const auto summary = fakes.run(folder_ / "s", {.jobs = 2, .limits = limits});
    EXPECT_TRUE(summary.has_value()) << summary.error().reason;
    const std::string text = merged(folder_ / "s");
    EXPECT_TRUE(write_new_file(folder_ / "all.csv", text).has_value());
    std::map<std::string, std::string> result;
    const auto rows = read_csv<Row>(folder_ / "all.csv");
    EXPECT_TRUE(rows.has_value()) << rows.error().reason;
    for (const Row& row : *rows) {
      if (row.metric == "height_m") result[row.engine] = row.outcome + ": " + row.reason;
    }
    EXPECT_EQ(rows->size(), 4 * fakes.cells.size());
    return result;
  }

  std::string log_of(const std::string& engine) const {
    const auto sweep = read_sweep(folder_ / "s");
    for (const PlannedCell& cell : sweep->cells) {
      if (cell.engine != engine) continue;
      const auto log = read_file(log_path(folder_ / "s", cell.cell));
      return log ? *log : "";
    }
    return "";
  }
};

TEST_F(Isolation, EveryEndOfAProcessIsARow) {
  const std::map<std::string, std::string> expected = {
      {"good", "ok: "},
      {"nan", "diverged: step 7 (0.07 s): the state of body 'ball' is not finite"},
      {"thrower", "crashed: step 3 (0.03 s): the engine threw: solver, \"lost\"\nit"},
      {"refuser", "refused: friction 0.5 must be 0"},
      {"segfault",
       "crashed: the process died of signal SIGSEGV (Segmentation fault) after 2 of 10 steps"},
      {"abort", "crashed: the process died of signal SIGABRT (Aborted) after 2 of 10 steps"},
      {"exit", "crashed: the process ended itself with exit status 0 after 2 of 10 steps"},
      {"killed",
       "crashed: the process died of signal SIGKILL (Killed) in each of 3 attempts; if nobody sent "
       "it, memory had run out"}};
  EXPECT_EQ(outcomes(R"(["good", "nan", "thrower", "refuser", "segfault", "abort", "exit",
                        "killed"])"),
            expected);
  EXPECT_EQ(log_of("segfault"), "about to touch nothing\n");
  EXPECT_EQ(log_of("abort"), "assertion failed\n");
  EXPECT_EQ(log_of("good"), "");
}

TEST_F(Isolation, HangEndsAtTheWallClockLimit) {
  const auto found = outcomes(R"(["hang", "good"])", {.wall_s = 1.5});
  EXPECT_EQ(found.at("hang"), "timed_out: no result within the wall-clock limit of 1.5 s");
  EXPECT_EQ(found.at("good"), "ok: ");
}

TEST_F(Isolation, MemoryBeyondTheLimitIsRefusedToTheEngine) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the address sanitizer needs the address space that the limit takes away";
#endif
  const auto found = outcomes(R"(["eater", "good"])", {.memory_mb = 256});
  EXPECT_EQ(found.at("eater"), "out_of_memory: step 3 (0.03 s): the engine ran out of memory");
  EXPECT_EQ(found.at("good"), "ok: ");
}

TEST_F(Isolation, OfMuchOutputTheStartAndTheEndAreKept) {
  outcomes(R"(["chatter"])");
  const std::string log = log_of("chatter");
  EXPECT_LT(log.size(), 4U * 65536U);
  EXPECT_TRUE(log.starts_with("line 0\nline 1\n")) << log.substr(0, 40);
  EXPECT_TRUE(log.ends_with("line 99999\n")) << log.substr(log.size() - 40);
  EXPECT_NE(log.find(" bytes left out]"), std::string::npos);
}

TEST_F(Isolation, WorkThatThrowsAndParentThatGoesAreNoticed) {
  auto thrower = Isolated::start(
      [](const StepCallback&) -> std::string { throw std::runtime_error("no"); }, {});
  ASSERT_TRUE(thrower.has_value());
  const Ended ended = thrower->wait();
  EXPECT_FALSE(ended.answered);
  EXPECT_EQ(ended.failure.reason, "the process ended itself with exit status 125");
  EXPECT_EQ(ended.output, "no\n");

  int pid = -1;
  {
    auto sleeper = Isolated::start(
        [](const StepCallback&) -> std::string {
          ::sleep(100);
          return "late";
        },
        {});
    ASSERT_TRUE(sleeper.has_value());
    pid = sleeper->pid();
    EXPECT_EQ(::kill(pid, 0), 0);
  }
  EXPECT_NE(::kill(pid, 0), 0) << "the process outlives the value that stands for it";
}

}  // namespace
}  // namespace brickbench::testing
