// Valid or told: a run whose engine raises a flag has told what it breaks from there on.
#include <gtest/gtest.h>

#include "experiments/hunt/judge.hpp"
#include "tests/support/dubious_engine.hpp"

namespace brickbench::hunt {
namespace {

namespace testing = brickbench::testing;

Motion flagged(std::optional<Flag> flag, std::size_t step) {
  Motion motion;
  motion.flag = flag;
  motion.flagged_step = step;
  return motion;
}

Verdict broken(std::vector<std::size_t> steps) {
  Verdict verdict;
  for (const std::size_t step : steps) {
    verdict.breaches.push_back({"energy", 2.0, 1.0, "J", step, 0.0, ""});
  }
  return verdict;
}

TEST(ReadFlags, TellsWhatIsBrokenFromTheFlagOn) {
  for (const Flag flag : k_all_flags) {
    for (const std::size_t step : {5u, 6u, 100u}) {
      Verdict verdict = broken({step});
      read_flags(flagged(flag, 5), verdict);
      EXPECT_TRUE(verdict.is_told()) << step;
      EXPECT_EQ(verdict.outcome, to_word(flag));
    }
  }
}

TEST(ReadFlags, FindsWhatIsBrokenBefore) {
  for (const std::vector<std::size_t>& steps :
       {std::vector<std::size_t>{4}, std::vector<std::size_t>{1, 9}}) {
    Verdict verdict = broken(steps);
    read_flags(flagged(Flag::unsolved, 5), verdict);
    EXPECT_FALSE(verdict.is_told());
  }
}

TEST(ReadFlags, FindsWhatNoFlagTellsAndLeavesSoundRunsAlone) {
  Verdict silent = broken({9});
  read_flags(flagged(std::nullopt, 0), silent);
  EXPECT_FALSE(silent.is_told());
  Verdict sound;
  read_flags(flagged(Flag::unsolved, 5), sound);
  EXPECT_EQ(sound.outcome, "ok");
}

TEST(ReadFlags, HearsTheFirstFlagOfTheEngine) {
  const auto scene = build(testing::fake_scenario(), {});
  ASSERT_TRUE(scene.has_value());
  const Catalogues catalogues = testing::dubious_catalogues();
  for (const Flag flag : {Flag::unsolved, Flag::clamped, Flag::overlap_left}) {
    const Adapter* engine = find_adapter(catalogues, std::string(to_word(flag)));
    ASSERT_NE(engine, nullptr);
    Settings settings;
    settings.variant = "plain";
    settings.step_s = 0.01;
    const Motion motion = run_motion(*engine, settings, *scene, 8);
    EXPECT_EQ(motion.flag, flag);
    EXPECT_EQ(motion.flagged_step, static_cast<std::size_t>(testing::k_dubious_from));
  }
}

}  // namespace
}  // namespace brickbench::hunt
