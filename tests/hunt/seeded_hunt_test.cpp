// The hunt finds faults that were put back, from a seed that knows nothing of them; a correct
// engine in the same trial raises no such alarm.
#include <gtest/gtest.h>

#include <iostream>
#include <sstream>

#include "adapters/catalog.hpp"
#include "experiments/hunt/cause.hpp"
#include "experiments/hunt/hunt.hpp"
#include "experiments/hunt/judge.hpp"
#include "tests/faults/seeded_faults.hpp"

namespace brickbench::hunt {
namespace {

using brickbench::testing::correct_adapter;
using brickbench::testing::fault_named;
using brickbench::testing::faulty_adapter;
using brickbench::testing::seeded_faults;

// A seeded fault and the oracles, any of which must find it.
struct Hunted {
  const char* fault;
  std::vector<std::string> oracles;
};

const std::vector<Hunted>& hunted() {
  static const std::vector<Hunted> list = {
      {"plastic_is_elastic_once", {"impact"}},
      {"restitution_adds_energy", {"energy", "impact"}},
      {"bounce_gains_a_step", {"kinematics", "energy"}},
      {"contact_is_lost_when_moved_apart", {"energy", "kinematics"}},
      {"light_bricks_explode", {"energy", "impact"}},
      {"flies_to_1e33_m", {"energy", "impact"}},
      {"is_carried_to_1e33_m", {"kinematics"}},
      {"sinks_after_a_blow", {"passage", "overlap"}},
      {"passes_at_a_hit", {"passage", "kinematics"}},
      {"nan_is_hidden", {"kinematics", "push"}},
      {"creeps", {"friction"}},
      {"leaks_momentum", {"momentum"}},
      {"pulls_to_the_left", {"momentum", "push", "image", "cone"}},
      {"differs_from_run_to_run", {"repetition"}}};
  return list;
}

std::vector<std::string> scenes_to_hunt_in(const std::string& words, const Catalogues& all) {
  if (words.empty()) return names_of(all.scenarios);
  std::istringstream stream(words);
  std::vector<std::string> scenes;
  for (std::string word; stream >> word;) scenes.push_back(word);
  return scenes;
}

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

std::optional<Caught> hunt_for(const Hunted& wanted, const Catalogues& catalogues) {
  Quarry quarry;
  quarry.seed = 2026;
  quarry.engines = {{wanted.fault, correct_adapter().variants.front().name}};
  quarry.scenes =
      scenes_to_hunt_in(seeded_faults()[fault_named(wanted.fault)].hunted_in, catalogues);
  for (std::uint64_t number = 0; number < k_most_trials; ++number) {
    const auto trial = trial_number(quarry, catalogues, number, k_small);
    if (!trial) continue;
    const Verdict verdict = judge(*trial, catalogues);
    if (verdict.is_told()) continue;
    for (const std::string& oracle : wanted.oracles) {
      if (verdict.find(oracle) != nullptr) return Caught{number, *trial, verdict, oracle};
    }
  }
  return std::nullopt;
}

TEST(SeededHunt, AreAllFoundAndShrunk) {
  const Adapter correct = correct_adapter();
  if (correct.name.empty()) GTEST_SKIP() << "no linked engine is fit";
  std::cout << "| fault | what is wrong | found by | in trial | smallest scene |\n"
               "|---|---|---|---:|---|\n";
  for (const Hunted& wanted : hunted()) {
    const std::size_t index = fault_named(wanted.fault);
    ASSERT_LT(index, seeded_faults().size()) << wanted.fault;
    Catalogues catalogues;
    catalogues.scenarios = scenarios();
    catalogues.adapters = {correct, faulty_adapter(index, false)};
    const auto caught = hunt_for(wanted, catalogues);
    ASSERT_TRUE(caught.has_value()) << wanted.fault;
    const Judge judge_here = [&](const Trial& trial) { return judge(trial, catalogues); };
    const Shrunk shrunk =
        shrink(caught->trial, caught->verdict, caught->oracle, catalogues, judge_here, 60);
    Trial innocent = shrunk.trial;
    innocent.engine.engine = correct.name;
    EXPECT_EQ(judge(innocent, catalogues).find(caught->oracle), nullptr)
        << wanted.fault << ": a false alarm in " << label(innocent);
    std::cout << "| " << wanted.fault << " | " << seeded_faults()[index].story << " | "
              << caught->oracle << " | " << caught->number << " | " << label(shrunk.trial)
              << " |\n";
  }
}

}  // namespace
}  // namespace brickbench::hunt
