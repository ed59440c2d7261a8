// The hunt finds faults that were put back, from a seed that knows nothing of them; a correct
// engine in the same trial raises no such alarm.
#include "tests/hunt/spoiled_engine.hpp"

#include <gtest/gtest.h>

#include <iostream>

#include "adapters/catalog.hpp"
#include "experiments/hunt/cause.hpp"
#include "experiments/hunt/hunt.hpp"
#include "experiments/hunt/judge.hpp"
#include "tests/faults/seeded_faults.hpp"

namespace brickbench::hunt {
namespace {

using brickbench::testing::correct_adapter;
using brickbench::testing::spoiled_adapter;
using brickbench::testing::Spoiling;
using brickbench::testing::spoilings;

// Two cores judge some thousands in ten minutes.
constexpr std::uint64_t k_most_trials = 300;
// Small trials, for the test's sake.
constexpr DrawLimits k_small = {.bodies = 12, .body_steps = 2500.0, .most_steps = 600};

struct Caught {
  std::uint64_t number = 0;
  Trial trial;
  Verdict verdict;
  std::string oracle;
};

std::optional<Caught> hunt_for(const Spoiling& spoiling, const Catalogues& catalogues) {
  Quarry quarry;
  quarry.seed = 2026;
  quarry.engines = {{spoiling.name, correct_adapter().variants.front().name}};
  quarry.scenes = spoiling.scenes.empty() ? names_of(catalogues.scenarios) : spoiling.scenes;
  for (std::uint64_t number = 0; number < k_most_trials; ++number) {
    const auto trial = trial_number(quarry, catalogues, number, k_small);
    if (!trial) continue;
    const Verdict verdict = judge(*trial, catalogues);
    if (verdict.is_told()) continue;
    for (const std::string& oracle : spoiling.oracles) {
      if (verdict.find(oracle) != nullptr) return Caught{number, *trial, verdict, oracle};
    }
  }
  return std::nullopt;
}

TEST(SpoiledEngines, AreAllFoundAndShrunk) {
  const Adapter correct = correct_adapter();
  if (correct.name.empty()) GTEST_SKIP() << "no linked engine is fit";
  std::cout << "| fault | what is wrong | found by | in trial | smallest scene |\n"
               "|---|---|---|---:|---|\n";
  for (std::size_t i = 0; i < spoilings().size(); ++i) {
    const Spoiling& spoiling = spoilings()[i];
    Catalogues catalogues;
    catalogues.scenarios = scenarios();
    catalogues.adapters = {correct, spoiled_adapter(i)};
    const auto caught = hunt_for(spoiling, catalogues);
    ASSERT_TRUE(caught.has_value()) << spoiling.name;
    const Judge judge_here = [&](const Trial& trial) { return judge(trial, catalogues); };
    const Shrunk shrunk =
        shrink(caught->trial, caught->verdict, caught->oracle, catalogues, judge_here, 60);
    Trial innocent = shrunk.trial;
    innocent.engine.engine = correct.name;
    EXPECT_EQ(judge(innocent, catalogues).find(caught->oracle), nullptr)
        << spoiling.name << ": a false alarm in " << label(innocent);
    std::cout << "| " << spoiling.name << " | " << spoiling.story << " | " << caught->oracle
              << " | " << caught->number << " | " << label(shrunk.trial) << " |\n";
  }
}

}  // namespace
}  // namespace brickbench::hunt
