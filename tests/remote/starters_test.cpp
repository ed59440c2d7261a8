// The starter kits are right: they pass every rule of the seam, and there is nothing to tell of
// them.
#include <gtest/gtest.h>

#include <cstdlib>

#include "adapters/remote/remote_adapter.hpp"
#include "experiments/conformance/diagnosis.hpp"

namespace brickbench {
namespace {

using conformance::Outcome;

void expect_right(const std::vector<std::string>& words) {
  const auto adapter =
      remote::remote_adapter("mine", {.words = words, .folder = {}, .environment = {}});
  ASSERT_TRUE(adapter) << adapter.error().reason;
  const conformance::Subject subject{*adapter, adapter->variants.front().name};
  int passed = 0;
  for (const conformance::Check& check : conformance::all_checks()) {
    const conformance::Verdict verdict = check.run(subject);
    EXPECT_NE(verdict.outcome, Outcome::failed) << check.name << ": " << verdict.detail;
    passed += verdict.outcome == Outcome::passed ? 1 : 0;
  }
  EXPECT_GE(passed, 17) << "all that needs no contact";
  for (const std::string& symptom : conformance::diagnose(subject)) ADD_FAILURE() << symptom;
}

TEST(Starters, InCppIsRight) { expect_right({BRICKBENCH_STARTER}); }

TEST(Starters, InPythonIsRight) {
  if (std::system("python3 -c '' 2>/dev/null") != 0) {
    GTEST_SKIP() << "there is no python3 (Debian package python3)";
  }
  expect_right({"python3", "adapters/starter/your_engine.py"});
}

}  // namespace
}  // namespace brickbench
