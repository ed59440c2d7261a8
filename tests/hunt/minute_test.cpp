// A fixed seed of the hunt through our engines, a few seconds of each.
#include <gtest/gtest.h>

#include <filesystem>

#include "adapters/catalog.hpp"
#include "experiments/hunt/findings.hpp"
#include "experiments/hunt/hunt.hpp"

namespace brickbench::hunt {
namespace {

// Engines in which nothing may be found, as engine/variant.
const std::vector<std::string> k_clean = {"ourengine/exact", "ourengine/fast", "ourengine/lcp",
                                          "ourengine/baraff"};

constexpr std::uint64_t k_seed = 14;
constexpr std::uint64_t k_trials_of_each = 25;
constexpr DrawLimits k_minute = {.bodies = 20, .body_steps = 3000.0, .most_steps = 600};

std::vector<EngineVariant> own_engines(const Catalogues& catalogues) {
  std::vector<EngineVariant> engines;
  for (const Adapter& adapter : catalogues.adapters) {
    if (!adapter.own) continue;
    for (const Variant& variant : adapter.variants) engines.push_back({adapter.name, variant.name});
  }
  return engines;
}

std::string report(const Record& record) {
  std::string text;
  for (const auto& [outcome, count] : record.outcomes()) {
    text += outcome + " " + std::to_string(count) + "\n";
  }
  for (const auto& [kind, count] : record.seen()) text += kind + " " + std::to_string(count) + "\n";
  for (const Find& find : record.finds()) text += label(find.trial) + "\n";
  return text;
}

class Minute : public ::testing::Test {
 protected:
  Record hunt(std::uint64_t trials, std::size_t workers) const {
    const auto folder = std::filesystem::temp_directory_path() /
                        ("brickbench-minute-" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder);
    Record record;
    const auto file = ProgressFile::create(folder, quarry_);
    EXPECT_TRUE(file.has_value());
    HuntOptions options;
    options.budget_s = 1e5;
    options.most_trials = trials;
    options.workers = workers;
    options.limits = k_minute;
    options.shrinks = false;
    const auto ran = run_hunt(quarry_, catalogues_, options, *file, record);
    EXPECT_TRUE(ran.has_value()) << ran.error().reason;
    std::filesystem::remove_all(folder);
    return record;
  }

  void SetUp() override {
    catalogues_.scenarios = scenarios();
    catalogues_.adapters = adapters();
    quarry_ = {k_seed, own_engines(catalogues_), names_of(catalogues_.scenarios), {}};
    if (quarry_.engines.empty()) GTEST_SKIP() << "no engine of ours is linked";
  }

  Catalogues catalogues_;
  Quarry quarry_;
};

TEST_F(Minute, KillsNoEngineAndFindsNothingInTheCleanOnes) {
  const Record record = hunt(k_trials_of_each * quarry_.engines.size(), 2);
  EXPECT_EQ(record.judged(), k_trials_of_each * quarry_.engines.size());
  for (const Find& find : record.finds()) {
    EXPECT_NE(find.oracle, "process") << label(find.trial) << ": " << find.verdict.reason;
    const bool clean = std::ranges::find(k_clean, find.trial.engine.label()) != k_clean.end();
    EXPECT_FALSE(clean) << find.oracle << " in trial " << find.number << ": " << label(find.trial);
  }
}

TEST_F(Minute, IsTheSameTwice) {
  const std::uint64_t trials = 4 * quarry_.engines.size();
  EXPECT_EQ(report(hunt(trials, 1)), report(hunt(trials, 3)));
}

}  // namespace
}  // namespace brickbench::hunt
